// Bounds of the position, directions and intensity of one light or of several.
#pragma once

#include <glm/glm.hpp>

#include "kernels/scene_types.h"

namespace penumbra {

/// Light from points of a box. Emission axes lie within `spread` of `axis`; light leaves within `reach` of an
/// emission axis, and falls off with the cosine of the angle between (after Conty Estevez and Kulla 2018).
/// The defaults describe a light that is infinite and may shine from any direction, so a new kind of light
/// without bounds of its own is never missed.
struct LightBounds {
  glm::dvec3 low{0.0}, high{0.0};
  glm::dvec3 axis{0, 0, 1};             ///< unit
  double spread = 3.14159265358979324;  ///< the largest angle between `axis` and an emission axis
  double reach = 1.57079632679489662;   ///< the largest angle between an emission axis and emitted light
  double intensity = 0;    ///< W/sr along an emission axis, averaged over channels; the sum over all lights
  bool two_sided = false;  ///< every emission axis stands for both directions
  /// Infinite light: it has no position, and its axes are directions in which light travels; its intensity is
  /// determined elsewhere.
  bool infinite = true;
};

/// The bounds of one light. `power` is the weight with which it is chosen; 0: no light.
LightBounds bounds_of_light(const Light& light, double power);

/// Bounds of a light on its way from one state to the next, see LightState. `at_rest`: bounds of the light in
/// any place, for its reach and whether it is two-sided. The intensity is that of those.
LightBounds bounds_between(const Light& light, const LightBounds& at_rest, const LightState& from,
                           const LightState& to);

/// Bounds of the union. Both arguments must be infinite, or neither.
LightBounds joined(const LightBounds& a, const LightBounds& b);

}  // namespace penumbra
