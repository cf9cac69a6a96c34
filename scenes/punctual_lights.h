// Lights without a size, as the formats of other programs have them: the one place where they become ours.
#pragma once

#include <glm/glm.hpp>

#include "scenes/reader_report.h"
#include "scenes/scene_description.h"

namespace penumbra {

enum class PunctualKind { kPoint, kSpot, kDirectional };
/// Between the two angles of a spot: linear in the angle's cosine, squared (glTF), or 3t² - 2t³ of it (pbrt).
enum class PunctualFalloff { kSquaredCosine, kSmoothstep };

struct PunctualLight {
  PunctualKind kind = PunctualKind::kPoint;
  glm::dvec3 position{0.0};
  glm::dvec3 direction{0.0, 0.0, 1.0};          ///< in which it shines, unit
  glm::vec3 strength{1.0f};                     ///< W/sr; of a directional light W/m² across it
  double inner_angle = 0.0, outer_angle = 0.0;  ///< of a spot, from its axis, degrees
  PunctualFalloff falloff = PunctualFalloff::kSquaredCosine;
};

/// Adds it to the scene; what the scene has no light for is reported.
void add_punctual_light(const PunctualLight& light, SourceLocation location, ReaderReport& report,
                        SceneDescription& scene);

}  // namespace penumbra
