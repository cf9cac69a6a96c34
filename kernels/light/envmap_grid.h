// The grid of an environment map's texels: their directions, and their weights for direction sampling.
//
// Texel (x, y) of W x H is at longitude 2 pi (x + 1/2) / W about the y axis and at the angle pi y / (H - 1)
// to it, so the first and the last row are the poles. Radiance is bilinear between texels, and the columns
// wrap around (Mitsuba 3's envmap).
#ifndef PENUMBRA_ENVMAP_GRID_H
#define PENUMBRA_ENVMAP_GRID_H
#include "kernels/light/sum_search.h"
#include "kernels/math/math.h"
#include "kernels/math/vec3.h"

PENUMBRA_NAMESPACE_BEGIN

/// The sine of a row's angle to the axis. For the poles it is that of a quarter of a row, so that the cells
/// around them are sampled.
FN float envmap_row_sine(int y, int height) {
  const bool pole = (y == 0) | (y == height - 1);
  float sine, cosine;
  sincos_2pi(0.5f * (pole ? 0.25f : (float)y) / (float)(height - 1), &sine, &cosine);
  return FABS(sine);
}

/// Offset of the rows' cumulative shares in the table of rows: after the total and a sum for each row.
FN int envmap_shares(int height) { return search_padded(1 + height); }

// The least weight of a texel as a fraction of its radiance, so that all light can be sampled.
#define ENVMAP_LEAST_SHARE 0.1f

/// Weight of a texel. The pdf over the grid is proportional to the bilinear interpolation of these weights.
/// BSDF samples find the dim parts of a map well enough. So light samples are for what exceeds `covered`, the
/// mean over the sphere (Karlik et al. 2019, "MIS compensation"). It is 0 where light samples are alone.
FN float envmap_weight(vec3 texel, float row_sine, float covered) {
  const float sum = (texel.x + texel.y) + texel.z;
  return max_f(sum - covered, ENVMAP_LEAST_SHARE * sum) * row_sine;
}

PENUMBRA_NAMESPACE_END
#endif
