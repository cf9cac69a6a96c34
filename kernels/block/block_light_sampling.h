// The light sampling stage, before an integrator's step of LANES paths and only where the scene asks for it:
// choice of a light by its contribution, closed forms, directions by projected solid angle.
#ifndef PENUMBRA_BLOCK_LIGHT_SAMPLING_H
#define PENUMBRA_BLOCK_LIGHT_SAMPLING_H
#include "kernels/light/light_choice.h"
#include "kernels/light/light_unshadowed.h"
#include "kernels/light/projected_light.h"
#include "kernels/sampler/sampler.h"

PENUMBRA_NAMESPACE_BEGIN

/// The fields in which a path keeps its shading point: the primitive, and the ray that hit it.
typedef struct {
  int hit, origin_x, direction_x;
} SurfaceFields;

/// What a step requests of the light sampling stage. A kernel may be compiled for more than its scene needs.
typedef struct {
  bool choice;     ///< a light, chosen by its contribution
  bool closed;     ///< the closed form, added to the path's sum
  bool projected;  ///< directions by projected solid angle
  bool found;      ///< their densities for the light that the last ray hit
  bool path;       ///< the surface is the last ray's hit, which left a surface with normal REFERENCE_NORMAL
} LightRequest;

FN bool uses_projected(const PRIVATE Scene* scene) {
  return (scene->header.features & FEATURE_PROJECTED) != 0u;
}

/// `emits`: the step samples a light. `first`: the step is the first one at its surface. `balances`: other
/// samples may hit lights too.
FN LightRequest light_request(const PRIVATE Scene* scene, bool path, bool emits, bool first, bool balances) {
  LightRequest request;
  request.path = path;
  request.choice = HAS(POLYGONS) && emits && scene->header.integrator.light_choice == CHOICE_ANALYTIC;
  request.closed = HAS(POLYGONS) && first && scene->header.integrator.estimator != ESTIMATOR_SAMPLES;
  request.projected = HAS(PROJECTED) && emits && uses_projected(scene);
  request.found = HAS(PROJECTED) && balances && uses_projected(scene);
  return request;
}

#if HAS(POLYGONS)
STAGE void store_shading_points(const PRIVATE Scene* scene, SurfaceFields at, const GLOBAL float* RESTRICT f,
                                const GLOBAL int* RESTRICT ints, int capacity, int i,
                                PRIVATE ShadingPoints* RESTRICT points) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int primitive = ints[at.hit * capacity + i + j];
      const vec3 o = LOAD3(f, capacity, at.origin_x, i + j), d = LOAD3(f, capacity, at.direction_x, i + j);
      store_shading_point(scene, surface_at(scene, primitive, o, d), primitive, o, d, points, j);
    }
}

/// Adds the closed form to the sums of the paths, times the throughput where the paths have one (`path`).
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

/// Unshadowed light at the surfaces of LANES paths: the closed form, and the choice of a light. The choice
/// shares its random number with the point on the light and replaces it by the remainder, which is uniform in
/// [0, 1) again.
STAGE void unshadowed_lanes(const PRIVATE Scene* scene, LightRequest request, SurfaceFields at,
                            GLOBAL float* RESTRICT f, const GLOBAL int* RESTRICT ints, int capacity, int i,
                            PRIVATE float* RESTRICT u, PRIVATE float* RESTRICT samplings,
                            PRIVATE double* RESTRICT projected) {
  ShadingPoints points;
  Reservoir reservoir;
  double analytic[3 * LANES];
  store_shading_points(scene, at, f, ints, capacity, i, &points);
  for (int j = 0; j < LANES; j++) start_reservoir(&reservoir, j, (double)u[DIM_LIGHT_U * LANES + j]);
  const bool one_light = scene->polygons[0].light_count == scene->header.tables.lights.count;
  if (request.closed | !one_light)
    unshadowed_lights(scene, &points, request.choice & !one_light, &reservoir, analytic);
  if (one_light)
    for (int j = 0; j < LANES; j++) add_to_reservoir(&reservoir, j, 0, points.polygon[j] == 0.0 ? 0.0 : 1.0);
  if (request.choice)
    choose_part(scene, &points, request.projected, &reservoir, samplings, projected, u + DIM_LIGHT_U * LANES);
  if (request.closed) add_analytic(f, capacity, i, request.path, analytic);
}
#endif

