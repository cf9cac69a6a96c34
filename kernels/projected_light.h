// Directions to lights by projected solid angle, as a part of the stage that aims.
#ifndef PENUMBRA_PROJECTED_LIGHT_H
#define PENUMBRA_PROJECTED_LIGHT_H
#include "kernels/frame.h"
#include "kernels/light_aim.h"
#include "kernels/polygon_light.h"
#include "kernels/projected_triangle.h"
#include "kernels/surface.h"

PENUMBRA_NAMESPACE_BEGIN

#if HAS(PROJECTED)
/// The light as directions about `n` at `from`; its area is the closed form in double. 0: it is not sampled
/// by projected solid angle.
FN ProjectedPolygon project_light(GLOBAL const Light* light, vec3 from, vec3 n) {
  const vec3 at0 = load3(&light->p0), at1 = load3(&light->p1), at2 = load3(&light->p2);
  const vec3 p0 = sub(at0, from), p1 = sub(at1, from), p2 = sub(at2, from);
  const bool two_sided = light->two_sided != 0;
  const bool behind = two_sided & (dot3(cross3(sub(p1, p0), sub(p2, p0)), p0) > 0.0f);
  ProjectedPolygon polygon = project_triangle(to_frame(n, p0), to_frame(n, select3(behind, p2, p1)),
                                              to_frame(n, select3(behind, p1, p2)));
  const float area =
      (float)triangle_irradiance(from.x, from.y, from.z, n.x, n.y, n.z, at0, at1, at2, two_sided);
  const bool projected = (light->kind == LIGHT_TRIANGLE) & (light->sampling == EMITTER_PROJECTED);
  polygon.area = (projected & (polygon.area > 0.0f)) ? area : 0.0f;
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

/// For the light of that index to light the surface.
FN void aim_at_light(const PRIVATE Scene* scene, Surface s, int light, float u, float v, PRIVATE float* aims,
                     int j) {
  const ProjectedPolygon polygon = project_light(scene->lights + light, s.p, s.shading);
  const bool some = polygon.area > 0.0f;
  const vec3 w = sample_projected_polygon(polygon, u, v);
  const vec3 wi = from_frame(s.shading, w.x, w.y, w.z);
  aims[AIM_X * LANES + j] = wi.x;
  aims[AIM_Y * LANES + j] = wi.y;
  aims[AIM_Z * LANES + j] = wi.z;
  aims[AIM_SCALE * LANES + j] = some ? 1.0f / (some ? polygon.area : 1.0f) : -1.0f;
}
#endif

PENUMBRA_NAMESPACE_END
#endif
