// Axis-aligned boxes of primitives, for building hierarchies.
#pragma once

#include <algorithm>
#include <array>
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
  void widen(float margin) {
    for (int k = 0; k < 3; ++k) {
      low[k] -= margin;
      high[k] += margin;
    }
  }
};

/// By how far outside the box about its vertices a ray may seem to hit the triangle. Vertices are rounded as
/// the ray sees them: the differences to its origin, their shear, the products of edge functions, some 8
/// roundings of a vertex's distance from the hit, and as many of where the hit is along the ray. What grows
/// with the hit's distance from the origin is within SLAB_MARGIN and END_MARGIN (intersect/bvh.h).
inline float hit_margin(const Triangle& t) {
  float extent = 0;
  for (const auto& [a, b, c] : {std::array{t.p0.x, t.p1.x, t.p2.x}, std::array{t.p0.y, t.p1.y, t.p2.y},
                                std::array{t.p0.z, t.p1.z, t.p2.z}})
    extent = std::max(extent, std::max({a, b, c}) - std::min({a, b, c}));
  return 16 * 0x1p-24f * extent;
}

/// With the margin for hits.
inline Box bounds_of(const Triangle& t) {
  Box box;
  box.include(t.p0);
  box.include(t.p1);
  box.include(t.p2);
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
