// `penumbra render --estimate` with several scenes, or with job files.
#pragma once

#include <atomic>

#include "scheduler/run/render_options.h"
#include "worker/cli/command_line.h"
#include "worker/cli/exit_code.h"

namespace penumbra {

/// Measures the renders of plan_set one after the other, and prints a row for each and the totals. Together
/// they are measured for about a minute. Renders that differ only in the seed cost the same and are measured
/// once. Renders whose images are already there count as well. A scene that cannot be read is an error
/// (kBadInput) and does not stop the others.
ExitCode estimate_set(const RenderOptions& options, const CommandLine& command,
                      const std::atomic<bool>& stop);

}  // namespace penumbra
