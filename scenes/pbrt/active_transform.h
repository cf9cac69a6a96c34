// pbrt's current transformation is two matrices: one at the start and one at the end of TransformTimes.
#pragma once

#include <glm/mat4x4.hpp>
#include <optional>

#include "scenes/motion/scene_motion.h"
#include "scenes/reader_report.h"

namespace penumbra::pbrt {

struct TransformPair {
  glm::dmat4 start{1.0}, end{1.0};

  [[nodiscard]] bool moves() const { return start != end; }
  bool operator==(const TransformPair&) const = default;
};

/// The matrices that directives change (ActiveTransform).
struct ActiveTransforms {
  bool start = true, end = true;

  /// Sets those to a function of what they were.
  void change(TransformPair& pair, const auto& of) const {
    if (start) pair.start = of(pair.start);
    if (end) pair.end = of(pair.end);
  }
};

/// Where something is while the scene is built, and what it follows.
struct Placement {
  glm::dmat4 shown{1.0};
  int node = -1;  ///< of the motion; -1: it does not move

  /// The place of what was built with the transform `shown`.
  [[nodiscard]] NodePlace place() const { return {node, glm::inverse(shown)}; }
};

/// Collects what moves. As in pbrt, both matrices are decomposed into a translation, a rotation and a stretch
/// (AnimatedTransform in src/pbrt/util/transform.cpp).
class MotionReader {
 public:
  /// TransformTimes: when the first matrix holds, and when the second does. `end` is after `start`.
  void set_times(double start, double end) { start_ = start, end_ = end; }
  /// The shutter opens at this time, at which the scene is built, and is open for `seconds`.
  void set_shutter(double time, double seconds) { motion.default_time = time, motion.shutter = seconds; }

  /// Nothing, and an error, if it is singular at a time.
  std::optional<Placement> place(const TransformPair& pair, SourceLocation location, ReaderReport& report);

  /// Gives the finished scene its motion, if anything moves.
  void install(SceneDescription& scene);

  SceneMotion motion;  ///< the caller adds what moves

 private:
  double start_ = 0.0, end_ = 1.0;
  TransformPair last_;  ///< that of the last node
};

}  // namespace penumbra::pbrt
