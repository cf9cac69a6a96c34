#include "scenes/device/light_shaft.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <utility>

namespace penumbra {

std::vector<glm::dvec3> clip_above(const std::vector<glm::dvec3>& polygon, const ShaftPlane& plane) {
  std::vector<glm::dvec3> part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double ha = plane.height(a), hb = plane.height(b);
    if (ha >= 0) part.push_back(a);
    if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) part.push_back(a + ha / (ha - hb) * (b - a));
  }
  return part.size() < 3 ? std::vector<glm::dvec3>() : part;
}

ShaftEnd hull_in_plane(std::span<const glm::dvec3> points, const ShaftPlane& plane) {
  const glm::dvec3 other = std::abs(plane.n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(other, plane.n)), y = glm::cross(plane.n, x);
  std::vector<std::pair<glm::dvec2, glm::dvec3>> order;
  for (const glm::dvec3& p : points) order.push_back({{glm::dot(x, p), glm::dot(y, p)}, p});
  const auto before = [](const auto& a, const auto& b) {
    return std::pair(a.first.x, a.first.y) < std::pair(b.first.x, b.first.y);
  };
  std::ranges::sort(order, before);
  // Andrew's monotone chains: the lower one from left to right, then the upper one back.
  std::vector<std::pair<glm::dvec2, glm::dvec3>> hull;
  for (int turn = 0; turn < 2; ++turn) {
    const std::size_t first = hull.size();
    for (const auto& p : order) {
      const auto turns_left = [&] {
        const glm::dvec2 a = hull[hull.size() - 2].first, b = hull.back().first;
        return (b.x - a.x) * (p.first.y - a.y) - (b.y - a.y) * (p.first.x - a.x) > 0;
      };
      while (hull.size() >= first + 2 && !turns_left()) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();  // the other chain begins with it
    std::ranges::reverse(order);
  }
  ShaftEnd end{{}, plane};
  for (const auto& p : hull) end.corners.push_back(p.second);
  return end;
}

LightShaft::LightShaft(const ShaftEnd& surface, const ShaftEnd& light, double slack) : slack_(slack) {
  const std::vector<glm::dvec3> near = clip_above(surface.corners, light.plane);
  const std::vector<glm::dvec3> far = clip_above(light.corners, surface.plane);
  const auto cuts = [&](const ShaftPlane& plane, const std::vector<glm::dvec3>& corners) {
    return std::ranges::any_of(corners, [&](const glm::dvec3& p) { return plane.height(p) < -slack_; });
  };
  light_is_cut_ = cuts(surface.plane, light.corners);
  surface_is_cut_ = cuts(light.plane, surface.corners);
  if (near.empty() || far.empty()) return;
  planes_ = {surface.plane, light.plane};
  add_sides(near, surface.plane, far);
  add_sides(far, light.plane, near);
  corners_ = near;
  corners_.insert(corners_.end(), far.begin(), far.end());
}

/// The hull's faces at the edges of one end, in the plane, which each have a corner of the other: that of
/// which no other is outside. Where one that is in the plane itself is, the face is the plane.
void LightShaft::add_sides(const std::vector<glm::dvec3>& from, const ShaftPlane& plane,
                           const std::vector<glm::dvec3>& to) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    const glm::dvec3 &a = from[i], along = from[(i + 1) % from.size()] - a;
    const double size = glm::length(along);
    if (!(size > slack_)) continue;
    const glm::dvec3 inwards = glm::cross(plane.n, along) / size;
    glm::dvec3 n(0);
    bool is_open = false;
    for (const glm::dvec3& p : to) {
      const bool in_plane = plane.height(p) <= slack_;
      is_open = is_open || (in_plane && glm::dot(inwards, p - a) < slack_);
      if (!in_plane && (n == glm::dvec3(0) || glm::dot(n, p - a) < 0))
        n = glm::normalize(glm::cross(p - a, along));
    }
    if (!is_open && n != glm::dvec3(0)) planes_.push_back({n, -glm::dot(n, a)});
  }
}

bool hides_some(const Obstacle& obstacle, const ShaftEnd& surface, const ShaftEnd& light) {
  // Places from which a point hides some of a convex light are a cone, so a polygon is in it if its corners
  // are.
  const auto is_hidden_from = [&](const glm::dvec3& p, const glm::dvec3& from) {
    const double start = light.plane.height(from), height = light.plane.height(p);
    if (!(height > 0 && start > height)) return false;
    const glm::dvec3 at = from + start / (start - height) * (p - from);
    for (std::size_t i = 0; i < light.corners.size(); ++i) {
      const glm::dvec3 &a = light.corners[i], along = light.corners[(i + 1) % light.corners.size()] - a;
      if (!(glm::dot(glm::cross(light.plane.n, along), at - a) > 0)) return false;
    }
    return true;
  };
  return std::any_of(
      obstacle.points.begin(), obstacle.points.begin() + obstacle.count, [&](const glm::dvec3& p) {
        return surface.plane.height(p) > 0 &&
               std::ranges::all_of(surface.corners,
                                   [&](const glm::dvec3& from) { return is_hidden_from(p, from); });
      });
}

bool LightShaft::may_meet(const Obstacle& obstacle) const {
  if (is_empty()) return false;
  const std::span<const glm::dvec3> points(obstacle.points.data(), std::size_t(obstacle.count));
  for (const ShaftPlane& plane : planes_)
    if (std::ranges::all_of(points, [&](const glm::dvec3& p) { return plane.height(p) <= slack_; }))
      return false;
  if (obstacle.plane.n == glm::dvec3(0)) return true;
  bool above = true, below = true;
  for (const glm::dvec3& p : corners_) {
    const double height = obstacle.plane.height(p);
    above = above && height >= -slack_;
    below = below && height <= slack_;
  }
  return !above && !below;
}

}  // namespace penumbra
