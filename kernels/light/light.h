// Lights, for LANES receivers or rays at a time: samples of points on them, their emission at the hits of
// rays, and the pdfs for multiple importance sampling. Each kind of light that the scene has goes through all
// lanes in a loop of its own; other kinds cost nothing.
#ifndef PENUMBRA_LIGHT_H
#define PENUMBRA_LIGHT_H
#include "kernels/light/cylinder_light.h"
#include "kernels/light/delta_lights.h"
#include "kernels/light/disk_light.h"
#include "kernels/light/envmap_light.h"
#include "kernels/light/light_choice.h"
#include "kernels/light/light_sample.h"
#include "kernels/light/light_spread.h"
#include "kernels/light/light_texture.h"
#include "kernels/light/medium_light.h"
#include "kernels/light/rectangle_light.h"
#include "kernels/light/round_spot_light.h"
#include "kernels/light/sphere_light.h"
#include "kernels/light/sun_light.h"
#include "kernels/light/triangle_light.h"

PENUMBRA_NAMESPACE_BEGIN

/// Lights at places, and their axes.
typedef struct {
  LightPlaces places;
  LightAxesLanes axes;
} PlacedLights;

// The light that a lane samples.
#define CHOSEN_LIGHT_FIELDS(F, a)                                                   \
  F(a, int, light)                                                                  \
  F(a, int, kind)                                                                   \
  F(a, bool, own) /* the receiver is part of the light and gets no light from it */ \
  F(a, bool, of_polygon)                                                            \
  F(a, float, u) /* remainder of the number that chose the light */                 \
  F(a, float, pmf)
LANE_RECORD(LaneLight, ChosenLights, chosen_light, CHOSEN_LIGHT_FIELDS)

/// Whether the scene has only one light. If so, all lanes share its record instead of loading their own.
FN bool has_one_light(const PRIVATE Scene* scene) { return scene->header.tables.lights.count == 1; }

// Chooses lights by `number` and `fine`, see choose_light, or as the samplings say. `kind` is that of all
// lights; if there are several kinds, detail_choices sets them.
#define CHOOSE_LANES(stage, by_power_of_lane)                                                        \
  STAGE void stage(const PRIVATE Scene* scene, int kind, const PRIVATE Surfaces* RESTRICT receivers, \
                   const PRIVATE float* RESTRICT number, const PRIVATE float* RESTRICT fine,         \
                   const PRIVATE LightSamplings* RESTRICT samplings,                                 \
                   PRIVATE ChosenLights* RESTRICT chosen) {                                          \
    LANE_LOOP                                                                                        \
      for (int j = 0; j < LANES; j++) {                                                              \
        const LightSampling sampling = load_light_sampling(samplings, j);                            \
        const ChosenLight by_power = by_power_of_lane;                                               \
        const bool is_chosen = sampling.light >= 0;                                                  \
        LaneLight choice;                                                                            \
        choice.light = is_chosen ? sampling.light : by_power.light;                                  \
        choice.kind = kind;                                                                          \
        choice.own = choice.light == receivers->light[j];                                            \
        choice.of_polygon = false;                                                                   \
        choice.u = is_chosen ? number[j] : by_power.u;                                               \
        choice.pmf = is_chosen ? sampling.pmf : by_power.pmf;                                        \
        store_chosen_light(chosen, j, choice);                                                       \
      }                                                                                              \
  }
CHOOSE_LANES(choose_lights, choose_light(scene, number[j], fine[j]))
CHOOSE_LANES(choose_only_light, take_light(scene, 0, number[j], fine[j]))
#undef CHOOSE_LANES

/// Completes the choices in scenes with several kinds of lights, with spheres, cylinders or polygons.
STAGE void detail_choices(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT receivers,
                          PRIVATE ChosenLights* RESTRICT chosen) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int index = chosen->light[j];
      GLOBAL const Light* light = scene->lights + index;
      chosen->kind[j] = light->kind;
      chosen->of_polygon[j] = light->polygon >= 0 ? 1 : 0;
      chosen->own[j] = is_own_light(scene, receiver_of(load_surface(receivers, j)), index) ? 1 : 0;
    }
}

/// Stores `s` as lane j's sample if its light is of that kind. Otherwise the sample is unchanged or, if
/// `first`, becomes empty.
FN void keep_light_sample(LaneLight choice, int kind, LightSample s, bool first, ulong strategies,
                          PRIVATE LightSamples* samples, int j) {
  s.pdf *= choice.pmf;
  s.tmax = (!choice.own & (s.pdf > 0.0f)) ? s.tmax : -1.0f;
  s.of_polygon = choice.of_polygon;
  s.light = choice.light;
  const LightSample before = select_light_sample(first, no_light_sample(), load_light_sample(samples, j));
  const LightSample kept = select_light_sample(choice.kind == kind, s, before);
  store_light_sample_direction(samples, j, kept);
  if (BY(strategies, LIGHT_TEXTURES)) store_light_sample_place(samples, j, kept);
}

