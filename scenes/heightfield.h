// Height fields as meshes.
#pragma once

#include "kernels/host/error.h"
#include "scenes/image/bitmap.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The most texels of a height field: 67 million triangles.
constexpr std::size_t kMostHeights = std::size_t{1} << 25;

/// The square [-1, 1]^2 with a vertex at each texel, the image's top row at y = -1, as high as `scale` times
/// the texel's luminance; v grows with y. Of each four texels two triangles share the way from the least to
/// the largest x and y, as in Mitsuba 0.6's mesh of it. Whole numbers count by `gamma` (bitmap_values.h).
/// `smooth`: normals are means over the cells about each vertex, of what their bilinear patches have there,
/// as in Mitsuba 0.6. Errors: less than 2 texels in a row or column, more than kMostHeights.
Expected<Mesh> make_heightfield(const Bitmap& heights, float gamma, double scale, bool smooth);

}  // namespace penumbra
