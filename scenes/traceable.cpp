#include "scenes/traceable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

Expected<void> check_quadric(const char* name, const glm::dvec3& center, double least_size, double reach) {
  const double farthest = std::max({std::abs(center.x), std::abs(center.y), std::abs(center.z)}) + reach;
  if (!(farthest < kFarthestQuadric))
    return fail(fmt::format("the {} is too far away or too large: it reaches {}, and single precision {}",
                            name, farthest, kFarthestQuadric));
  if (!(least_size > kSmallestRadius))
    return fail(fmt::format("the {} is too small for single precision: {}", name, least_size));
  return {};
}

struct Check {
  Expected<void> operator()(const Sphere& s) const {
    return check_quadric("sphere", s.center, s.radius, s.radius);
  }
  Expected<void> operator()(const Disk& d) const {
    return check_quadric("disk", d.center, d.radius, d.radius);
  }
  Expected<void> operator()(const Cylinder& c) const {
    return check_quadric("cylinder", c.center, std::min(c.radius, c.length), c.radius + c.length);
  }
  Expected<void> operator()(const Curves& curves) const {
    for (const Curve& curve : curves.curves)
      for (const ControlPoint& point : curve) {
        if (!is_traceable(point))
          return fail(
              fmt::format("a curve is too far away or too thick for single precision: a radius of {} at "
                          "({}, {}, {})",
                          point.radius, point.position.x, point.position.y, point.position.z));
      }
    return {};
  }
  Expected<void> operator()(const Mesh& mesh) const {
    const auto near = check_vertices(mesh);
    return near ? check_faces(mesh) : near;
  }
};

}  // namespace

double triangle_cross(const Mesh& mesh, const glm::uvec3& triangle) {
  const glm::dvec3 &a = mesh.positions[triangle.x], &b = mesh.positions[triangle.y],
                   &c = mesh.positions[triangle.z];
  return glm::length(glm::cross(b - a, c - a));
}

Expected<void> check_vertices(const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::dvec3& p = mesh.positions[i];
    if (std::abs(p.x) < kFarthest && std::abs(p.y) < kFarthest && std::abs(p.z) < kFarthest) continue;
    return fail(fmt::format("vertex {} is too far away for single precision: ({}, {}, {}) in the world",
                            i + 1, p.x, p.y, p.z));
  }
  return {};
}

Expected<void> check_faces(const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const double cross = triangle_cross(mesh, mesh.triangles[i]);
    if (cross < kLargestCross && cross > kSmallestCross) continue;
    return fail(fmt::format("triangle {} is too {} for single precision: its area is {}", i + 1,
                            cross > kSmallestCross ? "large" : "small", 0.5 * cross));
  }
  return {};
}

bool is_traceable(const ControlPoint& point) {
  const glm::dvec3 far = glm::abs(point.position);
  return far.x + far.y + far.z + std::abs(point.radius) < kFarthest;
}

Expected<void> check_traceable(const Geometry& geometry) { return std::visit(Check(), geometry); }

}  // namespace penumbra
