// Axis-aligned boxes of primitives, for building hierarchies.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/scene_types.h"

namespace penumbra {

struct Box {
  float low[3] = {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
                  std::numeric_limits<float>::infinity()};
  float high[3] = {-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                   -std::numeric_limits<float>::infinity()};

  void include(const vec3& p) {
    const float c[3] = {p.x, p.y, p.z};
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], c[k]);
      high[k] = std::max(high[k], c[k]);
    }
  }
  void include(const Box& other) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], other.low[k]);
      high[k] = std::max(high[k], other.high[k]);
    }
  }
  void widen(const vec3& margin) {
    const float c[3] = {margin.x, margin.y, margin.z};
    for (int k = 0; k < 3; ++k) {
      low[k] -= c[k];
      high[k] += c[k];
    }
  }
};

/// Half the surface of a box, to which the number of lines that meet it is proportional.
inline double half_area(const Box& box) {
  const double x = double(box.high[0]) - box.low[0], y = double(box.high[1]) - box.low[1],
               z = double(box.high[2]) - box.low[2];
  return x * y + y * z + z * x;
}

inline Box bounds_of(const Triangle& t) {
  Box box;
  box.include(t.p0);
  box.include(t.p1);
  box.include(t.p2);
  return box;
}

/// By how far outside the box about its vertices a ray may seem to hit the triangle, along each axis. A ray
/// sees a vertex with up to 5 roundings of how wide the triangle is (two of the difference to its origin
/// along the shear's axis, times the shear, one of that along another, two of what is left), and edges
/// through them with half a one more. That moves hits within the triangle's plane; out of it there is no
/// margin, and no more than that, or rays would visit the walls that they leave. What grows with the hit's
/// distance from the origin is left to SLAB_MARGIN (intersect/bvh.h).
inline vec3 hit_margin(const Triangle& t) {
  const double a[3] = {double(t.p1.x) - t.p0.x, double(t.p1.y) - t.p0.y, double(t.p1.z) - t.p0.z},
               b[3] = {double(t.p2.x) - t.p0.x, double(t.p2.y) - t.p0.y, double(t.p2.z) - t.p0.z};
  double extent = 0, normal[3], length2 = 0;
  for (int k = 0; k < 3; ++k) {
    extent = std::max(extent, std::max({a[k], b[k], 0.0}) - std::min({a[k], b[k], 0.0}));
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    normal[k] = a[i] * b[j] - a[j] * b[i];
    length2 += normal[k] * normal[k];
  }
  const double roundings = 6 * 0x1p-24 * extent;
  const auto along = [&](int k) {
    return float(length2 > 0 ? roundings * std::sqrt(std::max(1 - normal[k] * normal[k] / length2, 0.0))
                             : roundings);
  };
  return make_vec3(along(0), along(1), along(2));
}

/// Where rays may seem to hit the triangle.
inline Box hit_bounds(const Triangle& t) {
  Box box = bounds_of(t);
  box.widen(hit_margin(t));
  return box;
}

/// A little more than the sphere, disk or cylinder, for the rounding of centre, normal and radius.
inline Box bounds_of(const Quadric& q) {
  constexpr float kMargin = 1e-5f;
  const float center[3] = {q.center.x, q.center.y, q.center.z};
  const float axis[3] = {q.normal.x, q.normal.y, q.normal.z};
  // Along an axis a disk reaches as far as its normal leans away from it; the axis's own component would hide
  // small leans.
  const float lean[3] = {std::hypot(q.normal.y, q.normal.z), std::hypot(q.normal.z, q.normal.x),
                         std::hypot(q.normal.x, q.normal.y)};
  Box box;
  for (int k = 0; k < 3; ++k) {
    const float reach = q.kind == QUADRIC_SPHERE ? q.radius : q.radius * lean[k];
    const float along = q.kind == QUADRIC_CYLINDER ? q.length * axis[k] : 0.0f;
    const float margin = (std::abs(center[k]) + q.radius + std::abs(along)) * kMargin;
    box.low[k] = center[k] + std::min(along, 0.0f) - reach - margin;
    box.high[k] = center[k] + std::max(along, 0.0f) + reach + margin;
  }
  return box;
}

}  // namespace penumbra
