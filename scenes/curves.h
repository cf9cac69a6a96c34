// Curves with a radius.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace penumbra {

struct ControlPoint {
  glm::dvec3 position;
  double radius;
};
using Curve = std::vector<ControlPoint>;

/// How curves are seen: as tubes along uniform cubic B-splines; as all spheres along straight segments, whose
/// radii change evenly; or as ribbons along B-splines that face each ray, flat ones, or with the normals of a
/// tube.
enum class CurveForm { kRound, kBalls, kFlat, kCylinder };

constexpr bool is_ribbon(CurveForm form) { return form == CurveForm::kFlat || form == CurveForm::kCylinder; }

/// Curves that do not emit and do not move. Their outside is the front.
struct Curves {
  CurveForm form = CurveForm::kRound;
  std::vector<Curve> curves;
  /// For each curve the parameter where it begins and ends, a texture coordinate. Empty: it runs from 0 to 1
  /// along all curves.
  std::vector<glm::vec2> ranges{};
};

}  // namespace penumbra
