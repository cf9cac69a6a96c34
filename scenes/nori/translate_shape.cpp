#include "scenes/nori/translate.h"

namespace penumbra::nori {

using mitsuba::Object;

/// The shape of TU Wien's course. Its front is where u × v points.
void translate_parallelogram(const Translation& t, Object& shape) {
  const auto corner = take(shape, "origin"), u = take(shape, "u"), v = take(shape, "v");
  take(shape, "name");
  const auto at = corner ? vector_of(*corner) : std::nullopt, along = u ? vector_of(*u) : std::nullopt,
             across = v ? vector_of(*v) : std::nullopt;
  if (!at || !along || !across)
    return t.report.error(shape.location, "a parallelogram needs a <point> origin and the <vector>s u and v");
  const glm::dvec3 normal = glm::cross(*along, *across);
  if (!(glm::length(normal) > 0.0))
    return t.report.error(shape.location, "u and v of a parallelogram must not be parallel");
  // Of the square from (-1, -1) to (1, 1).
  glm::dmat4 to_world(1.0);
  to_world[0] = glm::dvec4(0.5 * *along, 0.0);
  to_world[1] = glm::dvec4(0.5 * *across, 0.0);
  to_world[2] = glm::dvec4(glm::normalize(normal), 0.0);
  to_world[3] = glm::dvec4(*at + 0.5 * (*along + *across), 1.0);
  shape.type = "rectangle";
  set(shape, "to_world", to_world);
}

}  // namespace penumbra::nori
