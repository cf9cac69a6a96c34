// Closing the gaps that finished paths leave in a block.
#ifndef PENUMBRA_BLOCK_COMPACT_H
#define PENUMBRA_BLOCK_COMPACT_H
#include "kernels/block/path_state.h"

PENUMBRA_NAMESPACE_BEGIN

/// Moves a field's values up to lanes [0, left). In place, since going[m] >= m.
FN void close_gaps(GLOBAL float* RESTRICT field, const GLOBAL int* RESTRICT going, int left) {
  LANE_LOOP
    for (int m = 0; m < left; m++) field[m] = field[going[m]];
}

/// Finished paths leave their radiance in their slot, with `control` also what control variates need; the
/// others move up, in order. Returns how many are left.
STAGE int compact(GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints, int capacity, int count,
                  bool all_floats, bool control, GLOBAL float* RESTRICT slots, int slot_capacity) {
  GLOBAL int* RESTRICT going = ints + GOING * capacity;
  GLOBAL int* RESTRICT finished = ints + FINISHED * capacity;
  int left = 0, gone = 0;
  for (int i = 0; i < count; i++) {  // without a branch: which paths end is not predictable
    const int alive = ints[ALIVE * capacity + i];
    going[left] = i;
    finished[gone] = i;
    left += alive;
    gone += 1 - alive;
  }
  for (int m = 0; m < gone; m++) {
    const int i = finished[m];
    const int slot = ints[SLOT * capacity + i];
    const vec3 radiance = LOAD3(f, capacity, RADIANCE_X, i);
    STORE3(slots, slot_capacity, SAMPLE_X, slot, radiance);
#if HAS(POLYGONS)
    for (int k = SHADOWED_X; control && k < STATE_FLOATS; k++)
      slots[(SLOT_SHADOWED_X + k - SHADOWED_X) * slot_capacity + slot] = f[k * capacity + i];
#endif
  }
  // A field at a time.
  const int floats = all_floats ? PATH_AND_CAMERA_RAY_COUNT : PATH_FLOAT_COUNT;
  for (int k = 0; gone > 0 && k < floats; k++) close_gaps(f + k * capacity, going, left);
#if HAS(POLYGONS)
  for (int k = SHADOWED_X; gone > 0 && control && k < STATE_FLOATS; k++)
    close_gaps(f + k * capacity, going, left);
#endif
  for (int k = 0; gone > 0 && k < PATH_INT_COUNT; k++) {
    GLOBAL int* field = ints + k * capacity;
    LANE_LOOP
      for (int m = 0; m < left; m++) field[m] = field[going[m]];
  }
  return left;
}

/// Lanes from `count` to the next multiple of LANES repeat the last path, so that every lane holds valid
/// work.
FN void pad_lanes(GLOBAL float* f, GLOBAL int* ints, int capacity, int count, bool all_floats, bool control) {
  const int floats = all_floats ? PATH_AND_CAMERA_RAY_COUNT : PATH_FLOAT_COUNT;
  for (int i = count; i % LANES != 0; i++) {
    for (int k = 0; k < floats; k++) f[k * capacity + i] = f[k * capacity + count - 1];
#if HAS(POLYGONS)
    for (int k = SHADOWED_X; control && k < STATE_FLOATS; k++)
      f[k * capacity + i] = f[k * capacity + count - 1];
#endif
    for (int k = 0; k < PATH_INT_COUNT; k++) ints[k * capacity + i] = ints[k * capacity + count - 1];
  }
}

PENUMBRA_NAMESPACE_END
#endif
