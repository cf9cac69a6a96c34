// Sampling lights by projected solid angle: a part of the light sampling stage.
#ifndef PENUMBRA_PROJECTED_LIGHT_H
#define PENUMBRA_PROJECTED_LIGHT_H
#include "kernels/light/light_receiver.h"
#include "kernels/light/light_sampling.h"
#include "kernels/light/projected_triangle.h"
#include "kernels/math/frame.h"
#include "kernels/polygon/polygon_light.h"

PENUMBRA_NAMESPACE_BEGIN

#if HAS_LIGHT_SAMPLING
/// Irradiance from a triangle light per unit of its radiance, which is its projected solid angle, in double;
/// 0 for other kinds.
FN double light_irradiance(GLOBAL const Light* light, double x, double y, double z, double nx, double ny,
                           double nz) {
  const double e = triangle_irradiance(x, y, z, nx, ny, nz, load3(&light->p0), load3(&light->p1),
                                       load3(&light->p2), light->two_sided != 0);
  return light->kind == LIGHT_TRIANGLE ? e : 0.0;
}
#endif

#if HAS(PROJECTED)
/// The light projected onto the hemisphere about `n` at `from`. It is sampled by projected solid angle if the
/// `area` of the result is above 0; light_irradiance gives that area more precisely.
FN ProjectedPolygon project_light(GLOBAL const Light* light, vec3 from, vec3 n) {
  const vec3 p0 = sub(load3(&light->p0), from), p1 = sub(load3(&light->p1), from);
  const vec3 p2 = sub(load3(&light->p2), from);
  const bool behind = (light->two_sided != 0) & (dot3(cross3(sub(p1, p0), sub(p2, p0)), p0) > 0.0f);
  ProjectedPolygon polygon = project_triangle(to_frame(n, p0), to_frame(n, select3(behind, p2, p1)),
                                              to_frame(n, select3(behind, p1, p2)));
  const bool projected = (light->kind == LIGHT_TRIANGLE) & (light->sampling == EMITTER_PROJECTED);
  polygon.area = projected ? polygon.area : 0.0f;
  return polygon;
}

/// Stores the density with which sampling by projected solid angle chooses the direction in which a ray found
/// the light of that index, or -1, from a point with shading normal `n`.
FN void projected_density_of_found(const PRIVATE Scene* scene, int index, vec3 from, vec3 direction, vec3 n,
                                   PRIVATE float* samplings, int j) {
  GLOBAL const Light* light = scene->lights + (index >= 0 ? index : 0);
  const ProjectedPolygon polygon = project_light(light, from, n);
  const float area = (float)light_irradiance(light, from.x, from.y, from.z, n.x, n.y, n.z);
  const bool some = (index >= 0) & (polygon.area > 0.0f) & (area > 0.0f);
  const float cosine = max_f(dot3(n, direction), 0.0f);
  samplings[LIGHT_SAMPLING_FOUND_PDF * LANES + j] = some ? cosine / (some ? area : 1.0f) : -1.0f;
}

/// Samples a direction from the receiver to the light of that index by (u, v). `area` is its
/// light_irradiance. Without a normal there is none.
FN void sample_projected_light(const PRIVATE Scene* scene, LightReceiver r, int light, float area, float u,
                               float v, PRIVATE float* samplings, int j) {
  const ProjectedPolygon polygon = project_light(scene->lights + light, r.p, r.shading);
  const bool some = r.has_normal & (polygon.area > 0.0f) & (area > 0.0f);
  const vec3 w = sample_projected_polygon(polygon, u, v);
  const vec3 wi = from_frame(r.shading, w.x, w.y, w.z);
  samplings[LIGHT_SAMPLING_X * LANES + j] = wi.x;
  samplings[LIGHT_SAMPLING_Y * LANES + j] = wi.y;
  samplings[LIGHT_SAMPLING_Z * LANES + j] = wi.z;
  samplings[LIGHT_SAMPLING_SCALE * LANES + j] = some ? 1.0f / (some ? area : 1.0f) : -1.0f;
}
#endif

PENUMBRA_NAMESPACE_END
#endif
