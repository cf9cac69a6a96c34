#include "scenes/punctual_lights.h"

#include <cmath>

namespace penumbra {

namespace {

/// A frame at `position` whose z axis is the unit direction.
glm::dmat4 frame_along(const glm::dvec3& position, const glm::dvec3& direction) {
  const glm::dvec3 other = std::abs(direction.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 y = glm::normalize(glm::cross(direction, other)), x = glm::cross(y, direction);
  return {glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(direction, 0), glm::dvec4(position, 1)};
}

}  // namespace

void add_punctual_light(const PunctualLight& light, SceneDescription& scene) {
  if (light.kind == PunctualKind::kPoint) {
    PointLight point;
    point.position = light.position;
    point.intensity = light.strength;
    scene.emitters.emplace_back(point);
  } else if (light.kind == PunctualKind::kSpot) {
    SpotLight spot;
    spot.intensity = light.strength;
    spot.cutoff_angle = light.outer_angle;
    spot.beam_width = light.inner_angle;
    spot.falloff = light.falloff;
    spot.to_world = frame_along(light.position, light.direction);
    scene.emitters.emplace_back(spot);
  } else {
    DirectionalLight directional;
    directional.irradiance = light.strength;
    directional.direction = light.direction;
    scene.emitters.emplace_back(directional);
  }
}

}  // namespace penumbra
