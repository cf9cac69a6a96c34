// What a random scene says of its integrator, film and camera.
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
  bool quadric_lights = true;  ///< spheres and disks
  bool open = false;           ///< nothing that could throw a shadow
  double lamp_radius = 0.25;   ///< at least
  double albedo = 0.8;         ///< at most
  double samples = 1;          ///< how many times the usual number
  bool hides = false;          ///< hide_emitters
};

/// `kind` counts through the integrators.
IntegratorPlan plan_integrator(int kind, Random& random);

/// A camera that looks at the unit cube from a distance of some units of this length; without what is around
/// it.
std::string random_camera(double unit, bool clipped, Random& random);

}  // namespace penumbra::differential
