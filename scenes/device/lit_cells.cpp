#include "scenes/device/lit_cells.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <span>
#include <utility>
#include <vector>

#include "kernels/host/bounds.h"
#include "kernels/host/material_closure.h"
#include "scenes/device/light_shaft.h"
#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

// The width of the smallest cells, in pixels. Half of it is what a penumbra seems wider by.
constexpr double kCellPixels = 4;
// What finding cells may cost: obstacles looked at, some 30 ns each; obstacles beyond which it never pays.
constexpr std::int64_t kMostLooks = 1 << 21;
constexpr std::int64_t kShaftLooks = 32;  // that a shaft takes the time of
constexpr std::int64_t kWaysListed = 16;  // in the time of a look
constexpr std::size_t kMostObstacles = 1 << 16;
// Closed forms of more edges take longer than samples do.
constexpr std::size_t kMostAreaLightEdges = 128;
// What is no deeper in a shaft does not count, and neither does what surfaces share with their neighbours:
// some roundings of coordinates, of their extent.
constexpr double kSlack = 0x1p-22;
// By how much cells are larger than those that points are looked up in: of a cell, and roundings of a point.
constexpr double kCellMargin = 1.0 / 64, kPointRoundings = 32 * 0x1p-24;

ShaftPlane plane_through(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 cross = glm::cross(b - a, c - a);
  const double length = glm::length(cross);
  if (!(length > 0)) return {};
  return {cross / length, -glm::dot(cross, a) / length};
}

ShaftPlane flipped(const ShaftPlane& plane) { return {-plane.n, -plane.d}; }

Obstacle obstacle_of(const Triangle& t) {
  const glm::dvec3 a = to_dvec3(t.p0), b = to_dvec3(t.p1), c = to_dvec3(t.p2);
  return {{a, b, c}, 3, plane_through(a, b, c)};
}

Obstacle obstacle_of(const Quadric& q) {
  const Box box = bounds_of(q);
  Obstacle o{{}, 8, {}};
  for (int k = 0; k < 8; ++k)
    for (int axis = 0; axis < 3; ++axis)
      o.points[std::size_t(k)][axis] = (k >> axis & 1) != 0 ? box.high[axis] : box.low[axis];
  return o;
}

struct AreaLight {
  ShaftEnd front, back;
  bool two_sided;
};

/// What the camera sees of places, roughly: cells need no more.
class Eye {
 public:
  explicit Eye(const SceneHeader& h)
      : origin_(to_dvec3(h.camera.origin)),
        z_(to_dvec3(h.camera.z)),
        parallel_(h.camera.parallel != 0.0f),
        pinhole_((h.features & FEATURE_CAMERA) == 0u) {
    const glm::dvec3 x = to_dvec3(h.camera.x), y = to_dvec3(h.camera.y);
    pixels_ = h.film.width / (2 * glm::length(x));
    const double margin = 2 * (double(h.film.filter_radius) + 1);
    const glm::dvec3 wide = x * (1 + margin / h.film.width) / glm::dot(x, x);
    const glm::dvec3 high = y * (1 + margin / h.film.height) / glm::dot(y, y);
    for (const glm::dvec3& edge : {wide, -wide, high, -high}) edges_.push_back(z_ - edge);
  }

  [[nodiscard]] bool is_above(const ShaftPlane& plane) const {
    return parallel_ ? glm::dot(plane.n, z_) < 0 : plane.height(origin_) > 0;
  }
  /// The width of something about the place, in pixels.
  [[nodiscard]] double pixels(double width, const glm::dvec3& place) const {
    return parallel_ ? width * pixels_ : width * pixels_ / std::max(glm::length(place - origin_), 1e-30);
  }
  /// False: the camera sees none of the convex polygon.
  [[nodiscard]] bool may_see(std::span<const glm::dvec3> polygon) const {
    return !pinhole_ || std::ranges::none_of(edges_, [&](const glm::dvec3& n) {
      return std::ranges::all_of(polygon, [&](const glm::dvec3& p) { return glm::dot(n, p - origin_) < 0; });
    });
  }

