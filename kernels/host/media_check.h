// Checks the tables of participating media.
#pragma once

#include <string>

#include "kernels/host/device_scene.h"

namespace penumbra {

/// What is wrong with the media of a scene whose tables are there, and with their boundaries, volumes and
/// lights; empty: nothing.
std::string media_problem(const DeviceScene& scene);

}  // namespace penumbra
