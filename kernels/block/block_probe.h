// Finds where the one path of a block first held a non-finite value: SOURCE_* and the step.
#ifndef PENUMBRA_BLOCK_PROBE_H
#define PENUMBRA_BLOCK_PROBE_H
#include "kernels/block/path_state.h"
#include "kernels/features.h"
#include "kernels/math/math.h"
#include "kernels/unit.h"

PENUMBRA_NAMESPACE_BEGIN

FN bool is_nan_bits(uint bits) { return (bits & 0x7fffffffu) > 0x7f800000u; }
FN bool is_infinite_bits(uint bits) { return (bits & 0x7fffffffu) == 0x7f800000u; }

/// Whether the three fields from `field` on are finite in lane 0.
FN bool finite_fields(const GLOBAL float* values, int capacity, int field) {
  bool finite = true;
  for (int k = field; k < field + 3; k++) {
    const uint bits = FLOAT_BITS(values[k * capacity]);
    finite = finite & !(is_nan_bits(bits) | is_infinite_bits(bits));
  }
  return finite;
}

/// Keeps the first source whose values are not finite.
FN void probe_source(GLOBAL int* probe, bool finite, int source, int step) {
  if (finite | (probe[0] != SOURCE_UNKNOWN)) return;
  probe[0] = source;
  probe[1] = step;
}

FN void probe_camera(const PRIVATE Block* block) {
  const bool finite = finite_fields(block->f, block->capacity, RAY_ORIGIN_X) &
                      finite_fields(block->f, block->capacity, RAY_DIRECTION_X);
  probe_source(block->probe, finite, SOURCE_CAMERA, 0);
}

/// After an integrator's step: the emission that it added, and the shadow ray and next ray that it requests.
FN void probe_step(const PRIVATE Block* block, bool control, int step) {
  const GLOBAL float* f = block->f;
  const int capacity = block->capacity;
  const bool lit = f[SHADOW_TMAX * capacity] > 0.0f, alive = block->i[ALIVE * capacity] != 0;
  probe_source(block->probe, finite_fields(f, capacity, RADIANCE_X), SOURCE_EMISSION, step);
  if (lit) probe_source(block->probe, finite_fields(f, capacity, SHADOW_RADIANCE_X), SOURCE_LIGHT, step);
  if (alive)
    probe_source(block->probe,
                 finite_fields(f, capacity, THROUGHPUT_X) & finite_fields(f, capacity, RAY_DIRECTION_X),
                 SOURCE_DIRECTION, step);
#if HAS(POLYGONS)
  if (control) probe_source(block->probe, finite_fields(f, capacity, ANALYTIC_X), SOURCE_CLOSED_FORM, step);
#endif
}

/// After the shadow ray's light is added.
FN void probe_light(const PRIVATE Block* block, int step) {
  probe_source(block->probe, finite_fields(block->f, block->capacity, RADIANCE_X), SOURCE_LIGHT, step);
}

FN void probe_sample(const PRIVATE Block* block, int source) {
  probe_source(block->probe, finite_fields(block->slots, block->slot_capacity, SAMPLE_X), source, 0);
}

PENUMBRA_NAMESPACE_END
#endif
