// What a scene costs, with what only this program knows: the native kernels and, on request, the OpenCL
// compiler.
#pragma once

#include <string>

#include "kernels/host/error.h"
#include "scenes/device/scene_inventory.h"
#include "worker/device.h"

namespace penumbra {

/// See take_inventory; with the native kernels of that instruction set.
SceneInventory scene_costs(const SceneDescription& description, const DeviceScene& scene, Isa isa,
                           bool thorough);

/// Asks penumbra-worker to compile OpenCL kernels for the scene, which takes half a minute. Errors: an Embree
/// scene, no device, kernels that do not compile.
Expected<CompileTimes> measure_compile_times(const DeviceScene& scene, const std::string& opencl_device);

}  // namespace penumbra
