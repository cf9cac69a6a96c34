// Bounds of the parts of a triangle on either side of a plane, for hierarchies that split large triangles.
#pragma once

#include <utility>

#include "kernels/host/bounds.h"

namespace penumbra {

/// The triangle's part inside `bounds`, cut at `position` along `axis` (0, 1, 2): a box around what lies
/// below it and one around what lies above, neither beyond `bounds`. A little more than the exact ones, so
/// that no point of the triangle falls between them by rounding.
std::pair<Box, Box> split_bounds(const Triangle& triangle, const Box& bounds, int axis, float position);

}  // namespace penumbra
