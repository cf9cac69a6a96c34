// Reads curves from Mitsuba 3's text files. Each control point is a line "x y z radius"; an empty line
// separates two curves.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scenes/diagnostic.h"

namespace penumbra {

struct ControlPoint {
  glm::dvec3 position;
  double radius;
};
using Curve = std::vector<ControlPoint>;

/// Reads curves of at least `least` points each. All numbers are finite, and no radius is negative. Errors,
/// with the line: anything else in the file; a file without curves.
Expected<std::vector<Curve>> read_curves(const SourceFile& file, std::size_t least);

}  // namespace penumbra