 private:
  glm::dvec3 origin_, z_;
  bool parallel_, pinhole_;
  double pixels_;                  ///< of a unit at distance 1
  std::vector<glm::dvec3> edges_;  ///< normals of the planes about what is in view
};

class CellFinder {
 public:
  CellFinder(const SceneHeader& h, SceneRecords& records) : records_(records), eye_(h) {
    for (const Triangle& t : records.triangles) obstacles_.push_back(obstacle_of(t));
    for (const Quadric& q : records.quadrics) obstacles_.push_back(obstacle_of(q));
    for (const Obstacle& o : obstacles_)
      for (int k = 0; k < o.count; ++k)
        for (int axis = 0; axis < 3; ++axis)
          extent_ = std::max(extent_, std::abs(o.points[std::size_t(k)][axis]));
    for (const Polygon& polygon : records.polygons) add_area_light(polygon);
  }

  /// Whether there are any.
  bool find() {
    records_.lit_faces.assign(records_.triangles.size(), unlit());
    for (const int index : triangles_in_order()) {
      if (looks_left_ <= 0) break;
      find_on(index);
    }
    return !records_.lit_cells.empty();
  }

 private:
  static LitFace unlit() {
    LitFace face{};
    face.level = -1;
    return face;
  }

  void add_area_light(const Polygon& polygon) {
    std::vector<glm::dvec3> corners;
    glm::dvec3 normal(0);  // of the outline, by Newell's sums
    for (int k = 0; k < polygon.corner_count; ++k) {
      const PolygonCorner& corner = records_.polygon_corners[std::size_t(polygon.first_corner + k)];
      const glm::dvec3 p = to_dvec3(corner.p);
      if (corner.starts == 0) normal += glm::cross(corners.back() - corners.front(), p - corners.front());
      corners.push_back(p);
    }
    normal = glm::normalize(normal);
    // Behind all corners, which are off a plane by as much as outlines may be.
    const auto end_towards = [&](const glm::dvec3& n) {
      double least = glm::dot(n, corners.front());
      for (const glm::dvec3& p : corners) least = std::min(least, glm::dot(n, p));
      return hull_in_plane(corners, {n, -least});
    };
    area_lights_.push_back({end_towards(normal), end_towards(-normal), polygon.two_sided != 0});
  }

  /// Those that may have cells, largest first as they are seen.
  [[nodiscard]] std::vector<int> triangles_in_order() const {
    std::vector<std::pair<double, int>> found;  // by falling size
    for (std::size_t i = 0; i < records_.triangles.size(); ++i) {
      const Obstacle& o = obstacles_[i];
      const std::span corners(o.points.data(), 3);
      if (o.plane.n == glm::dvec3(0) || !eye_.may_see(corners) || !has_closed_form_on(int(i))) continue;
      const glm::dvec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
      const double area = glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
      const double pixels = eye_.pixels(std::sqrt(area), middle);
      if (pixels > kCellPixels) found.emplace_back(-pixels, int(i));
    }
    std::ranges::sort(found);
    std::vector<int> order;
    for (const auto& [size, index] : found) order.push_back(index);
    return order;
  }

  [[nodiscard]] bool front_is_seen(int index) const {
    return eye_.is_above(obstacles_[std::size_t(index)].plane);
  }

  [[nodiscard]] bool has_closed_form_on(int index) const {
    const Triangle& t = records_.triangles[std::size_t(index)];
    const Material& m = records_.materials[std::size_t(front_is_seen(index) ? t.front : t.back)];
    return m.branches == 0 && has_closed_form(closure_of(m));
  }

