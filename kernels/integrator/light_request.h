// The light sampling stage, which runs before an integrator's step of LANES paths where the scene needs it:
// choice of a light by its unshadowed contribution, closed forms, and sampling by projected solid angle.
#ifndef PENUMBRA_LIGHT_REQUEST_H
#define PENUMBRA_LIGHT_REQUEST_H
#include "kernels/integrator/step.h"
#include "kernels/light/light_tree.h"
#include "kernels/light/light_unshadowed.h"
#include "kernels/light/lobe_projection.h"
#include "kernels/light/projected_light.h"

PENUMBRA_NAMESPACE_BEGIN

/// What a step requests from the light sampling stage. A kernel may be compiled for more than its scene
/// needs.
typedef struct {
  bool choice;      ///< choose a light by its unshadowed contribution
  bool closed;      ///< add the closed form to the path's sum
  bool projected;   ///< sample directions by projected solid angle
  bool found;       ///< compute their pdfs for the light that the last ray hit
  bool tree;        ///< choose a light through the hierarchy
  bool tree_found;  ///< compute that choice's probability for the light that the last ray hit
  bool path;        ///< the last ray started at another surface than this one, which it hit
} LightRequest;

/// `path`: see LightRequest. `emits`: the step samples a light. `first`: the step is the first one at its
/// surface. `balances`: direction samples may hit lights too (MIS).
FN LightRequest light_request(const PRIVATE Scene* scene, bool path, bool emits, bool first, bool balances) {
  LightRequest request;
  request.path = path;
  request.choice = HAS(POLYGONS) && emits && scene->header.integrator.light_choice == CHOICE_ANALYTIC;
  request.closed = HAS(POLYGONS) && first && scene->header.integrator.estimator != ESTIMATOR_SAMPLES;
  request.projected = NEEDS(scene, PROJECTED) && emits;
  request.found = NEEDS(scene, PROJECTED) && balances;
  request.tree = NEEDS_LIGHT_TREE(scene) && emits;
  request.tree_found = NEEDS_LIGHT_TREE(scene) && balances;
  return request;
}

#define SHADING_POINT_LANES(stage, strategies)                                                          \
  STAGE void stage(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT surfaces,               \
                   const PRIVATE Closures* RESTRICT closures, PRIVATE ShadingPoints* RESTRICT points) { \
    LANE_LOOP                                                                                           \
      for (int j = 0; j < LANES; j++)                                                                   \
        store_shading_point(scene, load_surface(surfaces, j), load_closure(closures, j), points, j,     \
                            strategies);                                                                \
  }
SHADING_POINT_LANES(store_shading_points, 0u)
SHADING_POINT_LANES(store_moving_shading_points, FEATURE_MOTION)
#undef SHADING_POINT_LANES

STAGE void store_control_points(const PRIVATE Surfaces* RESTRICT surfaces,
                                const PRIVATE Closures* RESTRICT closures,
                                const PRIVATE ControlLanes* RESTRICT controls,
                                PRIVATE ShadingPoints* RESTRICT points) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      store_control_point(load_surface(surfaces, j), load_closure(closures, j),
                          load_control_lobes(controls, j), points, j);
}

/// Adds the closed form, times the throughput, to the paths' sums.
STAGE void add_analytic(const PRIVATE PathState* paths, int i, const PRIVATE double* RESTRICT analytic) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 form =
          make_vec3((float)analytic[j], (float)analytic[LANES + j], (float)analytic[2 * LANES + j]);
      const vec3 more = mul(get_throughput(paths, i + j), form);
      set_analytic(paths, i + j, add(get_analytic(paths, i + j), more));
    }
}

