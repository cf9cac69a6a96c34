// Point, spot and directional lights as other formats define them, and their conversion to this renderer's
// emitters.
#pragma once

#include <glm/glm.hpp>

#include "scenes/scene_description.h"

namespace penumbra {

enum class PunctualKind { kPoint, kSpot, kDirectional };

struct PunctualLight {
  PunctualKind kind = PunctualKind::kPoint;
  glm::dvec3 position{0.0};
  glm::dvec3 direction{0.0, 0.0, 1.0};  ///< unit; the direction in which the light shines
  /// W/sr; for a directional light the irradiance in W/m² on a surface perpendicular to it
  glm::vec3 strength{1.0f};
  double inner_angle = 0.0, outer_angle = 0.0;  ///< of a spot light: half-angles from its axis, degrees
  SpotFalloff falloff = SpotFalloff::kSquared;
};

void add_punctual_light(const PunctualLight& light, SceneDescription& scene);

}  // namespace penumbra