#if HAS(PROJECTED)
/// Projected solid angles of the lights that are chosen by power.
STAGE void project_by_power(const PRIVATE Scene* scene, SurfaceFields at, const GLOBAL float* RESTRICT f,
                            const GLOBAL int* RESTRICT ints, int capacity, int i,
                            const PRIVATE float* RESTRICT u, PRIVATE double* RESTRICT projected) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s =
          surface_at(scene, ints[at.hit * capacity + i + j], LOAD3(f, capacity, at.origin_x, i + j),
                     LOAD3(f, capacity, at.direction_x, i + j));
      const ChosenLight by_power =
          choose_light(scene, u[DIM_LIGHT_U * LANES + j], u[DIM_LIGHT_FINE * LANES + j]);
      GLOBAL const Light* light = scene->lights + by_power.light;
      const double e = light_irradiance(light, s.p.x, s.p.y, s.p.z, s.shading.x, s.shading.y, s.shading.z);
      projected[j] = is_own_light(scene, s, by_power.light) ? 0.0 : e;
    }
}

/// Samples directions by projected solid angle to the lights that were chosen.
STAGE void sample_projected_lights(const PRIVATE Scene* scene, SurfaceFields at,
                                   const GLOBAL float* RESTRICT f, const GLOBAL int* RESTRICT ints,
                                   int capacity, int i, const PRIVATE float* RESTRICT u,
                                   const PRIVATE double* RESTRICT projected,
                                   PRIVATE float* RESTRICT samplings) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s =
          surface_at(scene, ints[at.hit * capacity + i + j], LOAD3(f, capacity, at.origin_x, i + j),
                     LOAD3(f, capacity, at.direction_x, i + j));
      const float number = u[DIM_LIGHT_U * LANES + j];
      const ChosenLight by_power = choose_light(scene, number, u[DIM_LIGHT_FINE * LANES + j]);
      const float chosen = samplings[LIGHT_SAMPLING_LIGHT * LANES + j];
      const bool is_chosen = chosen >= 0.0f;
      sample_projected_light(scene, s, is_chosen ? (int)chosen : by_power.light, (float)projected[j],
                             is_chosen ? number : by_power.u, u[DIM_LIGHT_V * LANES + j], samplings, j);
    }
}

/// Densities for the lights that the last rays hit, for multiple importance sampling.
STAGE void project_found(const PRIVATE Scene* scene, bool path, SurfaceFields at, GLOBAL float* RESTRICT f,
                         const GLOBAL int* RESTRICT ints, int capacity, int i,
                         PRIVATE float* RESTRICT samplings) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 from = LOAD3(f, capacity, RAY_ORIGIN_X, i + j);
      const vec3 toward = LOAD3(f, capacity, RAY_DIRECTION_X, i + j);
      const Surface found = surface_at(scene, ints[HIT * capacity + i + j], from, toward);
      const Surface s =
          surface_at(scene, ints[at.hit * capacity + i + j], LOAD3(f, capacity, at.origin_x, i + j),
                     LOAD3(f, capacity, at.direction_x, i + j));
      const vec3 kept = LOAD3(f, capacity, REFERENCE_NORMAL_X, i + j);
      projected_density_of_found(scene, found, from, toward, select3(path, kept, s.shading), samplings, j);
      // A path's next ray leaves this surface. Without `path` the field holds the camera ray's direction.
      const vec3 keep = select3(path, s.shading, kept);
      STORE3(f, capacity, REFERENCE_NORMAL_X, i + j, keep);
    }
}
#endif

/// Light samplings of LANES paths from lane i on; u holds a step's STEP_DIMENSIONS * LANES numbers. It is a
/// function of its own because its branches would split the loops of the step.
STAGE void sample_light_lanes(const PRIVATE Scene* scene, LightRequest request, SurfaceFields at,
                              GLOBAL float* RESTRICT f, const GLOBAL int* RESTRICT ints, int capacity, int i,
                              PRIVATE float* RESTRICT u, PRIVATE float* RESTRICT samplings) {
#if HAS_LIGHT_SAMPLING
  double projected[LANES];
  for (int j = 0; j < LANES; j++) store_light_sampling(samplings, j, no_light_sampling());
#endif
#if HAS(POLYGONS)
  if (request.choice | request.closed)
    unshadowed_lanes(scene, request, at, f, ints, capacity, i, u, samplings, projected);
#endif
#if HAS(PROJECTED)
  if (request.found) project_found(scene, request.path, at, f, ints, capacity, i, samplings);
  if (request.projected & !request.choice) project_by_power(scene, at, f, ints, capacity, i, u, projected);
  if (request.projected) sample_projected_lights(scene, at, f, ints, capacity, i, u, projected, samplings);
#endif
}

PENUMBRA_NAMESPACE_END
#endif
