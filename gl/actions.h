// Everything that a person can do to the window by one key, once: for the keyboard, scripts and the help.
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

/// Another name of a key: "esc" for "escape", or another key that does the same, as "equal" for "plus".
struct KeyAlias {
  std::string_view alias, key;
};

/// All actions, in the order of the help.
std::span<const ActionInfo> all_actions();
std::span<const KeyAlias> key_aliases();

const ActionInfo& info_of(Action action);

/// The action of a key's name or alias, whatever its case.
std::optional<Action> action_of_key(std::string_view key);

/// Names and aliases, for error messages about other keys (scenes/diagnostic.h: suggestion).
std::vector<std::string> key_names();

}  // namespace penumbra
