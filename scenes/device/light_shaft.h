// What is between a piece of a surface and a flat light: the convex hull of both, by its planes.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace penumbra {

/// n . x + d, n a unit vector.
struct ShaftPlane {
  glm::dvec3 n{0};
  double d = 0;
  [[nodiscard]] double height(const glm::dvec3& p) const { return n.x * p.x + n.y * p.y + n.z * p.z + d; }
};

/// A convex planar polygon, of which a side counts: seen from there its corners run counter-clockwise.
struct ShaftEnd {
  std::vector<glm::dvec3> corners;
  ShaftPlane plane;  ///< above it is that side
};

/// Something in space: a triangle or the corners of a box.
struct Obstacle {
  std::array<glm::dvec3, 8> points{};
  int count = 0;
  ShaftPlane plane;  ///< a triangle's; 0 of a box and of triangles without an area
};

/// Of straight ways from the upper side of `surface` to the upper side of `light`, all of which are within
/// the hull of what of each is above the other.
class LightShaft {
 public:
  /// `slack`: what is no farther outside of it, or on it, than that is not in its way; far less than either.
  LightShaft(const ShaftEnd& surface, const ShaftEnd& light, double slack);

  /// Whether no point of the surface sees any of the light, whatever is between them.
  [[nodiscard]] bool is_empty() const { return planes_.empty(); }
  /// Whether a part of the light is beneath the surface; of the surface, beneath the light.
  [[nodiscard]] bool light_is_cut() const { return light_is_cut_; }
  [[nodiscard]] bool surface_is_cut() const { return surface_is_cut_; }
  /// False: the obstacle is not in the way. True may be wrong for those that are near an edge of the hull.
  [[nodiscard]] bool may_meet(const Obstacle& obstacle) const;

 private:
  void add_sides(const std::vector<glm::dvec3>& from, const ShaftPlane& plane,
                 const std::vector<glm::dvec3>& to);

  double slack_;
  bool light_is_cut_ = false, surface_is_cut_ = false;
  std::vector<glm::dvec3> corners_;  ///< of both ends
  std::vector<ShaftPlane> planes_;   ///< the hull is above them
};

/// Whether some corner of the obstacle is between every point of the surface and some of the light: no piece
/// of the surface has then a shaft without it.
bool hides_some(const Obstacle& obstacle, const ShaftEnd& surface, const ShaftEnd& light);

/// The part of a convex polygon that is above the plane.
std::vector<glm::dvec3> clip_above(const std::vector<glm::dvec3>& polygon, const ShaftPlane& plane);

/// The convex hull of points in a plane, seen from above it.
ShaftEnd hull_in_plane(std::span<const glm::dvec3> points, const ShaftPlane& plane);

}  // namespace penumbra
