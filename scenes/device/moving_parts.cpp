#include "scenes/device/moving_parts.h"

#include <algorithm>
#include <glm/glm.hpp>

#include "scenes/device/device_scene_builder.h"
#include "scenes/motion/exposure.h"
#include "scenes/motion/scene_motion.h"
#include "scenes/scene_bounds.h"

namespace penumbra {
namespace {

bool has_true(const std::vector<bool>& all) { return std::ranges::find(all, true) != all.end(); }

/// Of everything that is still; empty if all moves.
SceneBounds still_bounds(const SceneDescription& scene, const MovingParts& moving,
                         std::span<const PlacedGroup> placed) {
  SceneBounds bounds;
  for (std::size_t i = 0; i < scene.shapes.size(); ++i)
    if (!moving.shapes[i]) bounds.include(bounds_of(std::span(&scene.shapes[i], 1)));
  std::vector<SceneBounds> groups;
  for (const ShapeGroup& group : scene.groups) groups.push_back(bounds_of(group.shapes));
  for (const PlacedGroup& place : placed)
    if (!moving.instances[place.instance])
      bounds.include(bounds_of(groups[std::size_t(place.group)], place.to_world));
  return bounds;
}

}  // namespace

bool MovingParts::any() const { return has_true(shapes) || has_true(groups) || has_true(instances); }

MovingParts moving_parts(const SceneDescription& scene) {
  MovingParts moving{moving_shapes(scene), std::vector<bool>(scene.groups.size(), false),
                     moving_instances(scene)};
  if (scene.motion != nullptr)
    for (const MovingShape& shape : scene.motion->shapes)
      if (shape.group >= 0) moving.groups.at(std::size_t(shape.group)) = true;
  return moving;
}

glm::dvec3 origin_of(const SceneDescription& scene, const MovingParts& moving,
                     std::span<const PlacedGroup> placed) {
  if (moving.any())
    if (const SceneBounds still = still_bounds(scene, moving, placed); !still.empty()) return still.center();
  return bounds_of(scene, placed).center();
}

double radius_about(const glm::dvec3& origin, const SceneDescription& scene, const MovingParts& moving,
                    std::span<const PlacedGroup> placed) {
  const SceneBounds all = bounds_of(scene, placed);
  if (!moving.any()) return 0.5 * glm::length(all.high - all.low);
  return glm::length(glm::max(all.high - origin, origin - all.low));
}

glm::dvec3 scene_center(const SceneDescription& scene) {
  const MovingParts moving = moving_parts(scene);
  const auto center_of = [&](const SceneDescription& shown) {
    const auto placed = place_groups(shown);
    return origin_of(shown, moving, placed ? *placed : std::vector<PlacedGroup>());
  };
  // What is still determines it; only where all moves does it depend on the time.
  const double middle = exposure_of(scene).middle();
  if (!moving.any() || middle == scene.time) return center_of(scene);
  const auto placed = place_groups(scene);
  if (placed && !still_bounds(scene, moving, *placed).empty()) return center_of(scene);
  SceneDescription shown = scene;
  return set_time(shown, middle) ? center_of(shown) : center_of(scene);
}

}  // namespace penumbra
