// Connects the renders of a set with the options of `penumbra render`: the rows of a command line are those
// of each render of a set, so both accept the same values.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scheduler/render/render_option.h"
#include "scheduler/run/render_options.h"
#include "scheduler/sets/render_axes.h"
#include "worker/cli/command_line.h"

namespace penumbra {

/// The row of the option with this long name, if each render of a command may have another value, else null.
const RenderOption* find_varied_option(std::string_view long_name);

/// How the values of that option are given.
AxisKind kind_of(const RenderOption& option);

/// The names of all such options, sorted.
const std::vector<std::string>& varied_option_names();

/// Whether all renders of a command share this option, for example `workers`.
bool is_shared_option(std::string_view name);

/// Checks a value of an axis by itself.
Expected<void> check_value(AxisKind kind, const std::string& name, const std::string& value);

/// The words of a `penumbra render` that does what this command was told by the options that both have,
/// except those in `without` (long names without dashes): the scenes, then a word for each option.
std::vector<std::string> render_words(const CommandLine& command, std::span<const std::string_view> without);

/// The axes that the command line gives to each of its renders.
std::vector<RenderAxis> axes_of_command(const CommandLine& command);

/// The options of one render: the chosen values of the axes, and otherwise those of `shared`.
Expected<RenderOptions> options_of(const std::vector<RenderAxis>& axes, const RenderChoice& choice,
                                   const RenderOptions& shared);

}  // namespace penumbra
