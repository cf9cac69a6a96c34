// Axis-aligned bounding boxes of primitives, for building BVHs.
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

/// Half the surface area of a box: the number of lines that meet it is proportional to it.
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

/// How far outside of the box of its vertices a ray may hit the triangle by rounding, along each axis. A ray
/// computes a vertex with up to 5 roundings of the triangle's extent (two of the difference to its origin
/// along the shear's axis, times the shear, one of that along another axis, two of the result), and edges
/// between vertices with half a rounding more. This moves hits within the triangle's plane only. There is no
/// margin out of the plane, and no larger one, or rays would visit the surfaces that they leave. Errors that
/// grow with the hit's distance from the origin are covered by SLAB_MARGIN (intersect/bvh.h).
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

/// The box in which rays may hit the triangle, including rounding.
inline Box hit_bounds(const Triangle& t) {
  Box box = bounds_of(t);
  box.widen(hit_margin(t));
  return box;
}

/// The box of a piece of a curve. Where the plane of a tangent cuts a cone at an angle, the cone reaches
/// further than the sphere at its end.
inline Box bounds_of_curve(const Quadric& q) {
  const vec3 ends[] = {q.center, q.x_axis};
  const float thick = std::max(q.radius, q.length);
  float reach = thick;
  if (q.kind == QUADRIC_ROUND) {
    const vec3 step = sub(q.x_axis, q.center);
    const float length = length3(step);
    const float cosine = std::min(dot3(q.normal, step), dot3(q.y_axis, step) / length3(q.y_axis)) / length;
    const float slope = std::abs(q.radius - q.length) / length;
    // At a cosine of 0.95 the cut is 1.053 radii away, where the cone has grown by 3 % at most; anywhere,
    // within one radius beyond the end, it is thinner than two.
    reach *= cosine > 0.95f && slope < 0.1f ? 1.12f : 2.3f;
  }
  Box box;
  for (const vec3& end : ends) box.include(end);
  const auto margin = [&](float a, float b) {
    return reach + 1e-3f * thick + 1e-6f * std::max(std::abs(a), std::abs(b));
  };
  box.widen(make_vec3(margin(q.center.x, q.x_axis.x), margin(q.center.y, q.x_axis.y),
                      margin(q.center.z, q.x_axis.z)));
  return box;
}

/// Slightly larger than the sphere, disk or cylinder, for the rounding of centre, normal and radius.
inline Box bounds_of(const Quadric& q) {
  if (is_curve_kind(q.kind)) return bounds_of_curve(q);
  constexpr float kMargin = 1e-5f;
  const float center[3] = {q.center.x, q.center.y, q.center.z};
  const float axis[3] = {q.normal.x, q.normal.y, q.normal.z};
  // A disk's extent along an axis depends on the sine of the normal's angle to it. It is computed from the
  // other two components: the axis's own component would hide small angles.
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