/// Unshadowed light at the surfaces of LANES paths: the closed form, and the choice of a light. The choice
/// uses the random number of the point on the light, and replaces it by the remainder, which is again uniform
/// in [0, 1).
STAGE void unshadowed_lanes(const PRIVATE Scene* scene, LightRequest request,
                            const PRIVATE Surfaces* RESTRICT surfaces,
                            const PRIVATE Closures* RESTRICT closures, const PRIVATE PathState* paths, int i,
                            const PRIVATE ControlLanes* RESTRICT controls, PRIVATE float* RESTRICT u,
                            PRIVATE LightSamplings* RESTRICT samplings, PRIVATE double* RESTRICT projected) {
  ShadingPoints points;
  Reservoir reservoir;
  double analytic[3 * LANES];
  if (NEEDS_MOTION(scene))
    store_moving_shading_points(scene, surfaces, closures, &points);
  else
    store_shading_points(scene, surfaces, closures, &points);
  if (NEEDS_LTC(scene)) store_control_points(surfaces, closures, controls, &points);
  for (int j = 0; j < LANES; j++) start_reservoir(&reservoir, j, (double)u[DIM_LIGHT_U * LANES + j]);
  const bool one_light = scene->polygons[0].light_count == scene->header.tables.lights.count;
  if (request.closed | !one_light)
    unshadowed_lights(scene, &points, request.choice & !one_light, &reservoir, analytic);
  if (one_light)
    for (int j = 0; j < LANES; j++) {
      const bool lit = (points.polygon[j] != 0.0) & (points.closed[j] != 0);
      add_to_reservoir(&reservoir, j, 0, lit ? 1.0 : 0.0);
    }
  if (request.choice)
    choose_part(scene, &points, request.projected, &reservoir, samplings, projected, u + DIM_LIGHT_U * LANES);
  if (request.closed) add_analytic(paths, i, analytic);
}

// Solid angles are projected for one side of a surface. Points on lights are sampled otherwise for closures
// that are lit all around.

/// The normal for projected solid angles; 0 for closures that are lit all around: they have no such pdf.
FN vec3 projected_about(vec3 normal, Closure c) {
  return select3(is_lit_all_around(c), make_vec3(0.0f, 0.0f, 0.0f), normal);
}

/// The lights that lanes sample by projected solid angle: those that `chosen` names, or that are chosen by
/// power. The rests of the numbers that choose them are for points on them.
STAGE void take_projected_lights(const PRIVATE Scene* scene, const PRIVATE int* RESTRICT chosen,
                                 const PRIVATE float* RESTRICT u, PRIVATE int* RESTRICT lights,
                                 PRIVATE float* RESTRICT numbers) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const float number = u[DIM_LIGHT_U * LANES + j];
      const ChosenLight by_power = choose_light(scene, number, u[DIM_LIGHT_FINE * LANES + j]);
      const bool is_chosen = chosen[j] >= 0;
      lights[j] = is_chosen ? chosen[j] : by_power.light;
      numbers[j] = is_chosen ? number : by_power.u;
    }
}

/// Projected solid angles of the lights that were chosen by power, or through the hierarchy.
STAGE void project_by_power(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT receivers,
                            const PRIVATE Closures* RESTRICT closures,
                            const PRIVATE PlacedParts* RESTRICT parts, const PRIVATE int* RESTRICT chosen,
                            PRIVATE double* RESTRICT projected) {
  const bool by_tree = NEEDS_LIGHT_TREE(scene);
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const LightReceiver r = receiver_of(load_surface(receivers, j));
      const int index = parts->lights[j];
      const Light light = placed_part(scene, parts, j);
      const double e = light_irradiance(light, r.p.x, r.p.y, r.p.z, r.shading.x, r.shading.y, r.shading.z);
      const bool none = is_own_light(scene, r, index) | is_lit_all_around(load_closure(closures, j));
      projected[j] = (!by_tree & (chosen[j] >= 0)) ? projected[j] : (none ? 0.0 : e);
    }
}

/// Samples directions by projected solid angle towards the lights.
STAGE void sample_projected_lights(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT receivers,
                                   const PRIVATE PlacedParts* RESTRICT parts,
                                   const PRIVATE float* RESTRICT numbers, const PRIVATE float* RESTRICT v,
                                   const PRIVATE double* RESTRICT projected,
                                   PRIVATE LightSamplings* RESTRICT samplings) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      sample_projected_light(placed_part(scene, parts, j), receiver_of(load_surface(receivers, j)),
                             (float)projected[j], numbers[j], v[j], samplings, j);
}

