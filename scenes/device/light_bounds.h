// Bounds of the light of one light, or of several: where it comes from, whereto, how much.
#pragma once

#include <glm/glm.hpp>

#include "kernels/scene_types.h"

namespace penumbra {

/// From points of a box, about axes within `spread` of `axis`, within `reach` of those, falling with the
/// cosine of the angle between: after Conty Estevez and Kulla 2018. A new kind of light that leaves
/// everything as it is here is infinite and shines from anywhere, so no place is without it.
struct LightBounds {
  glm::dvec3 low{0.0}, high{0.0};
  glm::dvec3 axis{0, 0, 1};             ///< unit
  double spread = 3.14159265358979324;  ///< largest angle from it to an axis
  double reach = 1.57079632679489662;   ///< largest angle from there to a way that light takes
  double intensity = 0;                 ///< W/sr along an axis, channels averaged; of all lights together
  bool two_sided = false;               ///< both directions of every axis
  bool infinite =
      true;  ///< without a place; axes are where light travels; the intensity is another's to find
};

/// Of a light that chooses by `power`, 0 for none.
LightBounds bounds_of_light(const Light& light, double power);

/// Of what either bounds. Both are infinite, or neither.
LightBounds joined(const LightBounds& a, const LightBounds& b);

}  // namespace penumbra
