// What moves in a scene, counted.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scenes/motion/scene_motion.h"

namespace penumbra {

struct MotionFacts {
  std::vector<Clip> clips = {};
  int clip = -1;                                   ///< the one that is shown; -1: the format has none
  std::optional<double> fps;                       ///< that the file asks for
  double time = 0.0;                               ///< at which the scene is shown, in seconds
  std::optional<std::pair<double, double>> times;  ///< of the first and the last key
  bool camera = false;                             ///< whether its place moves
  std::vector<std::string> camera_numbers = {};    ///< its settings that change: "fov", …
  /// Of the scene's shapes, each of a group counted once, its instances, and emitters that are not shapes:
  /// those that move by themselves. An emitter whose strength alone changes is one.
  std::size_t shapes = 0, instances = 0, emitters = 0;
  std::size_t meshes_that_deform = 0;
};

/// Nothing if nothing moves and the file has no clips.
std::optional<MotionFacts> motion_facts(const SceneDescription& scene);

/// The first and last whole frame between two times, which differ by rounding from times of frames at most.
/// Nothing if no frame is between them.
std::optional<std::pair<double, double>> frames_between(std::pair<double, double> times, double fps);

}  // namespace penumbra
