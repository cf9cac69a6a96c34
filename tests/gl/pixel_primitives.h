// The primitives that pixels see, found by testing all of them.
#pragma once

#include <vector>

#include "kernels/host/device_scene.h"

namespace penumbra {

/// Of each pixel's centre, row by row from the top; -1 where there is none.
std::vector<int> pixel_primitives(const DeviceScene& scene);

/// For each pixel whether all of its 3 x 3 neighbourhood sees the same primitive.
std::vector<char> pixels_off_silhouettes(const DeviceScene& scene);

/// For each pixel whether it sees a part of a polygon light.
std::vector<char> pixels_on_polygon_lights(const DeviceScene& scene);

}  // namespace penumbra
