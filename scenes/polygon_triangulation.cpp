#include "scenes/polygon_triangulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace penumbra {
namespace {

using Points = std::vector<glm::dvec2>;

/// The polygon in its plane, scaled to an extent of about 1.
struct FlatPolygon {
  Points points;
  std::vector<std::uint32_t> corners;  ///< for each point the index of its corner
  /// Bound on the error of a point's coordinates due to the rounding of the corners.
  double position_error = 0.0;
};

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// Twice the signed area of (a, b, c), positive where they turn left.
double turn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) { return cross(b - a, c - a); }

std::vector<glm::uvec3> fan(std::span<const std::uint32_t> corners) {
  std::vector<glm::uvec3> triangles;
  triangles.reserve(corners.size() - 2);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    triangles.emplace_back(corners[0], corners[i], corners[i + 1]);
  return triangles;
}

double largest(glm::dvec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

enum class Outline { kNoArea, kConvex, kConcave, kTangled };

/// Projects the corners to the polygon's plane. kNoArea: the area is zero within rounding. kTangled: parts
/// have area, but it cancels. Otherwise kConcave; then `flat` and `deviation` (as in Triangulation) are set.
Outline flatten(std::span<const glm::dvec3> corners, FlatPolygon& flat, double& deviation) {
  double extent = 0.0, furthest = 0.0;
  for (const glm::dvec3& corner : corners) {
    extent = std::max(extent, largest(corner - corners[0]));
    furthest = std::max(furthest, largest(corner));
  }
  if (!(extent > 0.0) || !std::isfinite(extent)) return Outline::kNoArea;
  flat.position_error = std::numeric_limits<double>::epsilon() * (1.0 + furthest / extent);
  const auto scaled = [&](std::size_t i) { return (corners[i] - corners[0]) / extent; };
  glm::dvec3 normal(0.0), mean(0.0);
  double most = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 part = glm::cross(scaled(i), scaled((i + 1) % corners.size()));
    normal += part;
    most = std::max(most, largest(part));
    mean += scaled(i) / double(corners.size());
  }
  // The error of sums of products of numbers that are at most 1 and off by position_error.
  const double error = 4.0 * flat.position_error;
  if (!(most > error)) return Outline::kNoArea;
  if (!(glm::length(normal) > error * double(corners.size()))) return Outline::kTangled;
  normal = glm::normalize(normal);
  const glm::dvec3 across = std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(across, normal)), v = glm::cross(normal, u);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 p = scaled(i);
    deviation = std::max(deviation, std::abs(glm::dot(p - mean, normal)));
    const glm::dvec2 point(glm::dot(p, u), glm::dot(p, v));
    // Consecutive equal corners are merged.
    if (!flat.points.empty() && point == flat.points.back()) continue;
    flat.points.push_back(point);
    flat.corners.push_back(std::uint32_t(i));
  }
  while (flat.points.size() > 1 && flat.points.back() == flat.points.front()) {
    flat.points.pop_back();
    flat.corners.pop_back();
  }
  return flat.points.size() < 3 ? Outline::kNoArea : Outline::kConcave;
}

/// Classifies by the turns at the corners: for an outline that does not cross itself they sum to one
/// revolution.
Outline classify_turns(const FlatPolygon& flat) {
  const Points& p = flat.points;
  const std::size_t n = p.size();
  double sum = 0.0;
  bool convex = true;
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2 before = p[i] - p[(i + n - 1) % n], after = p[(i + 1) % n] - p[i];
    const double sine = cross(before, after), cosine = glm::dot(before, after);
    const double longer = std::max(glm::length(before), glm::length(after));
    const double error = 8.0 * flat.position_error * longer;
    if (std::abs(sine) <= error) {
      if (cosine < 0.0) return Outline::kTangled;  // it folds back
      convex = false;                              // a corner on a straight edge: a fan is not possible
    } else {
      convex = convex && sine > 0.0;
    }
    sum += std::atan2(sine, cosine);
  }
  constexpr double kRevolution = 2.0 * std::numbers::pi;
  if (std::abs(sum - kRevolution) > 0.25 * kRevolution) return Outline::kTangled;
  return convex ? Outline::kConvex : Outline::kConcave;
}

/// Whether two edges cross in the interior of both, by more than rounding.
bool crosses_itself(const FlatPolygon& flat) {
  const Points& p = flat.points;
  const std::size_t n = p.size();
  const double error = 8.0 * flat.position_error;
  const auto opposite = [&](double s, double t) {
    return (s > error && t < -error) || (s < -error && t > error);
  };
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2 a = p[i], b = p[(i + 1) % n];
    const glm::dvec2 low = glm::min(a, b), high = glm::max(a, b);
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours
      const glm::dvec2 c = p[j], d = p[(j + 1) % n];
      if (std::max(c.x, d.x) < low.x || std::min(c.x, d.x) > high.x || std::max(c.y, d.y) < low.y ||
          std::min(c.y, d.y) > high.y)
        continue;
      if (opposite(turn(a, b, c), turn(a, b, d)) && opposite(turn(c, d, a), turn(c, d, b))) return true;
    }
  }
  return false;
}

