// Renders on an OpenCL device, one block per work item.
#pragma once

#include <memory>

#include "worker/device.h"
#include "worker/opencl_devices.h"

namespace penumbra {

/// Compiles the kernels for exactly the scene's features, or loads them from the cache. Errors: an Embree
/// scene, a failed compilation (with the device's log), not enough memory.
Expected<std::unique_ptr<Device>> make_opencl_device(const DeviceScene& scene, const DeviceOptions& options,
                                                     const OpenClDeviceInfo& info);
/// On the device that the options name. Error: there is none.
Expected<std::unique_ptr<Device>> make_opencl_device(const DeviceScene& scene, const DeviceOptions& options);

}  // namespace penumbra
