// What a render job has to be.
#pragma once

#include "kernels/host/error.h"
#include "scheduler/farm/render_job.h"

namespace penumbra {

/// The error says what is wrong with the job's rectangle, tiles, passes or samples, and what is
/// possible.
Expected<void> check_render_job(const RenderJob& job);

/// Bytes that the scheduler needs for the image and its files, at the worst time.
std::uint64_t memory_of_image(const RenderJob& job);

}  // namespace penumbra
