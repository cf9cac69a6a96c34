// Bounds of the parts of a triangle on either side of a plane, for hierarchies that split large triangles.
#pragma once

#include <utility>

#include "kernels/host/bounds.h"

namespace penumbra {

/// Cuts the part of the triangle inside `bounds` at `position` along `axis` (0, 1, 2). Returns a box around
/// the part below and one around the part above, both inside `bounds`. They are slightly larger than exact,
/// so that rounding leaves no point of the triangle outside both.
std::pair<Box, Box> split_bounds(const Triangle& triangle, const Box& bounds, int axis, float position);

}  // namespace penumbra
