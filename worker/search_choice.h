// Which search a native device takes for a scene that has both: no image depends on it.
#pragma once

#include "kernels/host/device_scene.h"
#include "kernels/host/native_kernels.h"

namespace penumbra {

/// Whether bounced and shadow rays of a scene with a hierarchy that could also be tested whole are likely to
/// be found sooner by testing every triangle, by the target's kernels.
bool tests_every_primitive(KernelTarget target, const DeviceScene& scene);

}  // namespace penumbra