class EarClipper {
 public:
  EarClipper(const FlatPolygon& flat, std::vector<glm::uvec3>& triangles)
      : flat_(flat), p_(flat.points), triangles_(triangles), error_(8.0 * flat.position_error) {
    const auto n = std::uint32_t(p_.size());
    for (std::uint32_t i = 0; i < n; ++i) {
      next_.push_back(i + 1 < n ? i + 1 : 0);
      previous_.push_back(i > 0 ? i - 1 : n - 1);
    }
    no_ear_.fill(std::vector<bool>(n, false));
  }

  /// Returns false if no ear is left. Every simple polygon has two, so this one is not simple.
  bool clip() {
    std::size_t left = p_.size();
    std::uint32_t at = 0;
    for (; left > 3; --left) {
      if (!cut_one(at, left, kStrict) && !cut_one(at, left, kLoose) && !drop_straight(at, left)) return false;
    }
    if (turn_at(at) > error_) emit(at);
    return turn_at(at) >= -error_;
  }

 private:
  [[nodiscard]] double turn_at(std::uint32_t i) const { return turn(p_[previous_[i]], p_[i], p_[next_[i]]); }

  enum Test : std::size_t { kStrict, kLoose };

  /// Whether a corner is an ear: the outline turns left there, and no other corner lies in the triangle that
  /// it forms with its neighbours. With kStrict none may lie on the triangle's border either, except corners
  /// that coincide with one of its three.
  [[nodiscard]] bool is_ear(std::uint32_t tip, Test test) const {
    if (!(turn_at(tip) > error_)) return false;
    const glm::dvec2 a = p_[previous_[tip]], b = p_[tip], c = p_[next_[tip]];
    const glm::dvec2 low = glm::min(glm::min(a, b), c), high = glm::max(glm::max(a, b), c);
    const double margin = test == kStrict ? -error_ : error_;
    for (std::uint32_t i = next_[next_[tip]]; i != previous_[tip]; i = next_[i]) {
      const glm::dvec2 q = p_[i];
      if (q.x < low.x || q.x > high.x || q.y < low.y || q.y > high.y) continue;
      if (q == a || q == b || q == c) continue;
      if (turn(a, b, q) > margin && turn(b, c, q) > margin && turn(c, a, q) > margin) return false;
    }
    return true;
  }

  /// Finds the next ear from `at` on, cuts it, and moves `at` behind it. A corner that is not an ear is not
  /// tested again until one of its neighbours is cut; no other cut can make it an ear.
  bool cut_one(std::uint32_t& at, std::size_t left, Test test) {
    for (std::size_t tried = 0; tried < left; ++tried, at = next_[at]) {
      if (no_ear_[test][at]) continue;
      if (is_ear(at, test)) {
        emit(at);
        unlink(at);
        at = next_[at];
        return true;
      }
      no_ear_[test][at] = true;
    }
    return false;
  }

  void emit(std::uint32_t tip) {
    triangles_.emplace_back(flat_.corners[previous_[tip]], flat_.corners[tip], flat_.corners[next_[tip]]);
  }

  void unlink(std::uint32_t i) {
    const std::uint32_t before = previous_[i], after = next_[i];
    next_[before] = after;
    previous_[after] = before;
    for (auto& no_ear : no_ear_) no_ear[before] = no_ear[after] = false;
  }

  /// Removes a corner without a triangle when the rest is (nearly) a line back and forth.
  bool drop_straight(std::uint32_t& at, std::size_t left) {
    for (std::size_t tried = 0; tried < left; ++tried, at = next_[at]) {
      if (std::abs(turn_at(at)) > error_) continue;
      unlink(at);
      at = next_[at];
      return true;
    }
    return false;
  }

  const FlatPolygon& flat_;
  const Points& p_;
  std::vector<glm::uvec3>& triangles_;
  double error_;
  std::vector<std::uint32_t> next_, previous_;
  std::array<std::vector<bool>, 2> no_ear_;  ///< for each Test
};

}  // namespace

Expected<Triangulation> triangulate(std::span<const glm::dvec3> corners) {
  Triangulation result;
  std::vector<std::uint32_t> all(corners.size());
  std::iota(all.begin(), all.end(), 0u);
  result.triangles = fan(all);
  if (corners.size() == 3) return result;
  FlatPolygon flat;
  Outline outline = flatten(corners, flat, result.deviation);
  if (outline == Outline::kConcave) outline = classify_turns(flat);
  if (outline == Outline::kConvex) result.triangles = fan(flat.corners);
  result.tangled = outline == Outline::kTangled;
  if (outline != Outline::kConcave) return result;
  if (corners.size() > kMaxConcaveCorners) {
    return fail(fmt::format("a face of {} corners that is not convex; at most {} are cut into triangles",
                            corners.size(), kMaxConcaveCorners));
  }
  std::vector<glm::uvec3> ears;
  if (crosses_itself(flat) || !EarClipper(flat, ears).clip()) {
    result.tangled = true;
  } else {
    result.triangles = std::move(ears);
  }
  return result;
}

}  // namespace penumbra
