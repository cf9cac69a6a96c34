// Lights without a size, as the formats of other programs have them: the one place where they become ours.
#pragma once

#include <glm/glm.hpp>

#include "scenes/scene_description.h"

namespace penumbra {

enum class PunctualKind { kPoint, kSpot, kDirectional };

struct PunctualLight {
  PunctualKind kind = PunctualKind::kPoint;
  glm::dvec3 position{0.0};
  glm::dvec3 direction{0.0, 0.0, 1.0};          ///< in which it shines, unit
  glm::vec3 strength{1.0f};                     ///< W/sr; of a directional light W/m² across it
  double inner_angle = 0.0, outer_angle = 0.0;  ///< of a spot, from its axis, degrees
  SpotFalloff falloff = SpotFalloff::kSquared;
};

void add_punctual_light(const PunctualLight& light, SceneDescription& scene);

}  // namespace penumbra
