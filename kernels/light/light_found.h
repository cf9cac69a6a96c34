// Lights that rays hit, and their emission.
#ifndef PENUMBRA_LIGHT_FOUND_H
#define PENUMBRA_LIGHT_FOUND_H
#include "kernels/light/light_receiver.h"
#include "kernels/light/light_sample.h"

PENUMBRA_NAMESPACE_BEGIN

// The light that a ray hit. Point, normal and distance are arbitrary for an environment.
// clang-format off
#define FOUND_LIGHT_FIELDS(F, a)                                                                   \
  F(a, vec3, from)           /* origin of the ray */                                               \
  F(a, vec3, wi)             /* unit, direction of the ray */                                      \
  F(a, vec3, p)                                                                                    \
  F(a, vec3, normal)                                                                               \
  F(a, float, distance)                                                                            \
  F(a, float, u)             /* texture coordinates, 0 in scenes without FEATURE_UV */             \
  F(a, float, v)                                                                                   \
  F(a, float, cosine)        /* at the light */                                                    \
  F(a, float, projected_pdf) /* by projected solid angle, without pmf; negative: not sampled so */ \
  F(a, float, pmf)           /* probability of choosing the light */                               \
  F(a, int, light)           /* index, or negative: none */                                        \
  F(a, int, kind)            /* LIGHT_*, or negative */                                            \
  F(a, float, time)          /* see Surface; 0 in scenes without FEATURE_MOTION */
// clang-format on
LANE_RECORD(FoundLight, FoundLights, found_light, FOUND_LIGHT_FIELDS)

/// The light that a ray hits if it ends on this surface, or the environment if it leaves the scene. Negative:
/// no light, or the light's back.
FN int light_found(const PRIVATE Scene* scene, Surface s) {
  const int two_sided = scene->lights[s.light >= 0 ? s.light : 0].two_sided;
  const int index = (s.front | (two_sided != 0)) ? s.light : -1;
  return is_hit(s) ? index : scene->header.environment;
}

/// Whether any of the rays that ended on these surfaces may have hit a light.
FN bool any_finds_light(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces) {
  const int environment = scene->header.environment;
  int any = 0;
  for (int j = 0; j < LANES; j++)
    any |= (surfaces->primitive[j] != NOTHING_HIT ? surfaces->light[j] : environment) >= 0;
  return any != 0;
}

STAGE void store_found_lights(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT surfaces,
                              PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const int index = light_found(scene, s);
      GLOBAL const Light* light = scene->lights + (index >= 0 ? index : 0);
      const int kind = light->kind;
      FoundLight one;
      one.from = s.from;
      one.wi = negate(s.wo);
      one.p = s.p;
      one.normal = s.geometric;
      one.distance = s.distance;
      one.u = one.v = 0.0f;
      one.cosine = dot3(s.geometric, s.wo);
      one.projected_pdf = -1.0f;
      one.pmf = light->pmf;
      one.light = index;
      one.kind = index >= 0 ? kind : -1;
      one.time = 0.0f;
      store_found_light(found, j, one);
    }
}

STAGE void store_found_uvs(const PRIVATE Surfaces* RESTRICT surfaces, PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      found->u[j] = surfaces->u[j];
      found->v[j] = surfaces->v[j];
    }
}

STAGE void store_found_times(const PRIVATE Surfaces* RESTRICT surfaces, PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) found->time[j] = surfaces->time[j];
}

/// The lights that the rays that ended on these surfaces hit.
FN void find_lights(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces,
                    PRIVATE FoundLights* found) {
  store_found_lights(scene, surfaces, found);
  if (NEEDS(scene, UV)) store_found_uvs(surfaces, found);
  if (NEEDS_MOTION(scene)) store_found_times(surfaces, found);
}

// The radiance that a ray brings from the light that it hits, or from the environment. `pdf` is the density
// with which sample_lights samples the ray's direction from its origin. Both are 0 if there is no light.
#define EMISSION_FIELDS(F, a) \
  F(a, vec3, radiance)        \
  F(a, float, pdf)            \
  F(a, bool, of_polygon) /* see LightSample */
LANE_RECORD(Emission, Emissions, emission, EMISSION_FIELDS)

STAGE void no_emissions(const PRIVATE Scene* scene, const PRIVATE FoundLights* RESTRICT found,
                        PRIVATE Emissions* RESTRICT emissions) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      Emission none;
      none.radiance = make_vec3(0.0f, 0.0f, 0.0f);
      none.pdf = 0.0f;
      none.of_polygon = own_polygon(scene, found->light[j]) >= 0;
      store_emission(emissions, j, none);
    }
}

/// Stores these as lane j's emission if its light is of that kind.
FN void keep_emission(FoundLight found, int kind, vec3 radiance, float pdf, PRIVATE Emissions* emissions,
                      int j) {
  const Emission before = load_emission(emissions, j);
  Emission e;
  e.radiance = radiance;
  e.pdf = pdf * found.pmf;
  e.of_polygon = before.of_polygon;
  store_emission(emissions, j, select_emission(found.kind == kind, e, before));
}

PENUMBRA_NAMESPACE_END
#endif
