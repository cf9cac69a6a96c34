// `penumbra render` with several scenes, or with job files.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "scheduler/cli/exit_code.h"
#include "scheduler/cli/render_options.h"

namespace penumbra {

/// Renders what plan_set makes of the command one after the other on one farm: the next ones are read while
/// others render, and images are written meanwhile. A scene that fails does not stop the others; a table and
/// a summary file say what became of each.
ExitCode render_set(const RenderOptions& options, const CLI::App& command,
                    const std::vector<std::string>& command_line);

}  // namespace penumbra
