// Native kernels that have the stand-in families, and scenes of them.
#pragma once

#include <cstdint>
#include <span>

#include "kernels/host/device_scene.h"
#include "kernels/host/native_kernels.h"
#include "tests/support/stand_in_families/numbers.h"

namespace penumbra {

/// With all features: one lane, or lanes of SSE2.
const NativeKernel& stand_in_kernel(bool one_lane = false);

/// What a material of the scene becomes; the rest of it stays.
struct StandIn {
  int material = 1;  ///< that of the description's BSDF of index 0 is 1
  int family = FAMILY_MIRROR;
  float specular = -1;  ///< negative: stays
  float exponent = -1;  ///< likewise
};

/// Stands them in.
void stand_in(DeviceScene& scene, std::span<const StandIn> stand_ins);

}  // namespace penumbra
