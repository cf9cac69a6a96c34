// Reconstruction filters by importance sampling: a sample's film position is drawn from the filter about its pixel's
// centre and touches that pixel only, so tiles have no borders (Ernst, Stamminger and Greiner 2006).
#ifndef PENUMBRA_FILTER_H
#define PENUMBRA_FILTER_H
#include "kernels/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  float x;       ///< offset from the pixel's centre, in filter radii
  float weight;  ///< what the sample counts for; negative in negative lobes
} FilterSample;

/// One axis. A tabulated filter f is FILTER_CELLS cells of equal mass of |f|, sampled uniformly inside; the weight is
/// the cell's mass of f over the mean one, so that f integrates to 1. The table holds FILTER_CELLS + 1 knots, then
/// FILTER_CELLS weights; it is there whatever the filter.
FN FilterSample sample_filter(int filter, GLOBAL const float* table, float u) {
  const float v = 2.0f * u - 1.0f;
  const float tent = sign_of(v) * (1.0f - SQRT(1.0f - FABS(v)));
  const bool tabulated = filter == FILTER_TABULATED;
  const float position = u * (float)FILTER_CELLS;
  const int cell = tabulated ? min_i((int)position, FILTER_CELLS - 1) : 0;
  const float low = table[cell], high = table[cell + 1], weight = table[FILTER_CELLS + 1 + cell];
  const float inside = low + (position - (float)cell) * (high - low);
  FilterSample s;
  s.x = tabulated ? inside : (filter == FILTER_BOX ? v : tent);
  s.weight = tabulated ? weight : 1.0f;
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
