// Light clusters: lights whose relative contributions are similar at all vertices of the pilot paths, for
// example the triangles of a mesh. A traversal of the hierarchy of lights ends at a cluster, whose lights are
// then chosen with fixed probabilities.
#pragma once

#include <span>
#include <vector>

#include "scenes/device/light_tree_builder.h"
#include "scenes/device/pilot_paths.h"

namespace penumbra {

/// Clusters of the finite lights, as leaves of a hierarchy whose intensities are in units of `unit` (see
/// build_light_tree). Choosing a cluster's lights in proportion to their intensities, at every shading point,
/// adds little to the second moment of the choice over `places`. That moment is the sum over lights of
/// (possible contribution)^2 / probability, relative to the square of the sum of all possible contributions.
std::vector<LightGroup> light_groups(std::span<const LightBounds> lights, double unit,
                                     std::span<const PilotVertex> places);

}  // namespace penumbra
