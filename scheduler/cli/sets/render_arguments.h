// Connects the renders of a set with the options of `penumbra render`. The options of each render are parsed
// as if they were on a command line, so both accept the same values.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scheduler/cli/render_options.h"
#include "scheduler/cli/sets/render_axes.h"
#include "worker/cli/command_line.h"

namespace penumbra {

/// An option that may differ between the renders of a set.
struct RenderOption {
  std::string name;  ///< the long name without dashes; if there are several, the first
  AxisKind kind;     ///< kOption or kFlag
  bool has_values;   ///< kFlag: other values than true and false are accepted, too
};

/// The option with this long name. Null if it does not exist, or if all renders of a command share it.
const RenderOption* find_render_option(std::string_view long_name);

/// The names of all such options.
const std::vector<std::string>& render_option_names();

/// Whether all renders of a command share this option, for example `workers`.
bool is_shared_option(std::string_view name);

/// Checks a value of an axis by itself.
Expected<void> check_value(AxisKind kind, const std::string& name, const std::string& value);

/// The words of a `penumbra render` that does what this command was told by the options that both have,
/// except those in `without` (long names without dashes): the scenes, then a word for each option.
std::vector<std::string> render_words(const CommandLine& command, std::span<const std::string_view> without);

/// The axes that the command line gives to each of its renders.
std::vector<RenderAxis> axes_of_command(const CommandLine& command);

/// The options of one render: the chosen values of the axes, and otherwise those of `shared`. `with_frame`:
/// the frame is also a variable of the scene.
Expected<RenderOptions> options_of(const std::vector<RenderAxis>& axes, const RenderChoice& choice,
                                   const RenderOptions& shared, bool with_frame);

}  // namespace penumbra
