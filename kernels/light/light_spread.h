// Flat lights that shine into a cone about their normal, as through a grid of slats, which hide a share of
// the light that grows with the tangent of the angle a to the normal. For a cone of half-angle h the radiance
// has the factor (tan h - tan a) / (tan h - h), or 0; the power is that without a cone. (The integral of cos
// a sin a (tan h - tan a) over a is (tan h - h) / 2.) `spread` is tan h, and `gain` is 1 / (tan h - h).
#ifndef PENUMBRA_LIGHT_SPREAD_H
#define PENUMBRA_LIGHT_SPREAD_H
#include "kernels/light/flat_light.h"
#include "kernels/light/light_found.h"

PENUMBRA_NAMESPACE_BEGIN

/// The factor in direction w (unit) from a light, of either side, with that unit normal; 1 for other lights.
/// The sine comes from the part of w across the normal, since the cosine of small angles has few digits.
FN float spread_share(Light light, vec3 normal, vec3 w) {
  const float cosine = dot3(w, normal);
  const vec3 across = add_scaled(w, -cosine, normal);
  const float tangent = SQRT(dot3(across, across)) / max_f(FABS(cosine), 1e-30f);
  const float share = max_f((light.spread - tangent) * light.gain, 0.0f);
  return light.spread > 0.0f ? share : 1.0f;
}

STAGE void spread_light_samples(const PRIVATE Scene* scene, const PRIVATE LightPlaces* RESTRICT places,
                                PRIVATE LightSamples* RESTRICT samples) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Light light =
          placed_light(load_light(scene->lights + samples->light[j]), load_light_place(places, j));
      const vec3 normal = select3(light.kind == LIGHT_DISK, light.p1, flat_light(light).normal);
      const float share = spread_share(light, normal, LOAD_LANE_vec3(samples->wi, j));
      STORE_LANE_vec3(samples->radiance, j, scale(LOAD_LANE_vec3(samples->radiance, j), share));
      samples->tmax[j] = share > 0.0f ? samples->tmax[j] : -1.0f;
    }
}

STAGE void spread_emissions(const PRIVATE Scene* scene, const PRIVATE FoundLights* RESTRICT found,
                            PRIVATE Emissions* RESTRICT emissions) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Light light = load_light(scene->lights + (found->light[j] >= 0 ? found->light[j] : 0));
      const float share = spread_share(light, LOAD_LANE_vec3(found->normal, j), LOAD_LANE_vec3(found->wi, j));
      STORE_LANE_vec3(emissions->radiance, j, scale(LOAD_LANE_vec3(emissions->radiance, j), share));
    }
}

PENUMBRA_NAMESPACE_END
#endif
