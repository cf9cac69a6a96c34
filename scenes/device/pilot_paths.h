// Pilot paths: a few paths traced while the scene is built. They measure how much infinite lights contribute
// compared with the other lights.
#pragma once

#include <span>
#include <vector>

#include "scenes/device/scene_records.h"

namespace penumbra {

/// A point on a pilot path: visible to the camera, or lit by light scattered from such a point.
struct PilotVertex {
  vec3 p;
  vec3 facing;  ///< unit shading normal; 0 if light from all directions matters
  double weight;
};

/// The vertices of the pilot paths. They are deterministic and do not depend on the scene's lights. The scene
/// must have the portable intersector's hierarchy.
std::vector<PilotVertex> pilot_vertices(const SceneHeader& header, const SceneRecords& records);

struct InfiniteLights {
  /// The intensity of each infinite light in the hierarchy of lights, where it is chosen among all lights.
  std::vector<double> intensities;
  /// Probability of all infinite lights together, if lights are chosen with the same probabilities
  /// everywhere.
  double share = 0.5;
};

/// The intensities of the infinite lights, given by their indices. They minimise the variance of light
/// samples, combined by MIS with samples of diffuse directions, relative to the received light, over the
/// vertices of the pilot paths. The result is deterministic.
///
/// The scene must have the portable intersector's hierarchy, and a hierarchy of all other lights. Shadow rays
/// determine visibility; glass and mirrors block them. Materials are judged by the constant values in their
/// records.
InfiniteLights weigh_infinite_lights(const SceneHeader& header, const SceneRecords& records,
                                     std::span<const int> infinite);

}  // namespace penumbra