/// The lights that rays hit, at the rays' times.
FN void place_found(const PRIVATE Scene* scene, const PRIVATE FoundLights* found,
                    PRIVATE PlacedParts* parts) {
  for (int j = 0; j < LANES; j++) parts->lights[j] = found->light[j] >= 0 ? found->light[j] : 0;
  place_lights(scene, parts->lights, found->time, &parts->places);
}

/// Pdfs, for MIS, of the lights that the last rays hit, as sampled at these surfaces.
STAGE void project_found(const PRIVATE Scene* scene, const PRIVATE PlacedParts* RESTRICT parts,
                         const PRIVATE Surfaces* RESTRICT receivers,
                         const PRIVATE Closures* RESTRICT closures, PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 n = projected_about(LOAD_LANE_vec3(receivers->shading, j), load_closure(closures, j));
      found->projected_pdf[j] =
          projected_density(placed_part(scene, parts, j), load_found_light(found, j), n);
    }
}
/// The same, as sampled at the surfaces that the paths left.
STAGE void projected_pdfs_of_hit_lights(const PRIVATE Scene* scene, const PRIVATE PlacedParts* RESTRICT parts,
                                        const PRIVATE PathState* paths, int i,
                                        PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      found->projected_pdf[j] = projected_density(placed_part(scene, parts, j), load_found_light(found, j),
                                                  get_left_normal(paths, i + j));
}

/// Stores the surfaces' normals: the next rays leave these surfaces.
STAGE void note_left_normals(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces,
                             const PRIVATE Closures* RESTRICT closures) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      set_left_normal(paths, i + j,
                      projected_about(LOAD_LANE_vec3(surfaces->shading, j), load_closure(closures, j)));
}

// The same three functions for closures with control lobes.
STAGE void sample_lobes_lights(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT receivers,
                               const PRIVATE Closures* RESTRICT closures,
                               const PRIVATE ControlLanes* RESTRICT controls,
                               const PRIVATE PlacedParts* RESTRICT parts,
                               const PRIVATE float* RESTRICT numbers, const PRIVATE float* RESTRICT v,
                               PRIVATE LightSamplings* RESTRICT samplings) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(receivers, j);
      const LightReceiver r = receiver_of(s);
      sample_lobes_light(placed_part(scene, parts, j), r,
                         receiver_lobes(projected_about(s.shading, load_closure(closures, j)), s.wo,
                                        load_control_lobes(controls, j)),
                         is_own_light(scene, r, parts->lights[j]), numbers[j], v[j], samplings, j);
    }
}
FN ReceiverLobes left_lobes(const PRIVATE PathState* paths, int i) {
  ReceiverLobes r;
  r.normal = get_left_normal(paths, i);
  r.wo = get_left_wo(paths, i);
  r.matrix = get_left_matrix(paths, i);
  r.specular = get_left_specular(paths, i);
  return r;
}
STAGE void project_found_lobes(const PRIVATE Scene* scene, const PRIVATE PlacedParts* RESTRICT parts,
                               const PRIVATE Surfaces* RESTRICT receivers,
                               const PRIVATE Closures* RESTRICT closures,
                               const PRIVATE ControlLanes* RESTRICT controls,
                               PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(receivers, j);
      const ReceiverLobes lobes = receiver_lobes(projected_about(s.shading, load_closure(closures, j)), s.wo,
                                                 load_control_lobes(controls, j));
      found->projected_pdf[j] =
          lobes_density(placed_part(scene, parts, j), load_found_light(found, j), lobes);
    }
}
STAGE void project_found_lobes_of_paths(const PRIVATE Scene* scene, const PRIVATE PlacedParts* RESTRICT parts,
                                        const PRIVATE PathState* paths, int i,
                                        PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      found->projected_pdf[j] =
          lobes_density(placed_part(scene, parts, j), load_found_light(found, j), left_lobes(paths, i + j));
}
STAGE void note_left_lobes(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces,
                           const PRIVATE Closures* RESTRICT closures,
                           const PRIVATE ControlLanes* RESTRICT controls) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const ReceiverLobes lobes = receiver_lobes(projected_about(s.shading, load_closure(closures, j)), s.wo,
                                                 load_control_lobes(controls, j));
      set_left_normal(paths, i + j, lobes.normal);
      set_left_wo(paths, i + j, lobes.wo);
      set_left_matrix(paths, i + j, lobes.matrix);
      set_left_specular(paths, i + j, lobes.specular);
    }
}

