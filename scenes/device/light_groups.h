// Clusters of lights that look alike from all vertices of the pilot paths, say the triangles of a mesh. A
// walk through the hierarchy of lights ends at a cluster and takes its lights by fixed probabilities.
#pragma once

#include <span>
#include <vector>

#include "scenes/device/light_tree_builder.h"
#include "scenes/device/pilot_paths.h"

namespace penumbra {

/// Of the lights that are not infinite, as leaves of a hierarchy in units of `unit` (build_light_tree).
/// Taking those of a group in proportion to their intensities, whatever the place, adds little to the second
/// moment of the choice over these places: of the sum over lights of (what the light may contribute)^2 /
/// probability, relative to the square of what all may contribute.
std::vector<LightGroup> light_groups(std::span<const LightBounds> lights, double unit,
                                     std::span<const PilotVertex> places);

}  // namespace penumbra
