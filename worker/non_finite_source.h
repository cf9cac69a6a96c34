// Finds where a path first had a non-finite value, for statistics and messages.
#pragma once

#include "worker/device.h"

namespace penumbra {

/// A device that also reports, for the first NaN and the first infinite sample of each unit, where the value
/// became non-finite. It renders this one path again with native code, stage by stage. The scene must outlive
/// the device.
std::unique_ptr<Device> with_sources(std::unique_ptr<Device> device, const DeviceScene& scene,
                                     const DeviceOptions& options);

}  // namespace penumbra
