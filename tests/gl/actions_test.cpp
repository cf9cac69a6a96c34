#include "gl/actions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "scenes/diagnostic.h"

namespace penumbra {
namespace {

TEST(Actions, TheKeysThatAreDocumented) {
  const std::pair<std::string_view, Action> kKeys[] = {
      {"space", Action::kOneMoreSample},
      {"r", Action::kToggleAutomatic},
      {"1", Action::kShowComposite},
      {"2", Action::kShowAnalytic},
      {"3", Action::kShowDifference},
      {"4", Action::kShowError},
      {"o", Action::kToggleOutlines},
      {"plus", Action::kBrighter},
      {"equal", Action::kBrighter},
      {"minus", Action::kDarker},
      {"t", Action::kNextToneMap},
      {"right_bracket", Action::kAlphaUp},
      {"]", Action::kAlphaUp},
      {"left_bracket", Action::kAlphaDown},
      {"w", Action::kForward},
      {"s", Action::kBack},
      {"a", Action::kLeft},
      {"d", Action::kRight},
      {"q", Action::kDown},
      {"e", Action::kUp},
      {"left", Action::kOrbitLeft},
      {"right", Action::kOrbitRight},
      {"up", Action::kOrbitUp},
      {"down", Action::kOrbitDown},
      {"page_up", Action::kCloser},
      {"page_down", Action::kFarther},
      {"home", Action::kResetCamera},
      {"f5", Action::kReload},
      {"p", Action::kSave},
      {"tab", Action::kTogglePanel},
      {"h", Action::kToggleHelp},
      {"f1", Action::kToggleHelp},
      {"escape", Action::kClose},
      {"ESCAPE", Action::kClose},
      {"ctrl+q", Action::kQuit},
      {"ctrl+c", Action::kCopyView},
      {"c", Action::kToggleFalseColor},
      {"l", Action::kNextLayer},
      {".", Action::kZoomIn},
      {"comma", Action::kZoomOut},
      {"z", Action::kActualSize},
      {"f", Action::kFit},
      {"b", Action::kKeepReference},
      {"x", Action::kToggleReference},
      {"v", Action::kNextComparison},
      {"W", Action::kForward},
      {"F5", Action::kReload},
  };
  for (const auto& [key, action] : kKeys) EXPECT_EQ(action_of_key(key), action) << key;
}

TEST(Actions, EveryActionHasOneEntryAndEveryKeyOneMeaning) {
  std::set<Action> actions;
  std::set<std::string_view> keys;
  for (const ActionInfo& info : all_actions()) {
    EXPECT_TRUE(actions.insert(info.action).second) << info.key;
    EXPECT_TRUE(keys.insert(info.key).second) << info.key;
    EXPECT_EQ(action_of_key(info.key), info.action) << info.key;
    EXPECT_EQ(&info_of(info.action), &info);
    EXPECT_FALSE(info.help.empty()) << info.key;
  }
  EXPECT_EQ(actions.size(), std::size_t(Action::kQuit) + 1);
  for (const KeyAlias& alias : key_aliases()) {
    EXPECT_TRUE(keys.insert(alias.alias).second) << alias.alias;
    EXPECT_EQ(action_of_key(alias.alias), action_of_key(alias.key)) << alias.alias;
    EXPECT_TRUE(action_of_key(alias.key).has_value()) << alias.key;
  }
  const auto names = key_names();
  EXPECT_EQ(std::set<std::string_view>(names.begin(), names.end()), keys);
}

TEST(Actions, WhatOneHoldsRepeatsAndWhatOneTogglesDoesNot) {
  for (const std::string_view key : {"space", "w", "left", "page_up", "plus", "]"})
    EXPECT_TRUE(info_of(*action_of_key(key)).repeats) << key;
  for (const std::string_view key : {"r", "1", "o", "t", "tab", "h", "p", "f5", "escape", "home"})
    EXPECT_FALSE(info_of(*action_of_key(key)).repeats) << key;
}

TEST(Actions, UnknownKeysAreNoneAndHaveNeighbours) {
  for (const std::string_view key : {"", " ", "spcae", "f2", "ww", "space "})
    EXPECT_EQ(action_of_key(key), std::nullopt) << key;
  EXPECT_EQ(nearest_name("spcae", key_names()), "space");
  EXPECT_EQ(nearest_name("pageupp", key_names()), "pageup");
  EXPECT_EQ(nearest_name("leftbracket", key_names()), "left_bracket");
}

}  // namespace
}  // namespace penumbra
