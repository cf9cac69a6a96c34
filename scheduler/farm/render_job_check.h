// Checks whether a render job is valid.
#pragma once

#include "kernels/host/error.h"
#include "scheduler/farm/render_job.h"

namespace penumbra {

/// Checks the job's rectangle, tile size, passes and samples. The error says what is wrong and what is
/// possible.
Expected<void> check_render_job(const RenderJob& job);

/// The memory of this machine in bytes.
std::uint64_t memory_here();

/// The peak memory, in bytes, that the scheduler needs for the image and its files.
std::uint64_t memory_of_image(const RenderJob& job);

/// See PhaseUnits. With progressive photon mapping the units of a pass share a map. Results that wait for
/// those of the first such pass take at most a quarter of this machine's memory. An interactive render begins
/// with all workers at one pass, so that a new view is soon complete.
std::uint32_t passes_at_once(const RenderJob& job);

}  // namespace penumbra
