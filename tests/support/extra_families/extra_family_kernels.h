// Native kernels with additional BSDF families that only tests have, and scenes that use them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/host/device_scene.h"
#include "kernels/host/native_kernels.h"
#include "tests/support/extra_families/numbers.h"

namespace penumbra {

/// With all features and the additional families, on one lane or on as many as the renderer's own.
const NativeKernel& extra_family_kernel(bool one_lane = false);

/// Kernels that must give the same bits: that of one lane, and the renderer's own that this machine can run.
std::vector<NativeKernel> one_lane_and_native_kernels();

/// What a material of the scene becomes; the rest of it stays.
struct ExtraFamily {
  int material = 1;  ///< that of the description's BSDF of index 0 is 1
  int family = FAMILY_MIRROR;
  float specular = -1;  ///< negative: stays
  float exponent = -1;  ///< likewise
};

/// Stands them in.
void put_extra_families(DeviceScene& scene, std::span<const ExtraFamily> extra_families);

}  // namespace penumbra
