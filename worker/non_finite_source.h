// The stage in which a path first held a non-finite value, for the report.
#pragma once

#include "worker/device.h"

namespace penumbra {

/// A device that also says of the first NaN and the first infinite sample of each unit in which stage it
/// became so: by doing that one path again, natively, a stage at a time. The scene must outlive it.
std::unique_ptr<Device> with_stages(std::unique_ptr<Device> device, const DeviceScene& scene,
                                    const DeviceOptions& options);

}  // namespace penumbra
