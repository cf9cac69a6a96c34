// Renders of a set and the options of `penumbra render`: a set has each render's options parsed as if they
// stood on a command line, so that both take the same.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "scheduler/cli/render_options.h"
#include "scheduler/cli/sets/render_axes.h"

namespace penumbra {

/// An option that each render of a set may have as it likes.
struct RenderOption {
  std::string name;  ///< the long one, without its dashes; of several the first
  AxisKind kind;     ///< kOption or kFlag
};

/// The option of this long name; null for what is none, and for options that all renders of a command share.
const RenderOption* find_render_option(std::string_view long_name);

/// The names of all that there are.
const std::vector<std::string>& render_option_names();

/// Whether it is an option of the command that all renders share, such as `workers`.
bool is_shared_option(std::string_view name);

/// What is wrong with the value of an axis, alone; nothing is.
Expected<void> check_value(AxisKind kind, const std::string& name, const std::string& value);

/// What a command line says of each of its renders.
std::vector<RenderAxis> axes_of_command(const CLI::App& command);

/// The options of one render: what is chosen for the axes, and of `shared` what all have in common.
/// `with_frame`: a frame is a variable of the scene as well.
Expected<RenderOptions> options_of(const std::vector<RenderAxis>& axes, const RenderChoice& choice,
                                   const RenderOptions& shared, bool with_frame);

}  // namespace penumbra
