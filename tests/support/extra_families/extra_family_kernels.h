// Native kernels with additional BSDF families that only tests have, and scenes that use them.
#pragma once

#include <cstdint>
#include <span>

#include "kernels/host/device_scene.h"
#include "kernels/host/native_kernels.h"
#include "tests/support/extra_families/numbers.h"

namespace penumbra {

/// With all features: one lane, or lanes of SSE2.
const NativeKernel& extra_family_kernel(bool one_lane = false);

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
