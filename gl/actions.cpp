#include "gl/actions.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace penumbra {
namespace {

constexpr ActionInfo kActions[] = {
    {Action::kOneMoreSample, "space", "one more sample for every pixel; play a shot, or stop", true},
    {Action::kToggleAutomatic, "r", "refine until told otherwise, or stop", false},
    {Action::kShowComposite, "1", "show the image", false},
    {Action::kShowAnalytic, "2", "show the closed form, which knows no shadows", false},
    {Action::kShowDifference, "3", "show what samples add to the closed form", false},
    {Action::kShowError, "4", "show the standard error", false},
    {Action::kToggleDenoising, "n", "remove noise from the image, or stop", false},
    {Action::kToggleOutlines, "o", "outline the tiles that workers have in hand", false},
    {Action::kBrighter, "plus", "more exposure", true},
    {Action::kDarker, "minus", "less exposure", true},
    {Action::kNextToneMap, "t", "next tone map", false},
    {Action::kToggleFalseColor, "c", "show brightness as colours, or stop", false},
    {Action::kNextLayer, "l", "next layer", false},
    {Action::kZoomIn, "period", "larger picture", true},
    {Action::kZoomOut, "comma", "smaller picture", true},
    {Action::kActualSize, "z", "one screen pixel per pixel", false},
    {Action::kFit, "f", "fit the picture into the window", false},
    {Action::kKeepReference, "b", "keep the picture as reference", false},
    {Action::kToggleReference, "x", "show the reference, or the picture again", false},
    {Action::kNextComparison, "v", "show the difference to the reference, relative error, or neither", false},
    {Action::kAlphaUp, "right_bracket", "more of the closed form (alpha)", true},
    {Action::kAlphaDown, "left_bracket", "less of the closed form (alpha)", true},
    {Action::kForward, "w", "move forward", true},
    {Action::kBack, "s", "move back", true},
    {Action::kLeft, "a", "move left", true},
    {Action::kRight, "d", "move right", true},
    {Action::kUp, "e", "move up", true},
    {Action::kDown, "q", "move down", true},
    {Action::kOrbitLeft, "left", "turn about the target, to the left; the frame before", true},
    {Action::kOrbitRight, "right", "turn about the target, to the right; the next frame", true},
    {Action::kOrbitUp, "up", "turn about the target, upwards", true},
    {Action::kOrbitDown, "down", "turn about the target, downwards", true},
    {Action::kCloser, "page_up", "closer to the target", true},
    {Action::kFarther, "page_down", "farther from the target", true},
    {Action::kResetCamera, "home", "back to the scene's own camera; the first frame", false},
    {Action::kLastFrame, "end", "the last frame of a shot", false},
    {Action::kReload, "f5", "read the scene again", false},
    {Action::kSave, "p", "save the image as EXR and PNG", false},
    {Action::kCopyView, "ctrl+c", "copy the view as settings of a render", false},
    {Action::kTogglePanel, "tab", "show or hide the panel", false},
    {Action::kToggleHelp, "h", "show or hide this help", false},
    {Action::kClose, "escape", "close what is open, stop comparing, fit the picture", false},
    {Action::kQuit, "ctrl+q", "quit", false},
};
constexpr std::size_t kActionCount = std::size(kActions);
static_assert(kActionCount == std::size_t(Action::kQuit) + 1);

constexpr KeyAlias kAliases[] = {
    {"equal", "plus"},  // where plus needs the shift key
    {"kp_add", "plus"},
    {"kp_subtract", "minus"},
    {"+", "plus"},
    {"=", "plus"},
    {"-", "minus"},
    {"[", "left_bracket"},
    {"]", "right_bracket"},
    {"pageup", "page_up"},
    {"pagedown", "page_down"},
    {"f1", "h"},
    {",", "comma"},
    {".", "period"},
    {"esc", "escape"},
};

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

/// `name` is in lower case.
bool same_key(std::string_view key, std::string_view name) {
  return std::ranges::equal(key, name, [](char a, char b) { return lower(a) == b; });
}

constexpr auto kIndexOfAction = [] {
  std::array<std::size_t, kActionCount> result{};
  for (std::size_t i = 0; i < kActionCount; ++i) result[std::size_t(kActions[i].action)] = i;
  return result;
}();

}  // namespace

std::span<const ActionInfo> all_actions() { return kActions; }
std::span<const KeyAlias> key_aliases() { return kAliases; }

const ActionInfo& info_of(Action action) { return kActions[kIndexOfAction[std::size_t(action)]]; }

std::optional<Action> action_of_key(std::string_view key) {
  for (const KeyAlias& alias : kAliases) {
    if (same_key(key, alias.alias)) key = alias.key;
  }
  for (const ActionInfo& info : kActions) {
    if (same_key(key, info.key)) return info.action;
  }
  return std::nullopt;
}

std::vector<std::string> key_names() {
  std::vector<std::string> names;
  for (const ActionInfo& info : kActions) names.emplace_back(info.key);
  for (const KeyAlias& alias : kAliases) names.emplace_back(alias.alias);
  return names;
}

}  // namespace penumbra
