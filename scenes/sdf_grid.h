// Surfaces given by signed distances on a grid, as Mitsuba 3's sdfgrid.
#pragma once

#include <array>
#include <vector>

#include "scenes/diagnostic.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// Signed distances at grid points, x fastest. The points fill the unit cube, including its faces.
struct SdfGrid {
  std::array<int, 3> size{};  ///< number of points along x, y, z, at least two each
  std::vector<float> values;  ///< negative inside
};

/// Reads a volume file of one channel; its box is ignored. Errors: those of read_volume_file, more than one
/// channel, fewer than two points along an axis, too many points.
Expected<SdfGrid> read_sdf_grid(const SourceFile& file);

/// The zero level set of the trilinear interpolation, as triangles whose corners lie on it. The mesh has four
/// divisions per cell along each axis; two or one in grids of more than 64 or 256 points along an axis.
/// Normals are gradients, by differences over one cell. Texture coordinates are 0 everywhere, as in Mitsuba
/// 3, so a texture shows one value.
Mesh sdf_mesh(const SdfGrid& grid);

}  // namespace penumbra
