// What moves in a scene, counted.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scenes/motion/exposure.h"
#include "scenes/motion/scene_motion.h"

namespace penumbra {

struct MotionFacts {
  std::vector<Clip> clips = {};
  double time = 0.0;                               ///< at which the scene is shown, in seconds
  std::optional<std::pair<double, double>> times;  ///< of the first and the last key
  bool camera = false;                             ///< whether its place moves
  std::vector<std::string> camera_numbers = {};    ///< its settings that change: "fov", …
  struct Share {
    std::size_t moving = 0, all = 0;
  };
  /// Shapes, those of a group counted once, instances, and emitters that are not shapes. One moves by itself;
  /// an emitter also if its strength alone changes.
  Share shapes = {}, instances = {}, emitters = {};
  std::size_t meshes_that_deform = 0;
  Exposure exposure = {};
  std::string position = {}, curve = {};  ///< of the shutter, as its settings print
};

/// Nothing if the scene has no motion.
std::optional<MotionFacts> motion_facts(const SceneDescription& scene);

/// The first and last whole frame between two times, which differ by rounding from times of frames at most.
/// Nothing if no frame is between them, or if their numbers are above 1e15.
std::optional<std::pair<std::int64_t, std::int64_t>> frames_between(std::pair<double, double> times,
                                                                    double fps);

}  // namespace penumbra
