// Integrator, film and camera of random scenes.
#pragma once

#include <glm/glm.hpp>
#include <string>

#include "tests/differential/random.h"

namespace penumbra::differential {

/// An integrator, and what a scene for it may hold.
struct IntegratorPlan {
  std::string ours, mitsubas;
  bool point_lights = true;
  bool sky = true;
  bool quadric_lights = true;       ///< spheres and disks
  bool open = false;                ///< nothing that could throw a shadow
  double area_light_radius = 0.25;  ///< at least
  double albedo = 0.8;              ///< at most
  double samples = 1;               ///< how many times the usual number
  bool hides = false;               ///< hide_emitters
};

/// `kind` counts through the integrators.
IntegratorPlan plan_integrator(int kind, Random& random);

struct CameraLimits {
  double unit = 1;  ///< of length
  /// The far clipping plane may be near. Mitsuba sees what is behind hidden lights beyond it too.
  bool far_clip = true;
  /// The filter may reach over pixels. Where lights are seen, its tails are rare and bright: Penumbra draws
  /// samples from the filter, so that few of them are a light beside a dark block, too few for a standard
  /// error.
  bool wide_filter = true;
};

/// A camera that looks at the unit cube from a distance of some units; without what is around it.
std::string random_camera(const CameraLimits& limits, Random& random);

}  // namespace penumbra::differential
