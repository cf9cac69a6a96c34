// Whether a device scene that came over the wire can be traced without reading outside it.
#pragma once

#include "kernels/host/device_scene.h"

namespace penumbra {

/// Every table inside the words (with the records that kernels read unasked), every
/// index inside its table, every enumerated value known.
Expected<void> check_device_scene(const DeviceScene& scene);

}  // namespace penumbra