/// For scenes without lights.
STAGE void sample_no_lights(PRIVATE LightSamples* RESTRICT samples) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) store_light_sample(samples, j, no_light_sample());
}

// Loops over lanes for each kind of light: the plain strategy, and sampling by solid angle for scenes that
// need nothing else, each with a variant for a single light; and all strategies of the kind, for lights at
// the given places. `index` is the lane's light.
#define SAMPLE_LANES(stage, name, NAME, index, strategies, light_of_lane, axes_of_lane)                      \
  STAGE void stage(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT receivers,                   \
                   const PRIVATE ChosenLights* RESTRICT chosen, const PRIVATE PlacedLights* RESTRICT places, \
                   const PRIVATE float* RESTRICT v, const PRIVATE LightSamplings* RESTRICT samplings,        \
                   bool first, PRIVATE LightSamples* RESTRICT samples) {                                     \
    LANE_LOOP                                                                                                \
      for (int j = 0; j < LANES; j++) {                                                                      \
        const LaneLight choice = load_chosen_light(chosen, j);                                               \
        const LightReceiver receiver = receiver_of(load_surface(receivers, j));                              \
        const LightSample s =                                                                                \
            sample_##name##_light(scene, index, light_of_lane(index), axes_of_lane(index, LIGHT_##NAME),     \
                                  receiver, choice.u, v[j], load_light_sampling(samplings, j), strategies);  \
        keep_light_sample(choice, LIGHT_##NAME, s, first, strategies, samples, j);                           \
      }                                                                                                      \
  }
