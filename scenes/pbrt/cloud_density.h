// The density of pbrt's procedural cloud (Pharr, Jakob and Humphreys, Physically Based Rendering, 4th
// edition, section 11.4.6), on a grid.
#pragma once

#include "scenes/grid_volume.h"

namespace penumbra::pbrt {

struct Cloud {
  double density = 1.0, wispiness = 1.0, frequency = 5.0;
  /// The density at `place`, in [0, 1]. y is up, and the density decreases towards y = 1. The noise is of the
  /// same kind as pbrt's, but with other random numbers.
  [[nodiscard]] double at(const glm::dvec3& place) const;
};

/// The cloud over the box from `low` to `high`, as a grid with 128 cells along its longest side.
VolumeGrid cloud_grid(const Cloud& cloud, const glm::dvec3& low, const glm::dvec3& high);

}  // namespace penumbra::pbrt
