// The state of workers and renders as messages.
#pragma once

#include <filesystem>

#include "jobs.pb.h"
#include "scheduler/farm/render_farm.h"

namespace penumbra {

wire::FarmWorker encode(const FarmWorker& worker);

/// Puts what the farm tells of a job's progress into its status. A queued job begins with its first unit.
void put_progress(const RenderProgress& progress, wire::JobStatus& status);

/// Adds a file that a job has written. Returns false if there is none.
bool add_file(const std::filesystem::path& file, wire::JobStatus& status);

}  // namespace penumbra
