// Suns: disks at infinity, of the same radiance all over. `area` is 1 - cos of half the angle across, p1 the
// direction in which light from the middle travels. Directions are sampled uniformly. Rays that leave the
// scene find suns, beside the environment: a ray may find several lights, so each sun has a turn of its own.
#ifndef PENUMBRA_SUN_LIGHT_H
#define PENUMBRA_SUN_LIGHT_H
#include "kernels/light/kind_functions.h"
#include "kernels/math/frame.h"

PENUMBRA_NAMESPACE_BEGIN

LIGHT_EMITS_UNIFORMLY(sun)

FN float sun_solid_angle(Light light) { return 2.0f * PI_F * light.area; }

/// A direction towards the sun (unit).
FN vec3 toward_sun(Light light, float u, float v) {
  const float versine = u * light.area, across = safe_sqrt(versine * (2.0f - versine));
  float sine, cosine;
  sincos_2pi(v, &sine, &cosine);
  return from_frame(negate(light.p1), across * cosine, across * sine, 1.0f - versine);
}

FN LightSample sample_sun_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                LightReceiver r, float u, float v, LightSampling sampling, ulong strategies) {
  LightSample s = toward_infinity(r, toward_sun(light, u, v));
  s.pdf = 1.0f / sun_solid_angle(light);
  s.radiance = light.radiance;
  return s;
}

FN float sun_light_pdf(const PRIVATE Scene* scene, Light light, FoundLight found, ulong strategies) {
  return 1.0f / sun_solid_angle(light);
}

/// Keeps light `k`, which is a sun, in the lanes whose ray leaves the scene towards it. Their angle is
/// compared by the chord, since the cosine of small angles has few digits.
STAGE void keep_sun(const PRIVATE Scene* scene, int k, const PRIVATE Surfaces* RESTRICT surfaces,
                    const PRIVATE LightPlaces* RESTRICT places, PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Light light = placed_light(load_light(scene->lights + k), load_light_place(places, j));
      const vec3 chord = add(LOAD_LANE_vec3(found->wi, j), light.p1);
      const bool within = (surfaces->primitive[j] == NOTHING_HIT) & (dot3(chord, chord) <= 2.0f * light.area);
      found->light[j] = within ? k : -1;
      found->kind[j] = within ? LIGHT_SUN : -1;
      found->pmf[j] = light.pmf;
    }
}

/// Whether any of the rays that ended on these surfaces found light `k`, a sun; `found` is that light in
/// their lanes, and none in others.
FN bool finds_sun(const PRIVATE Scene* scene, int k, const PRIVATE Surfaces* surfaces,
                  PRIVATE FoundLights* found) {
  int lights[LANES], any = 0;
  LightPlaces places;
  for (int j = 0; j < LANES; j++) lights[j] = k;
  find_lights(scene, surfaces, found);
  place_lights(scene, lights, found->time, &places);
  keep_sun(scene, k, surfaces, &places, found);
  for (int j = 0; j < LANES; j++) any |= found->light[j] >= 0 ? 1 : 0;
  return any != 0;
}

/// Whether light `k` is a sun.
FN bool is_sun(const PRIVATE Scene* scene, int k) { return scene->lights[k].kind == LIGHT_SUN; }

/// One after the last light that may be a sun.
FN int end_of_suns(const PRIVATE Scene* scene) {
  return NEEDS_LIGHT(scene, SUN) ? scene->header.first_sun + scene->header.sun_count : 0;
}

PENUMBRA_NAMESPACE_END
#endif
