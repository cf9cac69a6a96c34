// Decides which workers can render a job, by their instruction sets.
#pragma once

#include <span>
#include <string>

#include "kernels/host/error.h"
#include "worker/device.h"

namespace penumbra {

/// The device options for a worker that supports these instruction sets. With Embree the image depends on the
/// instruction set, so a worker without the job's set is refused; the error says why and names `worker`. With
/// the portable intersector every set gives bitwise equal results, so a worker without the job's set uses the
/// widest below it, else its narrowest. OpenCL kernels do not depend on it.
Expected<DeviceOptions> options_for_worker(const DeviceOptions& job, bool embree, std::span<const Isa> has,
                                           const std::string& worker);

}  // namespace penumbra
