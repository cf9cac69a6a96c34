// Which workers can do a job, by their instruction sets.
#pragma once

#include <span>
#include <string>

#include "kernels/host/error.h"
#include "worker/device.h"

namespace penumbra {

/// What a worker that has these instruction sets is to compute with. With Embree the set is a part of the
/// image, so a worker that lacks the job's own is refused, and the error says why, naming `worker`; with the
/// portable intersector every set gives the same bits, and a worker that lacks the job's takes its best.
/// OpenCL kernels have none.
Expected<DeviceOptions> options_for_worker(const DeviceOptions& job, bool embree, std::span<const Isa> has,
                                           const std::string& worker);

}  // namespace penumbra
