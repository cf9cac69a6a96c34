// Surfaces of signed distances at the points of a grid, as Mitsuba 3's sdfgrid has them.
#pragma once

#include <array>
#include <vector>

#include "scenes/diagnostic.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// Numbers at points that fill the unit cube, ends and all, x fastest.
struct SdfGrid {
  std::array<int, 3> size{};  ///< points along x, y, z, at least two each
  std::vector<float> values;  ///< below 0 inside
};

/// A volume file of one channel, whose box has no effect. Errors: of read_volume_file, other channels, fewer
/// than two points along an axis, or too many.
Expected<SdfGrid> read_sdf_grid(const SourceFile& file);

/// Where the numbers, trilinear between points, are 0: triangles whose corners are on it, four a cell along
/// each edge, or two or one in grids of more than 64 or 256 points along one. Normals are those of the
/// gradient, over a cell.
Mesh sdf_mesh(const SdfGrid& grid);

}  // namespace penumbra
