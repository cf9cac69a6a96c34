// Filter importance sampling: a sample's film position is sampled from the reconstruction filter about its
// pixel's centre, and contributes to that pixel only. So tiles have no borders (Ernst, Stamminger and Greiner
// 2006).
#ifndef PENUMBRA_FILTER_H
#define PENUMBRA_FILTER_H
#include "kernels/math/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  float x;       ///< offset from the pixel's centre, in filter radii
  float weight;  ///< weight of the sample; negative in negative lobes
} FilterSample;

/// One axis of a box or tent filter.
FN FilterSample sample_plain_filter(int filter, float u) {
  const float v = 2.0f * u - 1.0f;
  const float tent = 1.0f - SQRT(1.0f - FABS(v));
  FilterSample s;
  s.x = sign_of(v) * (filter == FILTER_BOX ? FABS(v) : tent);
  s.weight = 1.0f;
  return s;
}

/// One axis of a symmetric filter. A tabulated filter f has FILTER_CELLS cells of distances from the centre.
/// Knot i is the distance within which the integral of |f| is 1 - (1 - i / FILTER_CELLS)^2 of the total,
/// which keeps the cells narrow in the tails. Between knots, distances are interpolated. The weight is the
/// cell's integral of f over that of |f|, scaled so that f integrates to 1. The table has FILTER_CELLS + 1
/// knots, then FILTER_CELLS weights; it exists for every filter.
FN FilterSample sample_filter(int filter, GLOBAL const float* table, float u) {
  const float v = 2.0f * u - 1.0f;
  const float tent = 1.0f - SQRT(1.0f - FABS(v));
  const bool tabulated = filter == FILTER_TABULATED;
  const float position = tent * (float)FILTER_CELLS;
  const int cell = tabulated ? min_i((int)position, FILTER_CELLS - 1) : 0;
  const float low = table[cell], high = table[cell + 1], weight = table[FILTER_CELLS + 1 + cell];
  const float inside = low + (position - (float)cell) * (high - low);
  FilterSample s;
  s.x = sign_of(v) * (tabulated ? inside : (filter == FILTER_BOX ? FABS(v) : tent));
  s.weight = tabulated ? weight : 1.0f;
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
