// Chooses between BVH traversal and testing every primitive on a native device, for scenes that support both.
// Images do not depend on it.
#pragma once

#include "kernels/host/device_scene.h"
#include "kernels/host/native_kernels.h"

namespace penumbra {

/// Whether testing every triangle is probably faster than the BVH for bounced and shadow rays, with the
/// target's kernels.
bool tests_every_primitive(Isa isa, const DeviceScene& scene);

}  // namespace penumbra
