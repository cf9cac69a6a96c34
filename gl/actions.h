// Everything that a person can do to the window by one key, once: for the keyboard, scripts and the help.
#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace penumbra {

enum class Action {
  kOneMoreSample,
  kToggleAutomatic,
  kShowComposite,
  kShowAnalytic,
  kShowDifference,
  kShowError,
  kToggleOutlines,
  kBrighter,
  kDarker,
  kNextToneMap,
  kAlphaUp,
  kAlphaDown,
  kForward,
  kBack,
  kLeft,
  kRight,
  kUp,
  kDown,
  kOrbitLeft,
  kOrbitRight,
  kOrbitUp,
  kOrbitDown,
  kCloser,
  kFarther,
  kResetCamera,
  kReload,
  kSave,
  kTogglePanel,
  kToggleHelp,
  kQuit,
};

struct ActionInfo {
  Action action;
  std::string_view key;   ///< as scripts name it and the help shows it, e.g. "space", "w", "f5"
  std::string_view help;  ///< what it does
  bool repeats;           ///< while the key is held
};

/// All actions, in the order of the help.
std::span<const ActionInfo> all_actions();

/// The action of a key's name, whatever its case.
std::optional<Action> action_of_key(std::string_view key);

}  // namespace penumbra
