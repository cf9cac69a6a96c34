// Groups of shapes and their instances: where all of them are, and scenes without them.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The most instances that a scene may have, those within groups counted wherever their groups are.
constexpr std::size_t kMaxInstances = std::size_t{1} << 24;

/// The most levels of groups within groups.
constexpr int kMaxGroupLevels = 64;

/// Shapes of a group in the scene, instances of instances resolved.
struct PlacedGroup {
  int group = 0;
  std::size_t instance = 0;  ///< of the scene, the outermost
  glm::dmat4 to_world{1.0};
};

/// Every group that has shapes, in each of its places. Errors: too many, or too many levels; a transform that
/// flattens space, or whose numbers are too large or too small for single precision.
Expected<std::vector<PlacedGroup>> place_groups(const SceneDescription& scene);

/// The cylinder where the transform takes it; nothing where that is none.
std::optional<Cylinder> placed_cylinder(const Cylinder& cylinder, const glm::dmat4& to_world);

/// The shape in the place where the transform takes it. The front of a mesh follows its transformed normal,
/// also where the transform mirrors. Errors: a sphere or disk that would not be one, a position too far away.
Expected<Shape> placed_shape(const Shape& shape, const glm::dmat4& to_world);

/// The most triangles that emitting shapes of groups may be, each counted wherever it is: all are lights.
constexpr std::size_t kMaxPlacedEmitters = 1'000'000;

/// Whether light comes from it: a black emitter is as good as none.
inline bool emits(const Shape& shape) { return shape.radiance && *shape.radiance != glm::vec3(0.0f); }

/// Those emitting shapes of groups that are wanted, in each of the places; they have a radiance. Errors: as
/// of placed_shape, more than kMaxPlacedEmitters.
Expected<std::vector<Shape>> placed_emitters(const SceneDescription& scene,
                                             std::span<const PlacedGroup> placed,
                                             bool (*wanted)(const Shape&));

/// The same scene with all shapes where instances place them, and without groups. Errors: as of both.
Expected<SceneDescription> without_instances(const SceneDescription& scene);

/// Calls `with` for the shapes of the scene and, each once, those of its groups.
template <typename Scene>
void each_shape(Scene& scene, const auto& with) {
  for (auto& shape : scene.shapes) with(shape);
  for (auto& group : scene.groups)
    for (auto& shape : group.shapes) with(shape);
}

}  // namespace penumbra
