// LDR-FLIP on linear light, the last step of both forms of FLIP.
#pragma once

#include <array>

#include "scheduler/image/metrics/flip_filters.h"

namespace penumbra {

/// Linear R, G, B for a display, each in [0, 1].
using LinearPlanes = std::array<Plane, 3>;

/// The error of each pixel, in [0, 1].
Plane flip_of_linear_light(const LinearPlanes& reference, const LinearPlanes& image,
                           double pixels_per_degree);

}  // namespace penumbra
