// The density of pbrt's procedural cloud (Pharr, Jakob and Humphreys, Physically Based Rendering, 4th
// edition, section 11.4.6), on a grid.
#pragma once

#include "scenes/grid_volume.h"

namespace penumbra::pbrt {

struct Cloud {
  double density = 1.0, wispiness = 1.0, frequency = 5.0;
  /// In [0, 1]; y is up: there is least of it at 1. Its noise is of the same kind as pbrt's, with other
  /// numbers.
  [[nodiscard]] double at(const glm::dvec3& place) const;
};

/// Over the box from `low` to `high`, 128 cells along its longest side.
VolumeGrid cloud_grid(const Cloud& cloud, const glm::dvec3& low, const glm::dvec3& high);

}  // namespace penumbra::pbrt
