// The grid of an environment map's texels: where on the sphere they are, and what they weigh when directions
// are chosen.
//
// Texel (x, y) of W x H is at longitude 2 pi (x + 1/2) / W about the y axis and at the angle pi y / (H - 1)
// from it, so the first and the last row are the poles; between texels radiance is bilinear, and the columns
// close (Mitsuba 3's envmap).
#ifndef PENUMBRA_ENVMAP_GRID_H
#define PENUMBRA_ENVMAP_GRID_H
#include "kernels/light/sum_search.h"
#include "kernels/math/vec3.h"

PENUMBRA_NAMESPACE_BEGIN

/// Of a row, the sine of its angle from the axis; of the poles that a quarter of a row away, since light from
/// the cells about them has to be found.
FN float envmap_row_sine(int y, int height) {
  const bool pole = (y == 0) | (y == height - 1);
  float sine, cosine;
  sincos_2pi(0.5f * (pole ? 0.25f : (float)y) / (float)(height - 1), &sine, &cosine);
  return FABS(sine);
}

/// Where the shares of the rows begin in the table of the rows: behind the whole and a sum for each row.
FN int envmap_shares(int height) { return search_padded(1 + height); }

/// Directions are chosen with a density, over the grid, that is bilinear between these.
FN float envmap_weight(vec3 texel, float row_sine) { return ((texel.x + texel.y) + texel.z) * row_sine; }

PENUMBRA_NAMESPACE_END
#endif
