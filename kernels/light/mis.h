// Multiple importance sampling weights (Veach and Guibas 1995).
#ifndef PENUMBRA_MIS_H
#define PENUMBRA_MIS_H
#include "kernels/math/math.h"
#include "kernels/scene_types.h"

PENUMBRA_NAMESPACE_BEGIN

/// MIS weight of a sample with expected density `mine` (number of samples times pdf), where another strategy
/// has `other`: the balance heuristic, or the power heuristic with beta = 2. It is 0 if `mine` is 0.
/// Quotients are taken first, since squares of large densities may overflow.
FN float mis_weight(int heuristic, float mine, float other) {
  const float ratio = other / (mine > 0.0f ? mine : 1.0f);
  const float term = heuristic == HEURISTIC_POWER ? ratio * ratio : ratio;
  return mine > 0.0f ? 1.0f / (1.0f + term) : 0.0f;
}

PENUMBRA_NAMESPACE_END
#endif