/// Pdfs of the lights that were hit, as sampled at the surfaces that the paths left; the second function: at
/// these surfaces.
FN void project_from_left(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                          PRIVATE FoundLights* found) {
  PlacedParts parts;
  place_found(scene, found, &parts);
  if (NEEDS_LTC(scene)) {
    project_found_lobes_of_paths(scene, &parts, paths, i, found);
    return;
  }
  projected_pdfs_of_hit_lights(scene, &parts, paths, i, found);
}
FN void project_at_surfaces(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces,
                            const PRIVATE Closures* closures, const PRIVATE ControlLanes* controls,
                            PRIVATE FoundLights* found) {
  PlacedParts parts;
  place_found(scene, found, &parts);
  if (NEEDS_LTC(scene)) {
    project_found_lobes(scene, &parts, surfaces, closures, controls, found);
    return;
  }
  project_found(scene, &parts, surfaces, closures, found);
}
FN void project_from_surfaces(const PRIVATE Scene* scene, ulong families, const PRIVATE Surfaces* surfaces,
                              const PRIVATE Closures* closures, PRIVATE FoundLights* found) {
  ControlLanes controls;
  if (NEEDS_LTC(scene)) find_controls(scene, families, closures, surfaces, &controls);
  project_at_surfaces(scene, surfaces, closures, &controls, found);
}

/// What the choice of lights depends on: position and normal. The normal is 0 for closures that are lit all
/// around.
STAGE void find_lit_places(const PRIVATE Surfaces* RESTRICT surfaces,
                           const PRIVATE Closures* RESTRICT closures, PRIVATE LitPlaces* RESTRICT places) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const bool all_around = is_lit_all_around(load_closure(closures, j));
      const vec3 facing = LOAD_LANE_vec3(surfaces->shading, j);
      LitPlace place;
      place.p = LOAD_LANE_vec3(surfaces->p, j);
      place.facing = select3(all_around, make_vec3(0.0f, 0.0f, 0.0f), facing);
      store_lit_place(places, j, place);
    }
}

/// Loads those of the surfaces that the last rays left.
STAGE void load_left_places(const PRIVATE PathState* paths, int i, PRIVATE LitPlaces* RESTRICT places,
                            PRIVATE LightScales* RESTRICT scales) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      LitPlace place;
      place.p = get_left_place(paths, i + j);
      place.facing = get_left_facing(paths, i + j);
      store_lit_place(places, j, place);
      LightScale scale;
      scale.finite = get_left_finite_scale(paths, i + j);
      scale.infinite = get_left_infinite_scale(paths, i + j);
      store_light_scales(scales, j, scale);
    }
}

/// Stores them: the next rays leave these surfaces. At glass, those before it stay: its directions are delta,
/// and behind flat glass the choice before it counts.
STAGE void note_left_places(const PRIVATE PathState* paths, int i, const PRIVATE Closures* RESTRICT closures,
                            const PRIVATE LitPlaces* RESTRICT places,
                            const PRIVATE LightScales* RESTRICT scales) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const bool stays = load_closure(closures, j).family == FAMILY_DIELECTRIC;
      const LitPlace place = load_lit_place(places, j);
      const LightScale scale = load_light_scales(scales, j);
      const vec3 p = get_left_place(&fields, i + j), facing = get_left_facing(&fields, i + j);
      const float finite = get_left_finite_scale(&fields, i + j),
                  infinite = get_left_infinite_scale(&fields, i + j);
      set_left_place(&fields, i + j, select3(stays, p, place.p));
      set_left_facing(&fields, i + j, select3(stays, facing, place.facing));
      set_left_finite_scale(&fields, i + j, stays ? finite : scale.finite);
      set_left_infinite_scale(&fields, i + j, stays ? infinite : scale.infinite);
    }
}

