// Curves of Mitsuba 3's text files: a line for each control point, "x y z radius", and an empty one between
// curves.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scenes/diagnostic.h"

namespace penumbra {

struct CurvePoint {
  glm::dvec3 position;
  double radius;
};
using Curve = std::vector<CurvePoint>;

/// Curves of at least `least` points each, which are finite and have no radius below 0. Errors, at their
/// line: anything else; a file without curves.
Expected<std::vector<Curve>> read_curves(const SourceFile& file, std::size_t least);

}  // namespace penumbra
