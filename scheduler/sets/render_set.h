// `penumbra render` with several scenes, or with job files.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "scheduler/run/render_options.h"
#include "worker/cli/command_line.h"
#include "worker/cli/exit_code.h"

namespace penumbra {

/// Renders the set of plan_set on one farm, one render after the other. The next scenes are read and finished
/// images are written while others render. A scene that fails does not stop the others. A line tells
/// the end of each, and a summary file lists them.
ExitCode render_set(const RenderOptions& options, const CommandLine& command,
                    const std::vector<std::string>& command_line, const std::atomic<bool>& stop);

}  // namespace penumbra
