// What the steps of all integrators share: LANES paths at a time go through short stages, each a lane loop over
// records that stay in the first-level cache. A stage that the scene does not need is not called.
#ifndef PENUMBRA_STEP_H
#define PENUMBRA_STEP_H
#include "kernels/block/block_surface.h"
#include "kernels/bsdf/bsdf.h"
#include "kernels/integrator/light_request.h"
#include "kernels/light/light.h"
#include "kernels/light/mis.h"
#include "kernels/sampler/sampler.h"

PENUMBRA_NAMESPACE_BEGIN

/// LANES paths in a step.
typedef struct {
  float u[STEP_DIMENSIONS * LANES];  ///< random numbers, DIM_* of lane j at DIM_* * LANES + j
  Surfaces surfaces;                 ///< where they scatter
  Surfaces found;                    ///< where their last rays ended, if elsewhere
  LightSamplings samplings;
  Emissions emissions;  ///< what their last rays found
  LightSamples lights;
  BsdfValues values;    ///< towards the lights
  BsdfSamples samples;  ///< of a next direction
} StepLanes;

FN float lane_number(const PRIVATE StepLanes* step, int dimension, int j) {
  return step->u[dimension * LANES + j];
}

STAGE void find_emissions(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT surfaces,
                          const PRIVATE LightSamplings* RESTRICT samplings,
                          PRIVATE Emissions* RESTRICT emissions) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      store_emission(emissions, j,
                     emission_at(scene, load_surface(surfaces, j), load_light_sampling(samplings, j)));
}

STAGE void sample_lights(const PRIVATE Scene* scene, PRIVATE StepLanes* RESTRICT step) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      store_light_sample(
          &step->lights, j,
          sample_light(scene, load_surface(&step->surfaces, j), lane_number(step, DIM_LIGHT_U, j),
                       lane_number(step, DIM_LIGHT_V, j), lane_number(step, DIM_LIGHT_FINE, j),
                       load_light_sampling(&step->samplings, j)));
}

STAGE void eval_bsdfs(const PRIVATE Scene* scene, PRIVATE StepLanes* RESTRICT step) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(&step->surfaces, j);
      const vec3 wi = LOAD_LANE_vec3(step->lights.wi, j);
      store_bsdf_value(&step->values, j, eval_bsdf(scene->materials + s.material, s.shading, s.wo, wi));
    }
}

STAGE void sample_bsdfs(const PRIVATE Scene* scene, PRIVATE StepLanes* RESTRICT step) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(&step->surfaces, j);
      store_bsdf_sample(&step->samples, j,
                        sample_bsdf(scene->materials + s.material, s.shading, s.wo,
                                    lane_number(step, DIM_BSDF_U, j), lane_number(step, DIM_BSDF_V, j),
                                    lane_number(step, DIM_LOBE_CHOICE, j)));
    }
}

/// Whether the light's samples at the surface have its closed form as control variate.
FN bool is_controlled(const PRIVATE Scene* scene, bool of_polygon) {
  return NEEDS(scene, POLYGONS) & (scene->header.integrator.estimator != ESTIMATOR_SAMPLES) & of_polygon;
}

/// Requests the shadow ray of lane i's light sample; `arriving` is what it brings if nothing is in the way.
FN void request_shadow_ray(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, Surface s,
                           LightSample light, vec3 arriving, bool lit) {
  const bool beneath = is_beneath(s, light.wi) & (scene->header.integrator.trace_shadows != 0);
  const bool controlled = is_controlled(scene, light.of_polygon);
  set_shadow_origin(paths, i, light.origin);
  set_shadow_direction(paths, i, light.toward);
  set_shadow_radiance(paths, i, arriving);
  set_shadow_tmax(paths, i, (lit & (controlled | !beneath)) ? light.tmax : -1.0f);
  set_shadow_skip(paths, i, s.primitive);
#if HAS(POLYGONS)
  if (NEEDS(scene, POLYGONS))
    set_shadow_controlled(paths, i,
                          controlled ? (beneath ? CONTROLLED_BENEATH : CONTROLLED_SEEN) : CONTROLLED_NOT);
#endif
}

#if HAS(LAYERS)
/// Albedo, normal and depth of what the camera rays hit.
STAGE void record_layers(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT surfaces,
                         const PRIVATE PathState* paths, int i, const PRIVATE SlotState* slots) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      GLOBAL const Material* m = scene->materials + s.material;
      const vec3 zero = make_vec3(0.0f, 0.0f, 0.0f);
      const int slot = get_slot(paths, i + j);
      set_slot_albedo(slots, slot,
                      select3(is_hit(s), add(load3(&m->diffuse), load3(&m->specular)), zero));
      set_slot_normal(slots, slot, select3(is_hit(s), s.shading, zero));
      set_slot_distance(slots, slot, is_hit(s) ? s.distance : 0.0f);
    }
}
#endif

PENUMBRA_NAMESPACE_END
#endif