  void find_on(int index) {
    const Triangle& t = records_.triangles[std::size_t(index)];
    const auto& corners = obstacles_[std::size_t(index)].points;
    face_.front = front_is_seen(index) ? 1 : 0;
    smooth_ = t.normals >= 0;
    plane_ = obstacles_[std::size_t(index)].plane;
    if (face_.front == 0) plane_ = flipped(plane_);
    corner_ = corners[0];
    along_x_ = corners[1] - corners[0];
    along_y_ = corners[2] - corners[0];
    // Rows of the inverse: of a way within the plane, how much of either side it is.
    const glm::dvec3 n = glm::cross(along_x_, along_y_);
    const glm::dvec3 row_x = glm::cross(along_y_, n) / glm::dot(n, n),
                     row_y = glm::cross(n, along_x_) / glm::dot(n, n);
    face_.row_x = to_vec3(row_x);
    face_.row_y = to_vec3(row_y);
    face_.at_x = float(-glm::dot(row_x, corner_));
    face_.at_y = float(-glm::dot(row_y, corner_));
    const glm::dvec3 inwards = -glm::cross(along_y_ - along_x_, n);
    third_side_ = {inwards, -glm::dot(inwards, corner_ + along_x_)};
    point_margin_ = kPointRoundings * extent_ * std::max(glm::length(row_x), glm::length(row_y));
    double nearest = 0;  // as large as it is seen anywhere
    width_ = std::max(glm::length(along_x_), glm::length(along_y_));
    for (int k = 0; k < 3; ++k) nearest = std::max(nearest, eye_.pixels(width_, corners[std::size_t(k)]));
    nearest = std::max(nearest, eye_.pixels(width_, corner_ + (along_x_ + along_y_) / 3.0));
    face_.level = int(std::clamp(std::ceil(std::log2(nearest / kCellPixels)), 0.0, double(LIT_CELL_LEVELS)));
    const std::size_t words = ((std::size_t(1) << 2 * face_.level) + 31) / 32;
    cells_.assign(words, 0u);
    any_ = false;
    std::vector<Way> ways;
    for (int area_light = 0; area_light < int(area_lights_.size()); ++area_light)
      for (int k = 0; k < int(obstacles_.size()); ++k)
        if (k != index && !is_part(k, area_light)) ways.push_back({area_light, k});
    looks_left_ -= std::int64_t(ways.size()) / kWaysListed;
    divide(0, 0, 0, ways);
    if (!any_) return;
    face_.first = int(records_.lit_cells.size());
    records_.lit_faces[std::size_t(index)] = face_;
    records_.lit_cells.insert(records_.lit_cells.end(), cells_.begin(), cells_.end());
  }

  /// An obstacle that may be in the way to a light.
  struct Way {
    int area_light, obstacle;
  };

  [[nodiscard]] bool is_part(int primitive, int area_light) const {
    if (std::size_t(primitive) >= records_.triangles.size()) return false;
    const int light = records_.triangles[std::size_t(primitive)].light;
    return light >= 0 && records_.lights[std::size_t(light)].polygon == area_light;
  }

  /// The cell (x, y) of 2^level by 2^level. `ways`: those of the cell about it.
  void divide(int level, int x, int y, const std::vector<Way>& ways) {
    const double side = std::exp2(level);
    const std::vector<glm::dvec3> corners = corners_of_cell(x / side, y / side, 1 / side);
    if (corners.empty() || looks_left_ <= 0 || !eye_.may_see(corners)) return;
    const glm::dvec3 middle = (corners.front() + corners[corners.size() / 2]) / 2.0;
    const bool divides = level < face_.level && eye_.pixels(width_ / side, middle) >= kCellPixels;
    std::vector<Way> left;
    const Sight sight = look(corners, ways, divides, left);
    if (sight == Sight::kAll) light(level, x, y);
    if (sight != Sight::kSome || !divides) return;
    for (int k = 0; k < 4; ++k) divide(level + 1, 2 * x + (k & 1), 2 * y + (k >> 1), left);
  }

