// Checks that a device scene from the network can be traced without reading outside of it.
#pragma once

#include "kernels/host/device_scene.h"

namespace penumbra {

/// Checks that every table is inside the words (including the records that kernels read in empty tables),
/// every index is inside its table, and every enumerated value is known.
Expected<void> check_device_scene(const DeviceScene& scene);

}  // namespace penumbra
