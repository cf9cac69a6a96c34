// What rays find of lights.
#ifndef PENUMBRA_LIGHT_FOUND_H
#define PENUMBRA_LIGHT_FOUND_H
#include "kernels/light/light_receiver.h"
#include "kernels/light/light_sample.h"
#include "kernels/light/light_sampling.h"

PENUMBRA_NAMESPACE_BEGIN

/// What a ray found of a light.
typedef struct {
  vec3 from;      ///< where the ray started
  vec3 wi;        ///< unit, its direction
  LightPoint at;  ///< means nothing for an environment
  float distance;
  float cosine;         ///< at the light
  float projected_pdf;  ///< LightSampling.found_pdf
} FoundLight;

/// Index of the light that a ray hits if it ends on this surface, or of the environment if it leaves the
/// scene; negative: none, or the light's back.
FN int light_found(const PRIVATE Scene* scene, Surface s) {
  const int two_sided = scene->lights[s.light >= 0 ? s.light : 0].two_sided;
  const int index = (s.front | (two_sided != 0)) ? s.light : -1;
  return s.valid ? index : scene->header.environment;
}

/// One a lane; coordinate c of lane j at c * LANES + j.
typedef struct {
  float from[3 * LANES], wi[3 * LANES], p[3 * LANES], normal[3 * LANES];  ///< see FoundLight
  float distance[LANES], cosine[LANES], pmf[LANES];
  int light[LANES];  ///< index, or negative: none
  int kind[LANES];   ///< or negative
} FoundLights;

/// Sets lane j to what a ray from that point found of a light.
FN void store_found_light(const PRIVATE Scene* scene, Surface s, vec3 from, PRIVATE FoundLights* found,
                          int j) {
  const int index = light_found(scene, s);
  GLOBAL const Light* light = scene->lights + (index >= 0 ? index : 0);
  const int kind = light->kind;
  STORE3(found->from, LANES, 0, j, from);
  const vec3 wi = negate(s.wo);
  STORE3(found->wi, LANES, 0, j, wi);
  STORE3(found->p, LANES, 0, j, s.p);
  STORE3(found->normal, LANES, 0, j, s.geometric);
  found->distance[j] = s.distance;
  found->cosine[j] = dot3(s.geometric, s.wo);
  found->pmf[j] = light->pmf;
  found->light[j] = index;
  found->kind[j] = index >= 0 ? kind : -1;
}

FN FoundLight load_found_light(const PRIVATE FoundLights* found, const PRIVATE float* samplings, int j) {
  FoundLight one;
  one.from = LOAD3(found->from, LANES, 0, j);
  one.wi = LOAD3(found->wi, LANES, 0, j);
  one.at.p = LOAD3(found->p, LANES, 0, j);
  one.at.normal = LOAD3(found->normal, LANES, 0, j);
  one.distance = found->distance[j];
  one.cosine = found->cosine[j];
  one.projected_pdf = load_light_sampling(samplings, j).found_pdf;
  return one;
}

/// Radiance that a ray brings when it ends on a light, or leaves the scene; `pdf` is the density with which
/// sample_lights chooses the ray's direction from its origin. 0 where no light is there.
typedef struct {
  vec3 radiance;
  float pdf;
  bool of_polygon;  ///< see LightSample
} Emission;

/// One a lane; channel c of lane j at c * LANES + j.
typedef struct {
  float radiance[3 * LANES], pdf[LANES];
  int of_polygon[LANES];
} Emissions;

FN Emission load_emission(const PRIVATE Emissions* emissions, int j) {
  Emission e;
  e.radiance = LOAD3(emissions->radiance, LANES, 0, j);
  e.pdf = emissions->pdf[j];
  e.of_polygon = emissions->of_polygon[j] != 0;
  return e;
}

STAGE void no_emissions(const PRIVATE Scene* scene, const PRIVATE FoundLights* RESTRICT found,
                        PRIVATE Emissions* RESTRICT emissions) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int polygon = own_polygon(scene, found->light[j]);
      const vec3 none = make_vec3(0.0f, 0.0f, 0.0f);
      STORE3(emissions->radiance, LANES, 0, j, none);
      emissions->pdf[j] = 0.0f;
      emissions->of_polygon[j] = polygon >= 0 ? 1 : 0;
    }
}

/// Makes these lane j's if the light found is of that kind.
FN void keep_emission(const PRIVATE FoundLights* found, int kind, vec3 radiance, float pdf,
                      PRIVATE Emissions* emissions, int j) {
  const bool mine = found->kind[j] == kind;
  const vec3 kept = select3(mine, radiance, LOAD3(emissions->radiance, LANES, 0, j));
  const float pdf_before = emissions->pdf[j], pdf_now = pdf * found->pmf[j];
  STORE3(emissions->radiance, LANES, 0, j, kept);
  emissions->pdf[j] = mine ? pdf_now : pdf_before;
}

PENUMBRA_NAMESPACE_END
#endif
