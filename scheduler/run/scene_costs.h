// The cost of a scene, including the native kernels and, on request, OpenCL compile times.
#pragma once

#include <string>

#include "kernels/host/error.h"
#include "scenes/device/scene_inventory.h"
#include "worker/device.h"

namespace penumbra {

/// take_inventory, with the native kernels of the given instruction set.
SceneInventory scene_costs(const SceneDescription& description, const DeviceScene& scene, Isa isa,
                           bool thorough);

/// Lets penumbra-worker compile OpenCL kernels for the scene, which takes half a minute. Errors: a scene for
/// Embree, no device, kernels that do not compile.
Expected<CompileTimes> measure_compile_times(const DeviceScene& scene, const std::string& opencl_device);

}  // namespace penumbra
