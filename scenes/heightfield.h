// Height fields as meshes.
#pragma once

#include "kernels/host/error.h"
#include "scenes/image/bitmap.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The largest number of texels of a height field; it gives 67 million triangles.
constexpr std::size_t kMostHeights = std::size_t{1} << 25;

/// The mesh of a height field over the square [-1, 1]^2. Each texel is a vertex whose height is `scale` times
/// the texel's luminance. The image's top row is at y = -1, and v grows with y. Each cell of four texels
/// becomes two triangles, split along the diagonal from the smallest to the largest x and y, as in Mitsuba
/// 0.6. `gamma` decodes integer texels (bitmap_values.h). With `smooth`, the normal at a vertex is the mean
/// of the normals of the bilinear patches around it, as in Mitsuba 0.6. Errors: fewer than 2 texels in a row
/// or column, more than kMostHeights.
Expected<Mesh> make_heightfield(const Bitmap& heights, float gamma, double scale, bool smooth);

}  // namespace penumbra
