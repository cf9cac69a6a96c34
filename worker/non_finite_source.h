// Where a path first held a non-finite value, for statistics and messages.
#pragma once

#include "worker/device.h"

namespace penumbra {

/// A device that also says of the first NaN and the first infinite sample of each unit where it
/// became so: by doing that one path again, natively, a stage at a time. The scene must outlive it.
std::unique_ptr<Device> with_sources(std::unique_ptr<Device> device, const DeviceScene& scene,
                                     const DeviceOptions& options);

}  // namespace penumbra
