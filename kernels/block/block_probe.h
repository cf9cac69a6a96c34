// Finds where the only path of a block first had a non-finite value: the source (SOURCE_*) and the step.
#ifndef PENUMBRA_BLOCK_PROBE_H
#define PENUMBRA_BLOCK_PROBE_H
#include "kernels/block/path_state.h"
#include "kernels/features.h"
#include "kernels/math/math.h"
#include "kernels/unit.h"

PENUMBRA_NAMESPACE_BEGIN

FN bool is_nan_bits(uint bits) { return (bits & 0x7fffffffu) > 0x7f800000u; }
FN bool is_infinite_bits(uint bits) { return (bits & 0x7fffffffu) == 0x7f800000u; }

/// Stores the first source with non-finite values.
FN void probe_source(GLOBAL int* probe, bool finite, int source, int step) {
  if (finite | (probe[0] != SOURCE_UNKNOWN)) return;
  probe[0] = source;
  probe[1] = step;
}

FN void probe_camera(const PRIVATE Block* block) {
  const PRIVATE PathState* paths = &block->paths;
  const bool finite = is_finite3(get_ray_origin(paths, 0)) & is_finite3(get_ray_direction(paths, 0));
  probe_source(block->probe, finite, SOURCE_CAMERA, 0);
}

/// After an integrator's step: checks the emission that it added, and the shadow ray and next ray that it
/// requests.
FN void probe_step(const PRIVATE Block* block, bool control, int step) {
  const PRIVATE PathState* paths = &block->paths;
  probe_source(block->probe, is_finite3(get_radiance(paths, 0)), SOURCE_EMISSION, step);
  if (get_shadow_tmax(paths, 0) > 0.0f)
    probe_source(block->probe, is_finite3(get_shadow_radiance(paths, 0)), SOURCE_LIGHT, step);
  if (get_alive(paths, 0))
    probe_source(block->probe, is_finite3(get_throughput(paths, 0)) & is_finite3(get_ray_direction(paths, 0)),
                 SOURCE_DIRECTION, step);
  if (HAS(POLYGONS) && control)
    probe_source(block->probe, is_finite3(get_analytic(paths, 0)), SOURCE_CLOSED_FORM, step);
}

/// After the light of the shadow ray was added.
FN void probe_light(const PRIVATE Block* block, int step) {
  probe_source(block->probe, is_finite3(get_radiance(&block->paths, 0)), SOURCE_LIGHT, step);
}

FN void probe_sample(const PRIVATE Block* block, int source) {
  probe_source(block->probe, is_finite3(get_slot_sample(&block->slots, 0)), source, 0);
}

PENUMBRA_NAMESPACE_END
#endif
