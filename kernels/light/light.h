// Lights, LANES receivers or rays at a time: points on them, what rays find of them, and the densities that
// multiple importance sampling compares. Each kind that the scene has goes through all lanes in a loop of its
// own; a kind that it lacks costs nothing.
#ifndef PENUMBRA_LIGHT_H
#define PENUMBRA_LIGHT_H
#include "kernels/light/disk_light.h"
#include "kernels/light/environment_light.h"
#include "kernels/light/light_choice.h"
#include "kernels/light/light_found.h"
#include "kernels/light/light_sample.h"
#include "kernels/light/light_sampling.h"
#include "kernels/light/point_light.h"
#include "kernels/light/rectangle_light.h"
#include "kernels/light/sphere_light.h"
#include "kernels/light/triangle_light.h"

PENUMBRA_NAMESPACE_BEGIN

/// The light that each lane samples.
typedef struct {
  int light[LANES], kind[LANES], own[LANES];
  float u[LANES], pmf[LANES];
} ChosenLights;

/// By `number` and `fine`, see choose_light, or as the samplings say. The samples become those of lights that
/// give nothing.
STAGE void choose_lights(const PRIVATE Scene* scene, const PRIVATE LightReceivers* RESTRICT receivers,
                         const PRIVATE float* RESTRICT number, const PRIVATE float* RESTRICT fine,
                         const PRIVATE float* RESTRICT samplings, PRIVATE ChosenLights* RESTRICT chosen,
                         PRIVATE LightSamples* RESTRICT samples) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const LightSampling sampling = load_light_sampling(samplings, j);
      const ChosenLight by_power = choose_light(scene, number[j], fine[j]);
      const bool is_chosen = sampling.light >= 0.0f;
      const int index = is_chosen ? (int)sampling.light : by_power.light;
      GLOBAL const Light* light = scene->lights + index;
      const float pmf = light->pmf;
      chosen->light[j] = index;
      chosen->kind[j] = light->kind;
      chosen->own[j] = is_own_light(scene, load_receiver(receivers, j), index) ? 1 : 0;
      chosen->u[j] = is_chosen ? number[j] : by_power.u;
      chosen->pmf[j] = is_chosen ? sampling.pmf : pmf;
      LightSample sample = no_light_sample();
      sample.light = index;
      sample.of_polygon = light->polygon >= 0;
      store_light_sample(samples, j, sample);
    }
}

/// Where no light is wanted.
STAGE void sample_no_lights(PRIVATE LightSamples* RESTRICT samples) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) store_light_sample(samples, j, no_light_sample());
}

/// Makes `s` lane j's sample if its light is of that kind.
FN void keep_light_sample(const PRIVATE ChosenLights* chosen, int kind, LightSample s,
                          PRIVATE LightSamples* samples, int j) {
  const LightSample before = load_light_sample(samples, j);
  const bool mine = chosen->kind[j] == kind;
  const float pdf = s.pdf * chosen->pmf[j];
  const float tmax = ((chosen->own[j] == 0) & (pdf > 0.0f)) ? s.tmax : -1.0f;
  const vec3 origin = select3(mine, s.origin, before.origin), toward = select3(mine, s.toward, before.toward);
  const vec3 wi = select3(mine, s.wi, before.wi), radiance = select3(mine, s.radiance, before.radiance);
  STORE3(samples->origin, LANES, 0, j, origin);
  STORE3(samples->toward, LANES, 0, j, toward);
  STORE3(samples->wi, LANES, 0, j, wi);
  STORE3(samples->radiance, LANES, 0, j, radiance);
  samples->tmax[j] = mine ? tmax : before.tmax;
  samples->pdf[j] = mine ? pdf : before.pdf;
  samples->delta[j] = ((mine & s.delta) | (!mine & before.delta)) ? 1 : 0;
}

// For each kind loops over lanes, one for the plain ways and one for those of the kind's features.
#define SAMPLE_LANES(stage, name, NAME, ways)                                                         \
  STAGE void stage(const PRIVATE Scene* scene, const PRIVATE LightReceivers* RESTRICT receivers,      \
                   const PRIVATE ChosenLights* RESTRICT chosen, const PRIVATE float* RESTRICT v,      \
                   const PRIVATE float* RESTRICT samplings, PRIVATE LightSamples* RESTRICT samples) { \
    LANE_LOOP                                                                                         \
      for (int j = 0; j < LANES; j++) {                                                               \
        const LightSample s =                                                                         \
            sample_##name##_light(scene->lights + chosen->light[j], load_receiver(receivers, j),      \
                                  chosen->u[j], v[j], load_light_sampling(samplings, j), ways);       \
        keep_light_sample(chosen, LIGHT_##NAME, s, samples, j);                                       \
      }                                                                                               \
  }
