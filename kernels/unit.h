// The part of an image that one work unit renders, and the memory that a block of it needs.
#ifndef PENUMBRA_UNIT_H
#define PENUMBRA_UNIT_H
#include "kernels/path_state.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  int x, y;  ///< film pixel of the corner
  int width, height;
  uint first_sample;
  int sample_count;
} Unit;

// Where a unit's layers start among the planes of its result: see SampleBufferPlane, which checks that they
// agree.
#define FIRST_LAYER_PLANE 6
#define ANALYTIC_PLANE 13
#define DIFFERENCE_PLANE 16
#define VISIBILITY_PLANE 19

PENUMBRA_NAMESPACE_END
#endif
