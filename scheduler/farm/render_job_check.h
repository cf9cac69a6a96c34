// What a render job has to be.
#pragma once

#include "kernels/host/error.h"
#include "scheduler/farm/render_job.h"

namespace penumbra {

/// The error says what is wrong with the job's rectangle, tiles, passes or samples, and what is
/// possible.
Expected<void> check_render_job(const RenderJob& job);

}  // namespace penumbra