#define FOUND_LANES(stage, name, NAME, compared, strategies, light_of_lane)                              \
  STAGE void stage(const PRIVATE Scene* scene, const PRIVATE FoundLights* RESTRICT found,                \
                   const PRIVATE PlacedLights* RESTRICT places, PRIVATE Emissions* RESTRICT emissions) { \
    LANE_LOOP                                                                                            \
      for (int j = 0; j < LANES; j++) {                                                                  \
        const FoundLight one = load_found_light(found, j);                                               \
        const int index = one.light >= 0 ? one.light : 0;                                                \
        const Light light = light_of_lane(index);                                                        \
        LightPoint at = light_point(one.p, one.normal);                                                  \
        at.u = one.u;                                                                                    \
        at.v = one.v;                                                                                    \
        const vec3 radiance = name##_light_radiance(scene, light, at, one.wi);                           \
        const float pdf = compared ? name##_light_pdf(scene, light, one, strategies) : 0.0f;             \
        keep_emission(one, LIGHT_##NAME, radiance, pdf, emissions, j);                                   \
      }                                                                                                  \
  }
#define OWN_LIGHT(index) load_light(scene->lights + (index))
#define OWN_AXES(index, kind) still_axes(scene, index, kind)
#define PLACED_LIGHT(index) placed_light(OWN_LIGHT(index), load_light_place(&places->places, j))
#define PLACED_AXES(index, kind) load_light_axes(&places->axes, j)
#define KIND_LANES(name, NAME, number, strategies, description)                                              \
  SAMPLE_LANES(sample_##name##_lights, name, NAME, choice.light, 0u, OWN_LIGHT, OWN_AXES)                    \
  SAMPLE_LANES(sample_##name##_lights_by_strategy, name, NAME, choice.light, COMPILED_FEATURES&(strategies), \
               PLACED_LIGHT, PLACED_AXES)                                                                    \
  SAMPLE_LANES(sample_only_##name##_light, name, NAME, 0, 0u, OWN_LIGHT, OWN_AXES)                           \
  SAMPLE_LANES(sample_##name##_lights_by_solid_angle, name, NAME, choice.light,                              \
               COMPILED_FEATURES&(strategies)&FEATURE_SOLID_ANGLE, OWN_LIGHT, OWN_AXES)                      \
  SAMPLE_LANES(sample_only_##name##_light_by_solid_angle, name, NAME, 0,                                     \
               COMPILED_FEATURES&(strategies)&FEATURE_SOLID_ANGLE, OWN_LIGHT, OWN_AXES)                      \
  FOUND_LANES(see_##name##_lights, name, NAME, 0, 0u, OWN_LIGHT)                                             \
  FOUND_LANES(find_##name##_lights, name, NAME, 1, 0u, OWN_LIGHT)                                            \
  FOUND_LANES(find_##name##_lights_by_solid_angle, name, NAME, 1,                                            \
              COMPILED_FEATURES&(strategies)&FEATURE_SOLID_ANGLE, OWN_LIGHT)                                 \
  FOUND_LANES(find_##name##_lights_by_strategy, name, NAME, 1, COMPILED_FEATURES&(strategies), PLACED_LIGHT)
LIGHT_KINDS(KIND_LANES)
#undef KIND_LANES
#undef FOUND_LANES
#undef SAMPLE_LANES

// Kinds of lights that can move; and those whose radiance at a ray changes with it.
#define MOVING_KINDS (~(1u << LIGHT_ENVIRONMENT | 1u << LIGHT_RECTANGLE | 1u << LIGHT_MEDIUM))
#define TURNING_KINDS (1u << LIGHT_ENVMAP)
#define IS_AMONG(number, kinds) (((kinds) >> (number)&1u) != 0u)

/// Whether the scene needs any of these sampling strategies.
#define NEEDS_STRATEGIES(scene, strategies) \
  ((COMPILED_FEATURES & (strategies)) != 0 && (SCENE_FEATURES(&(scene)->header) & (strategies)) != 0)
/// Whether it does, and needs exactly those of `few`.
#define NEEDS_FEW_STRATEGIES(scene, strategies, few)  \
  ((COMPILED_FEATURES & (strategies) & (few)) != 0 && \
   (SCENE_FEATURES(&(scene)->header) & (strategies)) == (few))

/// Whether stages read the places of lights: those of all strategies, but not those of solid angles alone;
/// and any of lights that move.
FN bool needs_places(const PRIVATE Scene* scene) {
  return lights_move(scene) ||
         NEEDS_STRATEGIES(scene, FEATURE_PROJECTED | FEATURE_UV | FEATURE_LIGHT_TEXTURES | FEATURE_SPREAD);
}

/// A mask of the kinds among LANES that the scene has; negative kinds are none.
FN uint kinds_among(const PRIVATE Scene* scene, const PRIVATE int* kinds) {
  uint among = 0u;
  for (int j = 0; j < LANES; j++) among |= kinds[j] >= 0 ? 1u << kinds[j] : 0u;
  return among & SCENE_LIGHT_KINDS(&scene->header) & LIGHT_KINDS_MASK;
}

/// Chooses a light for each receiver by `number` and `fine`, see choose_light, or as the samplings say; the
/// remainder of `number` and `v` will sample a point on it. `of_grid` (LANES numbers) replaces `v` in scenes
/// with FEATURE_LIGHT_TEXTURES. Returns a mask of the chosen kinds.
FN uint choose_lane_lights(const PRIVATE Scene* scene, const PRIVATE Surfaces* receivers,
                           const PRIVATE float* number, const PRIVATE float* v, const PRIVATE float* fine,
                           PRIVATE LightSamplings* samplings, PRIVATE ChosenLights* chosen,
                           PRIVATE float* of_grid) {
  const uint kinds = SCENE_LIGHT_KINDS(&scene->header);
  const int kind = kinds != 0u ? LOWEST_BIT(kinds) : 0;
  if (has_one_light(scene))
    choose_only_light(scene, kind, receivers, number, fine, samplings, chosen);
  else
    choose_lights(scene, kind, receivers, number, fine, samplings, chosen);
  const bool one_kind = (kinds & (kinds - 1u)) == 0u;
  if (!one_kind || NEEDS_LIGHT(scene, SPHERE) || NEEDS_LIGHT(scene, CYLINDER) || NEEDS(scene, POLYGONS))
    detail_choices(scene, receivers, chosen);
  const uint among = kinds_among(scene, chosen->kind);
  if (NEEDS(scene, LIGHT_TEXTURES)) {
    for (int j = 0; j < LANES; j++) of_grid[j] = v[j];
    choose_by_light_grids(scene, chosen->light, chosen->u, of_grid, chosen->pmf);
    v = of_grid;
  }
  if (HAS_LIGHT(ENVMAP) && (among >> LIGHT_ENVMAP & 1u) != 0u)
    choose_envmap_cells(scene, chosen->kind, chosen->u, v, samplings);
  if (HAS_LIGHT(MEDIUM) && (among >> LIGHT_MEDIUM & 1u) != 0u)
    choose_glow_points(scene, chosen->light, chosen->kind, chosen->u, v, samplings);
  return among;
}

/// Chooses a light for each receiver by `number` and `fine`, see choose_light, and samples a point on it by
/// the remainder of `number` and by `v`; or as the samplings say.
CALLED_FN void sample_lights(const PRIVATE Scene* scene, const PRIVATE Surfaces* receivers,
                             const PRIVATE float* number, const PRIVATE float* v, const PRIVATE float* fine,
                             PRIVATE LightSamplings* samplings, PRIVATE LightSamples* samples) {
  ChosenLights chosen;
  float of_grid[LANES];
  const uint among = choose_lane_lights(scene, receivers, number, v, fine, samplings, &chosen, of_grid);
  const bool one = has_one_light(scene), moving = lights_move(scene);
  if (NEEDS(scene, LIGHT_TEXTURES)) v = of_grid;
  PlacedLights places;
  if (needs_places(scene)) {
    place_lights(scene, chosen.light, receivers->time, &places.places);
    place_light_axes(scene, chosen.light, receivers->time, &places.axes);
  }
  bool first = true;
#define SAMPLE_KIND(name, NAME, number, strategies, description)                                            \
  if (HAS_LIGHT_OF(number) && (among >> (number)&1u) != 0u) {                                               \
    if (IS_AMONG(number, MOVING_KINDS) && moving)                                                           \
      sample_##name##_lights_by_strategy(scene, receivers, &chosen, &places, v, samplings, first, samples); \
    else if (NEEDS_FEW_STRATEGIES(scene, strategies, FEATURE_SOLID_ANGLE) && one)                           \
      sample_only_##name##_light_by_solid_angle(scene, receivers, &chosen, &places, v, samplings, first,    \
                                                samples);                                                   \
    else if (NEEDS_FEW_STRATEGIES(scene, strategies, FEATURE_SOLID_ANGLE))                                  \
      sample_##name##_lights_by_solid_angle(scene, receivers, &chosen, &places, v, samplings, first,        \
                                            samples);                                                       \
    else if (NEEDS_STRATEGIES(scene, strategies))                                                           \
      sample_##name##_lights_by_strategy(scene, receivers, &chosen, &places, v, samplings, first, samples); \
    else if (one)                                                                                           \
      sample_only_##name##_light(scene, receivers, &chosen, &places, v, samplings, first, samples);         \
    else                                                                                                    \
      sample_##name##_lights(scene, receivers, &chosen, &places, v, samplings, first, samples);             \
    first = false;                                                                                          \
  }
  LIGHT_KINDS(SAMPLE_KIND)
#undef SAMPLE_KIND
  if (first) sample_no_lights(samples);
  if (NEEDS(scene, LIGHT_TEXTURES)) texture_light_samples(scene, receivers->time, samples);
  if (NEEDS(scene, SPREAD)) spread_light_samples(scene, &places.places, samples);
  if (HAS_LIGHT(MEDIUM) && (among >> LIGHT_MEDIUM & 1u) != 0u)
    colour_glow_samples(scene, chosen.light, chosen.kind, samplings, samples);
}

/// The emission of the lights that rays hit. Pdfs are 0 unless `compared`.
CALLED_FN void find_emissions(const PRIVATE Scene* scene, const PRIVATE FoundLights* found, bool compared,
                              PRIVATE Emissions* emissions) {
  const uint among = kinds_among(scene, found->kind);
  const bool moving = lights_move(scene);
  PlacedLights places;
  if (needs_places(scene)) place_lights(scene, found->light, found->time, &places.places);
  no_emissions(scene, found, emissions);
#define FIND_KIND(name, NAME, number, strategies, description)                                     \
  if (HAS_LIGHT_OF(number) && (among >> (number)&1u) != 0u) {                                      \
    if (IS_AMONG(number, MOVING_KINDS) && moving && (compared || IS_AMONG(number, TURNING_KINDS))) \
      find_##name##_lights_by_strategy(scene, found, &places, emissions);                          \
    else if (!compared)                                                                            \
      see_##name##_lights(scene, found, &places, emissions);                                       \
    else if (NEEDS_FEW_STRATEGIES(scene, strategies, FEATURE_SOLID_ANGLE))                         \
      find_##name##_lights_by_solid_angle(scene, found, &places, emissions);                       \
    else if (NEEDS_STRATEGIES(scene, strategies))                                                  \
      find_##name##_lights_by_strategy(scene, found, &places, emissions);                          \
    else                                                                                           \
      find_##name##_lights(scene, found, &places, emissions);                                      \
  }
  LIGHT_KINDS(FIND_KIND)
#undef FIND_KIND
  if (moving && !compared)
    for (int j = 0; j < LANES; j++) emissions->pdf[j] = 0.0f;
  if (NEEDS(scene, LIGHT_TEXTURES) && among != 0u) texture_emissions(scene, found, &places.places, emissions);
  if (NEEDS(scene, SPREAD) && among != 0u) spread_emissions(scene, found, emissions);
}

PENUMBRA_NAMESPACE_END
#endif
