// Renders on this machine's cores, one block per thread.
#pragma once

#include <memory>

#include "kernels/host/native_kernels.h"
#include "worker/device.h"

namespace penumbra {

/// Errors: an instruction set that the machine lacks, not enough memory for the blocks, Embree does not
/// start.
Expected<std::unique_ptr<Device>> make_native_device(const DeviceScene& scene, const DeviceOptions& options);

}  // namespace penumbra
