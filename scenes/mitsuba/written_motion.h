// Motion as keys of Mitsuba's <animation>: matrices, of which it interpolates the polar parts.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "scenes/motion/scene_motion.h"

namespace penumbra::mitsuba {

/// The matrix with exactly the last row that readers want; inverses are rounded.
glm::dmat4 affine(glm::dmat4 m);

/// Where something is: the product of its steps, each its node's transform times that to the node.
struct Course {
  std::vector<NodePlace> steps;

  [[nodiscard]] glm::dmat4 at(const SceneMotion& motion, double time) const;
  /// The times of all keys of its nodes and of their parents, ascending.
  [[nodiscard]] std::vector<double> times(const SceneMotion& motion) const;
  /// Takes its last transforms, which do not move, off it and returns their product.
  glm::dmat4 take_end();
};

struct WrittenKeys {
  std::vector<TransformKey> keys;
  bool exact = true;  ///< whether interpolating them gives the transform at all times
};

/// Keys of a transform over time: at `times`, and where these are not enough, at times between them. They are
/// exact if the interpolation is that of the transform, up to kSameTransform of its size; else it is within
/// kNearTransform, but where it jumps or turns very fast. Errors: those of keyed_transform.
constexpr double kSameTransform = 1e-10, kNearTransform = 1e-4;
Expected<WrittenKeys> written_keys(const std::function<glm::dmat4(double)>& at,
                                   std::span<const double> times);

/// A mesh that deforms, in its own space, at a time.
struct MeshKey {
  double time = 0.0;  ///< in seconds
  Mesh mesh;
};

struct WrittenMeshes {
  std::vector<MeshKey> keys;
  bool exact = true;  ///< whether vertices go evenly from key to key
};

/// Keys of a mesh that deforms, from one time to a later one: at both, at its own keys between them, and as
/// for transforms. The size is the extent of the mesh. Its triangles are those at rest.
WrittenMeshes written_meshes(const SceneMotion& motion, const MovingShape& moving, double from, double to);

}  // namespace penumbra::mitsuba
