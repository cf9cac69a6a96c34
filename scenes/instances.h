// Groups of shapes and their instances: lists every placement, and expands a scene so that it has none.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The largest number of instances in a scene. An instance inside a group counts once for every placement of
/// that group.
constexpr std::size_t kMaxInstances = std::size_t{1} << 24;

/// The largest nesting depth of groups.
constexpr int kMaxGroupLevels = 64;

/// One placement of a group's shapes in the scene, with nested instances resolved.
struct PlacedGroup {
  int group = 0;
  std::size_t instance = 0;  ///< index of the outermost instance in the scene
  glm::dmat4 to_world{1.0};
};

/// All placements of all groups that have shapes. Errors: too many placements; groups nested too deeply; a
/// singular transform, or one whose numbers are too large or too small for single precision.
Expected<std::vector<PlacedGroup>> place_groups(const SceneDescription& scene);

/// The transformed cylinder, or nothing if the result is not a cylinder.
std::optional<Cylinder> placed_cylinder(const Cylinder& cylinder, const glm::dmat4& to_world);

/// The transformed shape. The front of a mesh follows its transformed normal, also under a transform that
/// mirrors. Errors: a sphere or disk that would no longer be one, a position too far away.
Expected<Shape> placed_shape(const Shape& shape, const glm::dmat4& to_world);

/// The largest number of triangles of emitting shapes in groups, each counted once per placement. Every one
/// of them is a light.
constexpr std::size_t kMaxPlacedEmitters = 1'000'000;

/// Whether the shape emits light. A black emitter does not.
inline bool emits(const Shape& shape) { return shape.radiance && *shape.radiance != glm::vec3(0.0f); }

/// Transformed copies, one per placement, of the emitting shapes of groups that `wanted` accepts. Every copy
/// has a radiance. Errors: those of placed_shape; more than kMaxPlacedEmitters.
Expected<std::vector<Shape>> placed_emitters(const SceneDescription& scene,
                                             std::span<const PlacedGroup> placed,
                                             bool (*wanted)(const Shape&));

/// The same scene without groups: every shape is copied to each of its placements. Errors: those of
/// place_groups and placed_shape.
Expected<SceneDescription> without_instances(const SceneDescription& scene);

/// Calls `with` for every shape of the scene, and once for every shape of each group.
template <typename Scene>
void each_shape(Scene& scene, const auto& with) {
  for (auto& shape : scene.shapes) with(shape);
  for (auto& group : scene.groups)
    for (auto& shape : group.shapes) with(shape);
}

}  // namespace penumbra
