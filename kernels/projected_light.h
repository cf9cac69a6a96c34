// Lights by their projected solid angle, as a stage of its own before a step: many times the arithmetic of
// the other ways, which scenes that do not ask for it shall not carry through their steps.
#ifndef PENUMBRA_PROJECTED_LIGHT_H
#define PENUMBRA_PROJECTED_LIGHT_H
#include "kernels/frame.h"
#include "kernels/light_choice.h"
#include "kernels/projected_triangle.h"
#include "kernels/surface.h"

PENUMBRA_NAMESPACE_BEGIN

/// What the stage leaves for a lane's step. Densities leave out the choice of the light, and are negative
/// where the light is not sampled by projected solid angle.
typedef struct {
  float found_pdf;  ///< density with which the last ray's direction would have been chosen
  vec3 wi;          ///< towards the light that the step is to choose
  float scale;      ///< the density of wi is its cosine times this
} Aim;

enum { AIM_FOUND_PDF, AIM_X, AIM_Y, AIM_Z, AIM_SCALE, AIM_COUNT };
// Floats of a PRIVATE array of Aims, value V of lane j at V * LANES + j.
#define AIM_FLOATS (HAS(PROJECTED) ? AIM_COUNT * LANES : 1)

FN Aim no_aim(void) {
  Aim aim;
  aim.found_pdf = aim.scale = -1.0f;
  aim.wi = make_vec3(0.0f, 0.0f, 1.0f);
  return aim;
}

#if HAS(PROJECTED)
/// A kernel may be compiled for more than its scene.
FN bool wants_aims(const PRIVATE Scene* scene) { return (scene->header.features & FEATURE_PROJECTED) != 0u; }

FN void store_no_aim(PRIVATE float* aims, int j) {
  aims[AIM_FOUND_PDF * LANES + j] = -1.0f;
  aims[AIM_X * LANES + j] = 0.0f;
  aims[AIM_Y * LANES + j] = 0.0f;
  aims[AIM_Z * LANES + j] = 1.0f;
  aims[AIM_SCALE * LANES + j] = -1.0f;
}

FN ProjectedPolygon project_light(GLOBAL const Light* light, vec3 from, vec3 n) {
  const vec3 p0 = sub(load3(&light->p0), from), p1 = sub(load3(&light->p1), from);
  const vec3 p2 = sub(load3(&light->p2), from);
  ProjectedPolygon polygon = project_triangle(to_frame(n, p0), to_frame(n, p1), to_frame(n, p2));
  polygon.area = light->kind == LIGHT_TRIANGLE ? polygon.area : 0.0f;
  return polygon;
}

/// For the surface that a ray found, which left `from` in `direction`; the shading normal there was `n`.
FN void aim_at_found(const PRIVATE Scene* scene, Surface found, vec3 from, vec3 direction, vec3 n,
                     PRIVATE float* aims, int j) {
  const ProjectedPolygon polygon =
      project_light(scene->lights + (found.light >= 0 ? found.light : 0), from, n);
  const bool some = polygon.area > 0.0f;
  const float cosine = max_f(dot3(n, direction), 0.0f);
  aims[AIM_FOUND_PDF * LANES + j] = some ? cosine / (some ? polygon.area : 1.0f) : -1.0f;
}

/// For the light that `choice` chooses to light the surface.
FN void aim_at_chosen(const PRIVATE Scene* scene, Surface s, float choice, float u, float v,
                      PRIVATE float* aims, int j) {
  const ProjectedPolygon polygon = project_light(scene->lights + choose_light(scene, choice), s.p, s.shading);
  const bool some = polygon.area > 0.0f;
  const vec3 w = sample_projected_polygon(polygon, u, v);
  const vec3 wi = from_frame(s.shading, w.x, w.y, w.z);
  aims[AIM_X * LANES + j] = wi.x;
  aims[AIM_Y * LANES + j] = wi.y;
  aims[AIM_Z * LANES + j] = wi.z;
  aims[AIM_SCALE * LANES + j] = some ? 1.0f / (some ? polygon.area : 1.0f) : -1.0f;
}
#endif

/// Lane j's; none where the kernel is compiled without.
FN Aim load_aim(const PRIVATE float* aims, int j) {
#if HAS(PROJECTED)
  Aim aim;
  aim.found_pdf = aims[AIM_FOUND_PDF * LANES + j];
  aim.wi = make_vec3(aims[AIM_X * LANES + j], aims[AIM_Y * LANES + j], aims[AIM_Z * LANES + j]);
  aim.scale = aims[AIM_SCALE * LANES + j];
  return aim;
#else
  return no_aim();
#endif
}

PENUMBRA_NAMESPACE_END
#endif
