// All actions of the window that have a key, in one list: for the keyboard, scripts and the help.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra {

enum class Action {
  kOneMoreSample,
  kToggleAutomatic,
  kShowComposite,
  kShowAnalytic,
  kShowDifference,
  kShowError,
  kToggleDenoising,
  kToggleOutlines,
  kBrighter,
  kDarker,
  kNextToneMap,
  kToggleFalseColor,
  kNextLayer,
  kZoomIn,
  kZoomOut,
  kActualSize,
  kFit,
  kKeepReference,
  kToggleReference,
  kNextComparison,
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
  kLastFrame,
  kReload,
  kSave,
  kCopyView,
  kTogglePanel,
  kToggleHelp,
  kClose,
  kQuit,
};

struct ActionInfo {
  Action action;
  std::string_view key;   ///< its name in scripts and the help, such as "space", "w", "f5"
  std::string_view help;  ///< text of the help
  bool repeats;           ///< while the key is held down
};

/// Another name of a key, such as "esc" for "escape", or another key for the same action, such as "equal" for
/// "plus".
struct KeyAlias {
  std::string_view alias, key;
};

/// All actions, in the order of the help.
std::span<const ActionInfo> all_actions();
std::span<const KeyAlias> key_aliases();

const ActionInfo& info_of(Action action);

/// The action of a key's name or alias; case is ignored.
std::optional<Action> action_of_key(std::string_view key);

/// Names and aliases, for suggestions in error messages (scenes/diagnostic.h).
std::vector<std::string> key_names();

}  // namespace penumbra
