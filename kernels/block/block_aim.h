// The stage before a step that looks at lights from the surfaces of LANES paths, where the scene asks for it:
// choice of a light by its contribution, closed forms, directions by projected solid angle.
#ifndef PENUMBRA_BLOCK_AIM_H
#define PENUMBRA_BLOCK_AIM_H
#include "kernels/light/light_choice.h"
#include "kernels/light/light_survey.h"
#include "kernels/light/projected_light.h"
#include "kernels/sampler/sampler.h"

PENUMBRA_NAMESPACE_BEGIN

/// Where a path keeps the surface that is lit.
typedef struct {
  int hit, origin_x, direction_x;
} SurfaceFields;

/// What a step wants to know. A kernel may be compiled for more than its scene.
typedef struct {
  bool choice;     ///< of a light by its contribution
  bool closed;     ///< the closed form, to be added
  bool projected;  ///< directions by projected solid angle
  bool found;      ///< their densities for what the last ray found
  bool path;       ///< the surface is the last ray's hit, which left a surface with normal REFERENCE_NORMAL
} AimWishes;

FN bool wants_projected(const PRIVATE Scene* scene) {
  return (scene->header.features & FEATURE_PROJECTED) != 0u;
}

/// `emits`: the step samples a light. `first`: the surface was not there at the step before. `balances`:
/// other samples may find lights too.
FN AimWishes aim_wishes(const PRIVATE Scene* scene, bool path, bool emits, bool first, bool balances) {
  AimWishes w;
  w.path = path;
  w.choice = HAS(POLYGONS) && emits && scene->header.light_choice == CHOICE_ANALYTIC;
  w.closed = HAS(POLYGONS) && first && scene->header.estimator != ESTIMATOR_SAMPLES;
  w.projected = HAS(PROJECTED) && emits && wants_projected(scene);
  w.found = HAS(PROJECTED) && balances && wants_projected(scene);
  return w;
}

#if HAS(POLYGONS)
STAGE void store_lit_points(const PRIVATE Scene* scene, SurfaceFields at, const GLOBAL float* RESTRICT f,
                            const GLOBAL int* RESTRICT ints, int capacity, int i,
                            PRIVATE LitPoints* RESTRICT points) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int primitive = ints[at.hit * capacity + i + j];
      const vec3 o = LOAD3(f, capacity, at.origin_x, i + j), d = LOAD3(f, capacity, at.direction_x, i + j);
      store_lit_point(scene, surface_at(scene, primitive, o, d), primitive, o, d, points, j);
    }
}

/// Adds the closed form to the sums of the paths, through the throughput of those that have one.
STAGE void add_analytic(GLOBAL float* RESTRICT f, int capacity, int i, bool path,
                        const PRIVATE double* RESTRICT analytic) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 form =
          make_vec3((float)analytic[j], (float)analytic[LANES + j], (float)analytic[2 * LANES + j]);
      const vec3 throughput = LOAD3(f, capacity, THROUGHPUT_X, i + j);
      const vec3 more = path ? mul(throughput, form) : form;
      const vec3 sum = add(LOAD3(f, capacity, ANALYTIC_X, i + j), more);
      STORE3(f, capacity, ANALYTIC_X, i + j, sum);
    }
}

/// Surveys lights from the surfaces of LANES paths. A choice takes its number from that for the point on the
/// light, which it replaces by what is left of it.
STAGE void survey_lanes(const PRIVATE Scene* scene, AimWishes wishes, SurfaceFields at,
                        GLOBAL float* RESTRICT f, const GLOBAL int* RESTRICT ints, int capacity, int i,
                        PRIVATE float* RESTRICT u, PRIVATE float* RESTRICT aims,
                        PRIVATE double* RESTRICT projected) {
  LitPoints points;
  Drawing drawing;
  double analytic[3 * LANES];
  store_lit_points(scene, at, f, ints, capacity, i, &points);
  for (int j = 0; j < LANES; j++) start_drawing(&drawing, j, (double)u[DRAW_LIGHT_U * LANES + j]);
  const bool one_light = scene->polygons[0].light_count == scene->header.light_count;
  if (wishes.closed | !one_light)
    survey_lights(scene, &points, wishes.choice & !one_light, &drawing, analytic);
  if (one_light)
    for (int j = 0; j < LANES; j++) draw_from(&drawing, j, 0, points.polygon[j] == 0.0 ? 0.0 : 1.0);
  if (wishes.choice)
    choose_part(scene, &points, wishes.projected, &drawing, aims, projected, u + DRAW_LIGHT_U * LANES);
  if (wishes.closed) add_analytic(f, capacity, i, wishes.path, analytic);
}
#endif

