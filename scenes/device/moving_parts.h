// What moves in a scene, and where its origin is so that the rest stays the same.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "scenes/instances.h"
#include "scenes/scene_description.h"

namespace penumbra {

struct MovingParts {
  std::vector<bool> shapes;     ///< of the scene's own
  std::vector<bool> groups;     ///< groups with a shape that moves or deforms
  std::vector<bool> instances;  ///< see moving_instances

  [[nodiscard]] bool any() const;
};

MovingParts moving_parts(const SceneDescription& scene);

/// The origin of the device scene, see scene_center.
glm::dvec3 origin_of(const SceneDescription& scene, const MovingParts& moving,
                     std::span<const PlacedGroup> placed);

/// The radius of a sphere about that origin that holds all shapes.
double radius_about(const glm::dvec3& origin, const SceneDescription& scene, const MovingParts& moving,
                    std::span<const PlacedGroup> placed);

}  // namespace penumbra
