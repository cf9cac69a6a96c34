// What moves while the shutter is open, and how finely its path is divided.
#pragma once

#include <glm/mat4x4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/motion/exposure.h"
#include "scenes/motion/scene_motion.h"
#include "scenes/scene_bounds.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// Paths are sampled at so many steps; of them each moving thing uses 1, 2, 4 … or all.
constexpr int kFinestSteps = MOST_MOTION_STEPS;

/// Whether the shape moves as a rigid body that does not emit: it may be placed by one matrix a time.
bool moves_rigidly(const SceneDescription& scene, const MovingShape& moving);

/// A thing that moves. `steps` is 0 for one that stands still while the shutter is open.
struct ExposedPath {
  int steps = 0;
  /// Of what is placed by a matrix, and moves: at each of its states.
  std::vector<glm::dmat4> to_world = {};
  /// Of a shape: the time at which the scene of at_middle shows it.
  double shown_at = 0.0;
  /// Of a shape that is not rigid: where it is over the whole time, in the space of its group.
  SceneBounds swept = {};
};

/// Lists are in the order of SceneMotion's.
struct ExposedMotion {
  Exposure exposure;
  bool has_layer = false;  ///< the layer of motion is wanted
  std::vector<double>
      times;  ///< kFinestSteps + 1 from `open` to `close`; with the layer `before` and `after`
  std::vector<ExposedPath> shapes, instances, emitters;
  ExposedPath camera;
  /// What deviates from its true path by more than kMostDeviation, and by how many pixels.
  std::vector<std::string> warnings;

  /// Whether anything moves.
  [[nodiscard]] bool any() const;
  /// The number of the state at times[k] of something with so many steps, or -1 if it has none there.
  [[nodiscard]] static int state_at(std::size_t k, int steps);
};

/// Where a place is in the world.
glm::dmat4 matrix_at(const SceneMotion& motion, const NodePlace& place, double time);

/// In pixels, as the camera sees it.
constexpr double kMostDeviation = 0.1;

/// A part of a scene that moves, which can be taken to any time at little cost. Things without a size are
/// points.
class PosedParts {
 public:
  /// The scene's camera, emitters and instances, and of its shapes those of the `wanted` entries of
  /// SceneMotion::shapes. Others are empty.
  PosedParts(const SceneDescription& scene, const std::vector<bool>& wanted);

  /// Errors: those of set_time.
  Expected<void> set_time(double time) { return penumbra::set_time(parts_, time, Vanished::kIsAPoint); }
  [[nodiscard]] const SceneDescription& parts() const { return parts_; }
  [[nodiscard]] const Shape& shape(const MovingShape& moving) const {
    return moving.group < 0 ? parts_.shapes[moving.shape]
                            : parts_.groups[std::size_t(moving.group)].shapes[moving.shape];
  }

 private:
  SceneDescription parts_;
};

/// What moves in the scene during its exposure, or from frame to frame if the layer of motion is wanted. Of
/// 1, 2, 4 … kFinestSteps, each gets the least number of steps between which its path may be linear: at twice
/// as many irregular times, no point of it is farther than kMostDeviation from where it should be. Errors:
/// those of set_time.
Expected<ExposedMotion> exposed_motion(const SceneDescription& scene);

/// The scene at the middle of the exposure. What moves and has no size then is shown as at another time at
/// which it has, so that it has records. Sets `shown_at`. Errors: those of set_time.
Expected<SceneDescription> at_middle(const SceneDescription& scene, ExposedMotion& motion);

}  // namespace penumbra