  /// What of the triangle is in the cell that begins at (x, y), and a little more.
  [[nodiscard]] std::vector<glm::dvec3> corners_of_cell(double x, double y, double size) const {
    const double margin = kCellMargin * std::exp2(-face_.level) + point_margin_;
    const double x0 = std::max(x - margin, 0.0), y0 = std::max(y - margin, 0.0), x1 = x + size + margin,
                 y1 = y + size + margin;
    const auto at = [&](double u, double v) { return corner_ + u * along_x_ + v * along_y_; };
    std::vector<glm::dvec3> corners{at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)};
    corners = clip_above(corners, third_side_);
    if (face_.front == 0) std::ranges::reverse(corners);
    return corners;
  }

  /// What a cell sees: all lights whole, or not, or no part of it does.
  enum class Sight { kAll, kSome, kNeverAll };

  /// `left`: of the ways those that may be in the way within the cell; not all if it is not divided. It sees
  /// not all, either, where closed forms have something else: of normals that are not the surface's own, or
  /// of both sides of a light.
  Sight look(const std::vector<glm::dvec3>& corners, const std::vector<Way>& ways, bool divides,
             std::vector<Way>& left) {
    Sight sight = Sight::kAll;
    const ShaftEnd surface{.corners = corners, .plane = plane_};
    std::size_t next = 0;
    for (int area_light = 0; area_light < int(area_lights_.size()); ++area_light) {
      const AreaLight& l = area_lights_[std::size_t(area_light)];
      const bool behind = std::ranges::all_of(
          corners, [&](const glm::dvec3& p) { return l.front.plane.height(p) <= kSlack * extent_; });
      const ShaftEnd& light = l.two_sided && behind ? l.back : l.front;
      const LightShaft shaft(surface, light, kSlack * extent_);
      looks_left_ -= kShaftLooks;
      if ((smooth_ && shaft.light_is_cut()) || (l.two_sided && shaft.surface_is_cut())) sight = Sight::kSome;
      for (; next < ways.size() && ways[next].area_light == area_light; ++next, --looks_left_) {
        const Obstacle& obstacle = obstacles_[std::size_t(ways[next].obstacle)];
        if (!shaft.may_meet(obstacle)) continue;
        sight = Sight::kSome;
        if (!divides) return sight;
        if (hides_some(obstacle, surface, light)) return Sight::kNeverAll;
        left.push_back(ways[next]);
      }
    }
    return sight;
  }

  /// All of the cell.
  void light(int level, int x, int y) {
    const int finer = face_.level - level, side = 1 << finer;
    for (int v = y * side; v < (y + 1) * side; ++v)
      for (int u = x * side; u < (x + 1) * side; ++u) {
        const auto cell = (std::uint32_t(v) << face_.level) + std::uint32_t(u);
        cells_[cell / 32] |= 1u << cell % 32;
      }
    any_ = true;
  }

  SceneRecords& records_;
  Eye eye_;
  std::vector<Obstacle> obstacles_;  ///< one for each primitive
  std::vector<AreaLight> area_lights_;
  double extent_ = 0;  ///< of all coordinates
  std::int64_t looks_left_ = kMostLooks;
  // Of the triangle at hand:
  LitFace face_{};
  ShaftPlane plane_;  ///< above it is the side that is seen
  bool smooth_ = false, any_ = false;
  glm::dvec3 corner_{0}, along_x_{0}, along_y_{0};
  double width_ = 0;       ///< of its longer side along x or y
  ShaftPlane third_side_;  ///< the triangle is above it; n is no unit vector
  double point_margin_ = 0;
  std::vector<std::uint32_t> cells_;
};

/// Whether all light is that of samples of polygons, which nothing but surfaces where they are can stop.
bool may_have_cells(const SceneHeader& h, const SceneRecords& records) {
  const IntegratorParameters& p = h.integrator;
  const bool samples = p.kind == INTEGRATOR_DIRECT && p.estimator == ESTIMATOR_SAMPLES &&
                       p.emitter_samples > 0 && p.trace_shadows != 0;
  const bool polygons = !records.polygons.empty() &&
                        std::ranges::all_of(records.lights, [](const Light& l) { return l.polygon >= 0; });
  return samples && polygons && records.polygon_corners.size() <= kMostAreaLightEdges &&
         records.triangles.size() + records.quadrics.size() <= kMostObstacles &&
         (h.features & (FEATURE_MEDIA | FEATURE_INSTANCES | FEATURE_BENT)) == 0u;
}

}  // namespace

void add_lit_cells(SceneHeader& header, SceneRecords& records) {
  if (!may_have_cells(header, records)) return;
  if (CellFinder(header, records).find())
    header.features |= FEATURE_LIT_CELLS;
  else
    records.lit_faces.clear();
}

}  // namespace penumbra
