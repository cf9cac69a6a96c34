// The stage before a step that looks at lights from the surfaces of LANES paths, where the scene asks for it:
// choice of a light by its contribution, closed forms, directions by projected solid angle.
#ifndef PENUMBRA_BLOCK_AIM_H
#define PENUMBRA_BLOCK_AIM_H
#include "kernels/light_choice.h"
#include "kernels/light_survey.h"
#include "kernels/projected_light.h"
#include "kernels/sampler.h"

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
  bool path;       ///< the surface is the last ray's hit, which left a surface with normal REFERENCE_NORMAL
} AimWishes;

FN bool wants_projected(const PRIVATE Scene* scene) {
  return (scene->header.features & FEATURE_PROJECTED) != 0u;
}

/// `emits`: the step samples a light. `first`: the surface was not there at the step before.
FN AimWishes aim_wishes(const PRIVATE Scene* scene, bool path, bool emits, bool first) {
  AimWishes w;
  w.path = path;
  w.choice = HAS(POLYGONS) && emits && scene->header.light_choice == CHOICE_ANALYTIC;
  w.closed = HAS(POLYGONS) && first && scene->header.estimator != ESTIMATOR_SAMPLES;
  w.projected = HAS(PROJECTED) && wants_projected(scene);
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

STAGE void survey_lanes(const PRIVATE Scene* scene, AimWishes wishes, SurfaceFields at,
                        GLOBAL float* RESTRICT f, const GLOBAL int* RESTRICT ints, int capacity, int i,
                        const PRIVATE float* RESTRICT u, PRIVATE float* RESTRICT aims) {
  LitPoints points;
  Drawing drawing;
  double analytic[3 * LANES];
  store_lit_points(scene, at, f, ints, capacity, i, &points);
  for (int j = 0; j < LANES; j++) start_drawing(&drawing, j, (double)u[DRAW_LIGHT_CHOICE * LANES + j]);
  survey_lights(scene, &points, wishes.choice, &drawing, analytic);
  if (wishes.choice) choose_part(scene, &points, &drawing, aims);
  if (wishes.closed) add_analytic(f, capacity, i, wishes.path, analytic);
}
#endif

#if HAS(PROJECTED)
STAGE void aim_by_projection(const PRIVATE Scene* scene, AimWishes wishes, SurfaceFields at,
                             GLOBAL float* RESTRICT f, const GLOBAL int* RESTRICT ints, int capacity, int i,
                             const PRIVATE float* RESTRICT u, PRIVATE float* RESTRICT aims) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 from = LOAD3(f, capacity, RAY_ORIGIN_X, i + j);
      const vec3 toward = LOAD3(f, capacity, RAY_DIRECTION_X, i + j);
      const Surface found = surface_at(scene, ints[HIT * capacity + i + j], from, toward);
      const Surface s =
          surface_at(scene, ints[at.hit * capacity + i + j], LOAD3(f, capacity, at.origin_x, i + j),
                     LOAD3(f, capacity, at.direction_x, i + j));
      const vec3 kept = LOAD3(f, capacity, REFERENCE_NORMAL_X, i + j);
      aim_at_found(scene, found, from, toward, select3(wishes.path, kept, s.shading), aims, j);
      const int by_power = choose_light(scene, u[DRAW_LIGHT_CHOICE * LANES + j]);
      const float chosen = aims[AIM_LIGHT * LANES + j];
      aim_at_light(scene, s, chosen >= 0.0f ? (int)chosen : by_power, u[DRAW_LIGHT_U * LANES + j],
                   u[DRAW_LIGHT_V * LANES + j], aims, j);
      // A path's next ray leaves this surface; of a camera ray the same place holds its direction.
      const vec3 keep = select3(wishes.path, s.shading, kept);
      STORE3(f, capacity, REFERENCE_NORMAL_X, i + j, keep);
    }
}
#endif

/// The aims of LANES paths from lane i on; u holds a step's DRAWS * LANES numbers.
FN void aim_lanes(const PRIVATE Scene* scene, AimWishes wishes, SurfaceFields at, GLOBAL float* RESTRICT f,
                  const GLOBAL int* RESTRICT ints, int capacity, int i, const PRIVATE float* RESTRICT u,
                  PRIVATE float* RESTRICT aims) {
#if HAS_AIMS
  for (int j = 0; j < LANES; j++) store_aim(aims, j, no_aim());
#endif
#if HAS(POLYGONS)
  if (wishes.choice | wishes.closed) survey_lanes(scene, wishes, at, f, ints, capacity, i, u, aims);
#endif
#if HAS(PROJECTED)
  if (wishes.projected) aim_by_projection(scene, wishes, at, f, ints, capacity, i, u, aims);
#endif
}

PENUMBRA_NAMESPACE_END
#endif
