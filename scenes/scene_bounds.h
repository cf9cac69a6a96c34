// The bounding box of a scene's shapes in world coordinates.
#pragma once

#include <glm/glm.hpp>
#include <limits>
#include <span>

#include "scenes/instances.h"
#include "scenes/scene_description.h"

namespace penumbra {

struct SceneBounds {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
  void include(const glm::dvec3& p, double reach = 0) {
    low = glm::min(low, p - reach);
    high = glm::max(high, p + reach);
  }
  void include(const SceneBounds& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
  [[nodiscard]] bool empty() const { return low.x > high.x; }
  [[nodiscard]] glm::dvec3 center() const { return 0.5 * (low + high); }
};

/// Empty if there are no shapes.
SceneBounds bounds_of(std::span<const Shape> shapes);

/// The bounding box of the transformed box; empty if that is empty.
SceneBounds bounds_of(const SceneBounds& box, const glm::dmat4& to_world);

/// The bounding box of the scene. An instance is bounded by the transformed box of its group. A scene without
/// shapes has the camera's position as its box.
SceneBounds bounds_of(const SceneDescription& scene, std::span<const PlacedGroup> placed);

}  // namespace penumbra
