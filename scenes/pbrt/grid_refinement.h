// Grids of pbrt's media on finer cells.
#pragma once

#include <vector>

#include "scenes/grid_volume.h"

namespace penumbra::pbrt {

/// How many times finer cells an rgbgrid gets along each axis. pbrt interpolates scattering and absorption,
/// we their sum and the share of one, which is the same on fine cells.
int refinement_of(const VolumeGrid& size);

/// The values of cells `finer` times as small as those of a grid of that size: at their centres, interpolated
/// as pbrt does, towards cells of value 0 around the grid.
std::vector<float> refined(const std::vector<float>& values, const VolumeGrid& size, int channels, int finer);

}  // namespace penumbra::pbrt
