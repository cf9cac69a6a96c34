// Shadow rays towards samples of lights.
#ifndef PENUMBRA_SHADOW_RAY_H
#define PENUMBRA_SHADOW_RAY_H
#include "kernels/block/path_state.h"
#include "kernels/light/light_sample.h"

PENUMBRA_NAMESPACE_BEGIN

/// Asks for the shadow ray of lane i's light sample, from the surface and primitive that it starts on;
/// `arriving` is what it adds if nothing is in the way.
FN void ask_for_shadow_ray(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                           int capacity, int i, Surface s, LightSample light, vec3 arriving, bool lit,
                           int primitive) {
  const bool beneath = is_beneath(s, light.wi) & (scene->header.trace_shadows != 0);
  const bool controlled = (scene->header.estimator != ESTIMATOR_SAMPLES) & light.of_polygon;
  STORE3(f, capacity, SHADOW_ORIGIN_X, i, light.origin);
  STORE3(f, capacity, SHADOW_DIRECTION_X, i, light.toward);
  STORE3(f, capacity, SHADOW_RADIANCE_X, i, arriving);
  f[SHADOW_TMAX * capacity + i] = (lit & (controlled | !beneath)) ? light.tmax : -1.0f;
  ints[SHADOW_SKIP * capacity + i] = primitive;
#if HAS(POLYGONS)
  ints[SHADOW_CONTROLLED * capacity + i] =
      controlled ? (beneath ? CONTROLLED_BENEATH : CONTROLLED_SEEN) : CONTROLLED_NOT;
#endif
}

PENUMBRA_NAMESPACE_END
#endif