#define FOUND_LANES(stage, name, NAME, compared, ways)                                               \
  STAGE void stage(const PRIVATE Scene* scene, const PRIVATE FoundLights* RESTRICT found,            \
                   const PRIVATE float* RESTRICT samplings, PRIVATE Emissions* RESTRICT emissions) { \
    LANE_LOOP                                                                                        \
      for (int j = 0; j < LANES; j++) {                                                              \
        const int index = found->light[j];                                                           \
        GLOBAL const Light* light = scene->lights + (index >= 0 ? index : 0);                        \
        const FoundLight one = load_found_light(found, samplings, j);                                \
        const vec3 radiance = name##_light_radiance(light, one.at, one.wi);                          \
        const float pdf = compared ? name##_light_pdf(light, one, ways) : 0.0f;                      \
        keep_emission(found, LIGHT_##NAME, radiance, pdf, emissions, j);                             \
      }                                                                                              \
  }
#define KIND_LANES(name, NAME, number, ways, description)                               \
  SAMPLE_LANES(sample_##name##_lights, name, NAME, 0u)                                  \
  SAMPLE_LANES(sample_##name##_lights_by_ways, name, NAME, (uint)((FEATURES) & (ways))) \
  FOUND_LANES(see_##name##_lights, name, NAME, 0, 0u)                                   \
  FOUND_LANES(find_##name##_lights, name, NAME, 1, 0u)                                  \
  FOUND_LANES(find_##name##_lights_by_ways, name, NAME, 1, (uint)((FEATURES) & (ways)))
LIGHT_KINDS(KIND_LANES)
#undef KIND_LANES
#undef FOUND_LANES
#undef SAMPLE_LANES

/// Whether the scene is one whose lights of a kind are sampled by these ways.
#define NEEDS_WAYS(scene, ways) \
  (((FEATURES) & (ways)) != 0 && ((scene)->header.features & (uint)(ways)) != 0u)

/// Chooses a light for each receiver by `number` and `fine`, see choose_light, and a point on it by what is
/// left of `number` and by `v`; or as the samplings say.
FN void sample_lights(const PRIVATE Scene* scene, const PRIVATE LightReceivers* receivers,
                      const PRIVATE float* number, const PRIVATE float* v, const PRIVATE float* fine,
                      const PRIVATE float* samplings, PRIVATE LightSamples* samples) {
  ChosenLights chosen;
  choose_lights(scene, receivers, number, fine, samplings, &chosen, samples);
#define SAMPLE_KIND(name, NAME, number, ways, description)                              \
  if (NEEDS_LIGHT(scene, NAME)) {                                                       \
    if (NEEDS_WAYS(scene, ways))                                                        \
      sample_##name##_lights_by_ways(scene, receivers, &chosen, v, samplings, samples); \
    else                                                                                \
      sample_##name##_lights(scene, receivers, &chosen, v, samplings, samples);         \
  }
  LIGHT_KINDS(SAMPLE_KIND)
#undef SAMPLE_KIND
}

/// What the lights that rays found add to them. Densities are 0 unless they are `compared`.
FN void find_emissions(const PRIVATE Scene* scene, const PRIVATE FoundLights* found, bool compared,
                       const PRIVATE float* samplings, PRIVATE Emissions* emissions) {
  no_emissions(scene, found, emissions);
#define FIND_KIND(name, NAME, number, ways, description)                \
  if (NEEDS_LIGHT(scene, NAME)) {                                       \
    if (!compared)                                                      \
      see_##name##_lights(scene, found, samplings, emissions);          \
    else if (NEEDS_WAYS(scene, ways))                                   \
      find_##name##_lights_by_ways(scene, found, samplings, emissions); \
    else                                                                \
      find_##name##_lights(scene, found, samplings, emissions);         \
  }
  LIGHT_KINDS(FIND_KIND)
#undef FIND_KIND
}

PENUMBRA_NAMESPACE_END
#endif
