// Renders on an OpenCL device, a block per work item.
#pragma once

#include <memory>

#include "worker/device.h"
#include "worker/opencl_devices.h"

namespace penumbra {

/// Compiles the kernels with exactly the scene's features, or takes them from the cache. Errors: a scene that
/// asks for Embree, a compile that fails (with the device's log), not enough memory.
Expected<std::unique_ptr<Device>> make_opencl_device(const DeviceScene& scene, const DeviceOptions& options,
                                                     const OpenClDeviceInfo& info);
/// On the device that the options name; that there is none is an error.
Expected<std::unique_ptr<Device>> make_opencl_device(const DeviceScene& scene, const DeviceOptions& options);

}  // namespace penumbra