#if HAS(PROJECTED)
/// The lights that are chosen by power, and their projected solid angles.
STAGE void project_by_power(const PRIVATE Scene* scene, SurfaceFields at, const GLOBAL float* RESTRICT f,
                            const GLOBAL int* RESTRICT ints, int capacity, int i,
                            const PRIVATE float* RESTRICT u, PRIVATE double* RESTRICT projected) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s =
          surface_at(scene, ints[at.hit * capacity + i + j], LOAD3(f, capacity, at.origin_x, i + j),
                     LOAD3(f, capacity, at.direction_x, i + j));
      const ChosenLight by_power =
          choose_light(scene, u[DRAW_LIGHT_U * LANES + j], u[DRAW_LIGHT_FINE * LANES + j]);
      GLOBAL const Light* light = scene->lights + by_power.light;
      const double e = light_irradiance(light, s.p.x, s.p.y, s.p.z, s.shading.x, s.shading.y, s.shading.z);
      projected[j] = is_own_light(scene, s, by_power.light) ? 0.0 : e;
    }
}

STAGE void aim_by_projection(const PRIVATE Scene* scene, SurfaceFields at, const GLOBAL float* RESTRICT f,
                             const GLOBAL int* RESTRICT ints, int capacity, int i,
                             const PRIVATE float* RESTRICT u, const PRIVATE double* RESTRICT projected,
                             PRIVATE float* RESTRICT aims) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s =
          surface_at(scene, ints[at.hit * capacity + i + j], LOAD3(f, capacity, at.origin_x, i + j),
                     LOAD3(f, capacity, at.direction_x, i + j));
      const float number = u[DRAW_LIGHT_U * LANES + j];
      const ChosenLight by_power = choose_light(scene, number, u[DRAW_LIGHT_FINE * LANES + j]);
      const float chosen = aims[AIM_LIGHT * LANES + j];
      const bool is_chosen = chosen >= 0.0f;
      aim_at_light(scene, s, is_chosen ? (int)chosen : by_power.light, (float)projected[j],
                   is_chosen ? number : by_power.u, u[DRAW_LIGHT_V * LANES + j], aims, j);
    }
}

/// The densities of what the last rays found, for multiple importance sampling.
STAGE void project_found(const PRIVATE Scene* scene, bool path, SurfaceFields at, GLOBAL float* RESTRICT f,
                         const GLOBAL int* RESTRICT ints, int capacity, int i, PRIVATE float* RESTRICT aims) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 from = LOAD3(f, capacity, RAY_ORIGIN_X, i + j);
      const vec3 toward = LOAD3(f, capacity, RAY_DIRECTION_X, i + j);
      const Surface found = surface_at(scene, ints[HIT * capacity + i + j], from, toward);
      const Surface s =
          surface_at(scene, ints[at.hit * capacity + i + j], LOAD3(f, capacity, at.origin_x, i + j),
                     LOAD3(f, capacity, at.direction_x, i + j));
      const vec3 kept = LOAD3(f, capacity, REFERENCE_NORMAL_X, i + j);
      aim_at_found(scene, found, from, toward, select3(path, kept, s.shading), aims, j);
      // A path's next ray leaves this surface; of a camera ray the same place holds its direction.
      const vec3 keep = select3(path, s.shading, kept);
      STORE3(f, capacity, REFERENCE_NORMAL_X, i + j, keep);
    }
}
#endif

/// The aims of LANES paths from lane i on; u holds a step's DRAWS * LANES numbers. A function of its own: its
/// branches would split the loops of the step.
STAGE void aim_lanes(const PRIVATE Scene* scene, AimWishes wishes, SurfaceFields at, GLOBAL float* RESTRICT f,
                     const GLOBAL int* RESTRICT ints, int capacity, int i, PRIVATE float* RESTRICT u,
                     PRIVATE float* RESTRICT aims) {
#if HAS_AIMS
  double projected[LANES];
  for (int j = 0; j < LANES; j++) store_aim(aims, j, no_aim());
#endif
#if HAS(POLYGONS)
  if (wishes.choice | wishes.closed)
    survey_lanes(scene, wishes, at, f, ints, capacity, i, u, aims, projected);
#endif
#if HAS(PROJECTED)
  if (wishes.found) project_found(scene, wishes.path, at, f, ints, capacity, i, aims);
  if (wishes.projected & !wishes.choice) project_by_power(scene, at, f, ints, capacity, i, u, projected);
  if (wishes.projected) aim_by_projection(scene, at, f, ints, capacity, i, u, projected, aims);
#endif
}

PENUMBRA_NAMESPACE_END
#endif