/// Probabilities of the lights that rays hit, as chosen at the surfaces that the paths left.
FN void find_previous_pmfs(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                           PRIVATE FoundLights* found) {
  LitPlaces places;
  LightScales scales;
  load_left_places(paths, i, &places, &scales);
  find_tree_pmfs(scene, &places, &scales, found);
}

/// Chooses lights at the surfaces, and computes the probabilities of the lights that rays have hit.
FN void request_by_tree(const PRIVATE Scene* scene, LightRequest request, bool finds, PRIVATE StepLanes* step,
                        const PRIVATE PathState* paths, int i) {
  LitPlaces places;
  LightScales scales;
  const bool finds_here = request.tree_found & finds & !request.path;
  if (request.tree_found & finds & request.path) find_previous_pmfs(scene, paths, i, &step->found);
  if (!(request.tree | finds_here)) return;  // then no path continues either
  find_lit_places(&step->surfaces, &step->closures, &places);
  if (request.tree)
    choose_by_tree(scene, &places, step->u + DIM_LIGHT_U * LANES, step->u + DIM_LIGHT_FINE * LANES,
                   &step->samplings, &scales);
  else
    find_light_scales(scene, &places, &scales);
  if (finds_here) find_tree_pmfs(scene, &places, &scales, &step->found);
  if (request.tree_found & request.path) note_left_places(paths, i, &step->closures, &places, &scales);
}

/// The lights of surfaces that rays pass, in the lanes with `passes`.
FN void find_passed_lights(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces,
                           const PRIVATE int* passes, PRIVATE FoundLights* found) {
  find_lights(scene, surfaces, found);
  for (int j = 0; j < LANES; j++) {
    const bool passed = passes[j] != 0;
    found->light[j] = passed ? found->light[j] : -1;
    found->kind[j] = passed ? found->kind[j] : -1;
  }
}

/// Runs the light sampling stage for LANES paths from lane i on. Samplings that are not requested stay as
/// start_step left them. `finds`: some of the last rays hit lights.
CALLED_FN void request_lights(const PRIVATE Scene* scene, LightRequest request, bool finds,
                              PRIVATE StepLanes* step, const PRIVATE PathState* paths, int i) {
  double projected[LANES];
  for (int j = 0; j < LANES; j++) projected[j] = 0.0;
  if (NEEDS_LTC(scene))
    find_controls(scene, step->families, &step->closures, &step->surfaces, &step->controls);
  if (HAS(POLYGONS) && (request.choice | request.closed))
    unshadowed_lanes(scene, request, &step->surfaces, &step->closures, paths, i, &step->controls, step->u,
                     &step->samplings, projected);
  if (HAS(LIGHT_TREE) && (request.tree | request.tree_found))
    request_by_tree(scene, request, finds, step, paths, i);
  if (!HAS(PROJECTED)) return;
  if (request.found & finds & request.path) project_from_left(scene, paths, i, &step->found);
  if (request.found & finds & !request.path)
    project_at_surfaces(scene, &step->surfaces, &step->closures, &step->controls, &step->found);
  if (request.found & request.path) {
    if (NEEDS_LTC(scene))
      note_left_lobes(paths, i, &step->surfaces, &step->closures, &step->controls);
    else
      note_left_normals(paths, i, &step->surfaces, &step->closures);
  }
  if (!request.projected) return;
  PlacedParts parts;
  float numbers[LANES];
  const PRIVATE float* v = step->u + DIM_LIGHT_V * LANES;
  take_projected_lights(scene, step->samplings.light, step->u, parts.lights, numbers);
  place_lights(scene, parts.lights, step->surfaces.time, &parts.places);
  if (NEEDS_LTC(scene)) {
    sample_lobes_lights(scene, &step->surfaces, &step->closures, &step->controls, &parts, numbers, v,
                        &step->samplings);
    return;
  }
  project_by_power(scene, &step->surfaces, &step->closures, &parts, step->samplings.light, projected);
  sample_projected_lights(scene, &step->surfaces, &parts, numbers, v, projected, &step->samplings);
}

PENUMBRA_NAMESPACE_END
#endif
