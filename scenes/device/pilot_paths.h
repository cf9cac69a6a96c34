// What infinite lights bring to a scene beside the others, found once while the scene is built.
#pragma once

#include <span>
#include <vector>

#include "scenes/device/scene_records.h"

namespace penumbra {

/// A place that the camera sees, or that light reaches from one.
struct PilotVertex {
  vec3 p;
  vec3 facing;  ///< unit shading normal; 0 where light from all directions counts
  double weight;
};

/// Always the same for the same scene, which has the hierarchy of the portable intersector; its lights do not
/// matter.
std::vector<PilotVertex> pilot_vertices(const SceneHeader& header, const SceneRecords& records);

struct InfiniteLights {
  std::vector<double>
      intensities;     ///< of each in the hierarchy of lights, by which it is chosen beside others
  double share = 0.5;  ///< probability of all together where all places choose alike
};

/// What the infinite lights get, by index: such that the variance of light samples, balanced with samples of
/// diffuse directions, is least, relative to the light there, over places that the camera sees and others
/// that light reaches from there. Always the same for the same scene.
///
/// The scene has the hierarchy of the portable intersector, and a hierarchy of all lights but these. Rays
/// find what is in the way; glass and mirrors are, as for shadow rays. Materials count as what their records
/// say.
InfiniteLights weigh_infinite_lights(const SceneHeader& header, const SceneRecords& records,
                                     std::span<const int> infinite);

}  // namespace penumbra
