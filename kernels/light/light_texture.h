// Textured lights: points sampled by their grids (light_grid.h), and textured radiance at hits and samples.
// These stages run only in scenes with FEATURE_LIGHT_TEXTURES, before and after those of the kinds.
#ifndef PENUMBRA_LIGHT_TEXTURE_H
#define PENUMBRA_LIGHT_TEXTURE_H
#include "kernels/light/light_grid.h"
#include "kernels/texture/texture.h"

PENUMBRA_NAMESPACE_BEGIN

/// In lanes whose light has a grid: maps the numbers that sample a point to those of the grid, and multiplies
/// the probability of the light by the grid's density.
STAGE void choose_by_light_grids(const PRIVATE Scene* scene, const PRIVATE int* RESTRICT lights,
                                 PRIVATE float* RESTRICT u, PRIVATE float* RESTRICT v,
                                 PRIVATE float* RESTRICT pmf) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      GLOBAL const Light* light = scene->lights + lights[j];
      const GridPoint p = sample_light_grid(scene, light, u[j], v[j]);
      const bool has_grid = light->grid >= 0;
      u[j] = has_grid ? p.u : u[j];
      v[j] = has_grid ? p.v : v[j];
      pmf[j] = has_grid ? pmf[j] * p.density : pmf[j];
    }
}

/// Sets lane j of `places` and `textures`: where the texture of that light (an index, or negative) is
/// evaluated. Mesh colours are those of the light's triangle.
FN void set_light_place(const PRIVATE Scene* scene, int light, vec3 p, float u, float v,
                        PRIVATE Surfaces* places, PRIVATE int* textures, int j) {
  const int index = light >= 0 ? light : 0;
  const int texture = scene->lights[index].texture;
  const int parts = index < scene->header.tables.light_triangles.count ? index : 0;
  STORE_LANE_vec3(places->p, j, p);
  places->u[j] = u;
  places->v[j] = v;
  places->primitive[j] = scene->light_triangles[parts].first;
  places->instance[j] = -1;
  textures[j] = light >= 0 ? texture : -1;
}

STAGE void place_light_samples(const PRIVATE Scene* scene, const PRIVATE LightSamples* RESTRICT samples,
                               PRIVATE Surfaces* RESTRICT places, PRIVATE int* RESTRICT textures) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const LightSample s = load_light_sample(samples, j);
      set_light_place(scene, s.tmax > 0.0f ? s.light : -1, s.place, s.place_u, s.place_v, places, textures,
                      j);
    }
}

STAGE void place_found_lights(const PRIVATE Scene* scene, const PRIVATE FoundLights* RESTRICT found,
                              PRIVATE Surfaces* RESTRICT places, PRIVATE int* RESTRICT textures) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const FoundLight one = load_found_light(found, j);
      set_light_place(scene, one.light, one.p, one.u, one.v, places, textures, j);
    }
}

/// Clamps negative emission to 0.
FN vec3 emitted_share(const PRIVATE TextureLanes* values, int j) {
  const vec3 value = LOAD_LANE_vec3(values->value, j);
  return make_vec3(max_f(value.x, 0.0f), max_f(value.y, 0.0f), max_f(value.z, 0.0f));
}

STAGE void colour_light_samples(const PRIVATE TextureLanes* RESTRICT values,
                                PRIVATE LightSamples* RESTRICT samples) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 radiance = mul(LOAD_LANE_vec3(samples->radiance, j), emitted_share(values, j));
      STORE_LANE_vec3(samples->radiance, j, radiance);
    }
}

STAGE void colour_emissions(const PRIVATE Scene* scene, const PRIVATE FoundLights* RESTRICT found,
                            const PRIVATE LightPlaces* RESTRICT places,
                            const PRIVATE TextureLanes* RESTRICT values,
                            PRIVATE Emissions* RESTRICT emissions) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int index = found->light[j] >= 0 ? found->light[j] : 0;
      GLOBAL const Light* light = scene->lights + index;
      const TexturePoint at = numbers_of_light_point(
          placed_light(load_light(light), load_light_place(places, j)), LOAD_LANE_vec3(found->p, j));
      const bool has_grid = (found->light[j] >= 0) & (light->grid >= 0);
      const float density = light_grid_density(scene, light, at.u, at.v);
      emissions->pdf[j] = has_grid ? emissions->pdf[j] * density : emissions->pdf[j];
      const vec3 radiance = mul(LOAD_LANE_vec3(emissions->radiance, j), emitted_share(values, j));
      STORE_LANE_vec3(emissions->radiance, j, radiance);
    }
}

/// Multiplies the samples' radiance by the textures of their lights, at those times.
FN void texture_light_samples(const PRIVATE Scene* scene, const PRIVATE float* times,
                              PRIVATE LightSamples* samples) {
  Surfaces places;
  TextureLanes values;
  int textures[LANES];
  place_light_samples(scene, samples, &places, textures);
  if (NEEDS_MOTION(scene))
    for (int j = 0; j < LANES; j++) places.time[j] = times[j];
  eval_textures(scene, &places, textures, &values);
  colour_light_samples(&values, samples);
}

/// The same for emission that rays hit; also multiplies its pdfs by the grids' densities.
FN void texture_emissions(const PRIVATE Scene* scene, const PRIVATE FoundLights* found,
                          const PRIVATE LightPlaces* light_places, PRIVATE Emissions* emissions) {
  Surfaces places;
  TextureLanes values;
  int textures[LANES];
  place_found_lights(scene, found, &places, textures);
  if (NEEDS_MOTION(scene))
    for (int j = 0; j < LANES; j++) places.time[j] = found->time[j];
  eval_textures(scene, &places, textures, &values);
  colour_emissions(scene, found, light_places, &values, emissions);
}

PENUMBRA_NAMESPACE_END
#endif
