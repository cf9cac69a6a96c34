#include "scenes/pbrt/bspline_curves.h"

#include <algorithm>
#include <array>

namespace penumbra::pbrt {
namespace {

using Points = std::span<const glm::dvec3>;
using Cubic = std::array<glm::dvec3, 4>;

Cubic cubic_of_square(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return {a, (a + 2.0 * b) / 3.0, (2.0 * b + c) / 3.0, c};
}

/// The Bezier control points of a segment.
Cubic piece_of(Points points, std::size_t piece, const CurveKind& kind) {
  if (kind.degree == 3) {
    const Points p = points.subspan(3 * piece);
    return {p[0], p[1], p[2], p[3]};
  }
  const Points p = points.subspan(kind.bezier ? 2 * piece : piece);
  return kind.bezier ? cubic_of_square(p[0], p[1], p[2])
                     : cubic_of_square(0.5 * (p[0] + p[1]), p[1], 0.5 * (p[1] + p[2]));
}

/// The B-spline control points of the same polynomial.
Cubic controls_of(const Cubic& b) {
  return {6.0 * b[0] - 7.0 * b[1] + 2.0 * b[2], 2.0 * b[1] - b[2], 2.0 * b[2] - b[1],
          6.0 * b[3] - 7.0 * b[2] + 2.0 * b[1]};
}

}  // namespace

std::vector<Curve> bspline_curves(Points points, const CurveKind& kind) {
  const auto degree = std::size_t(kind.degree);
  const std::size_t pieces = kind.bezier ? (points.size() - 1) / degree : points.size() - degree;
  // A radius that varies linearly has control values on the line, also beyond the ends; they are clamped at
  // 0.
  const auto radius = [&](double pieces_on) {
    return std::max(0.0,
                    kind.first_radius + (kind.last_radius - kind.first_radius) * pieces_on / double(pieces));
  };
  std::vector<Curve> curves;
  if (!kind.bezier && degree == 3) {
    Curve& curve = curves.emplace_back();
    for (std::size_t i = 0; i < points.size(); ++i) curve.push_back({points[i], radius(double(i) - 1.0)});
    return curves;
  }
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const Cubic controls = controls_of(piece_of(points, piece, kind));
    Curve& curve = curves.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) curve.push_back({controls[i], radius(double(piece + i) - 1.0)});
  }
  return curves;
}

}  // namespace penumbra::pbrt
