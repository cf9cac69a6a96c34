// The state of workers and renders as messages.
#pragma once

#include "jobs.pb.h"
#include "scheduler/farm/render_farm.h"

namespace penumbra {

wire::FarmWorker encode(const FarmWorker& worker);

/// Puts what the farm tells of a job's progress into its status.
void put_progress(const RenderProgress& progress, wire::JobStatus& status);

}  // namespace penumbra
