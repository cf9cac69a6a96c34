// The result of the light sampling stage, which precedes an integrator's step. The stage takes many times the
// arithmetic of the step, so it is separate: scenes that do not need it do not pay for it.
#ifndef PENUMBRA_LIGHT_SAMPLING_H
#define PENUMBRA_LIGHT_SAMPLING_H
#include "kernels/light/light_receiver.h"

PENUMBRA_NAMESPACE_BEGIN

/// Index of the polygon light that the light of that index, or -1, is a part of, or -1.
FN int own_polygon(const PRIVATE Scene* scene, int light) {
  const int polygon = scene->lights[light >= 0 ? light : 0].polygon;
  return light >= 0 ? polygon : -1;
}

/// Index of the light that a ray hits if it ends on this surface, or of the environment if it leaves the
/// scene; negative: none, or the light's back.
FN int light_found(const PRIVATE Scene* scene, Surface s) {
  const int two_sided = scene->lights[s.light >= 0 ? s.light : 0].two_sided;
  const int index = (s.front | (two_sided != 0)) ? s.light : -1;
  return is_hit(s) ? index : scene->header.environment;
}

/// Whether the receiver is a part of that light and gets nothing from it: a part of a flat light, or of a
/// sphere except its emitting inside. Formulas cannot tell: rounding puts the surface to either side of the
/// light's plane or sphere, which covers half the directions or nothing.
FN bool is_own_light(const PRIVATE Scene* scene, LightReceiver r, int light) {
  bool own = light == r.light;
  if (NEEDS_LIGHT(scene, SPHERE)) {
    const int kind = scene->lights[light].kind;
    const float orientation = scene->lights[light].p2.y;
    own = own & !((kind == LIGHT_SPHERE) & (orientation < 0.0f) & r.front);
  }
#if HAS(POLYGONS)
  const int mine = own_polygon(scene, r.light), polygon = scene->lights[light].polygon;
  own = own | ((mine >= 0) & (polygon == mine));
#endif
  return own;
}

// A light sample as far as the stage decides it. Densities by projected solid angle do not include the
// probability of choosing the light.
#define LIGHT_SAMPLING_FIELDS(F, a)                                                                      \
  F(a, int, light)   /* index of the light that the step samples; negative: the step chooses by power */ \
  F(a, float, pmf)   /* probability of choosing it */                                                    \
  F(a, vec3, wi)     /* direction towards it */                                                          \
  F(a, float, scale) /* the density of wi is its cosine times this; negative: the step samples a point */
LANE_RECORD(LightSampling, LightSamplings, light_sampling, LIGHT_SAMPLING_FIELDS)

FN LightSampling no_light_sampling(void) {
  LightSampling sampling;
  sampling.scale = -1.0f;
  sampling.light = -1;
  sampling.pmf = 0.0f;
  sampling.wi = make_vec3(0.0f, 0.0f, 1.0f);
  return sampling;
}

STAGE void clear_light_samplings(PRIVATE LightSamplings* RESTRICT samplings) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) store_light_sampling(samplings, j, no_light_sampling());
}

PENUMBRA_NAMESPACE_END
#endif
