// The records of curves: straight pieces, see kernels/intersect/curve.h.
#pragma once

#include <functional>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/curves.h"

namespace penumbra {

/// The pieces of all curves, without materials. `local(p, reach)`: a position in the records' coordinates,
/// and how far the piece reaches from there. Pieces are within a quarter of the radius of the curve, or
/// nearer where there are few; at most 64 make a segment of a spline. What has no length or no thickness is
/// left out.
std::vector<Quadric> curve_pieces(const Curves& curves,
                                  const std::function<vec3(const glm::dvec3& p, double reach)>& local);

}  // namespace penumbra
