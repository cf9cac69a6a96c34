// Sampling of lights by projected solid angle, as part of the light sampling stage.
#ifndef PENUMBRA_PROJECTED_LIGHT_H
#define PENUMBRA_PROJECTED_LIGHT_H
#include "kernels/light/light_found.h"
#include "kernels/light/light_sample.h"
#include "kernels/light/projected_triangle.h"
#include "kernels/math/frame.h"
#include "kernels/polygon/polygon_light.h"

PENUMBRA_NAMESPACE_BEGIN

/// Irradiance from a triangle light per unit of its radiance, which equals its projected solid angle, in
/// double; 0 for other kinds.
FN double light_irradiance(Light light, double x, double y, double z, double nx, double ny, double nz) {
  const double e =
      triangle_irradiance(x, y, z, nx, ny, nz, light.p0, light.p1, light.p2, light.two_sided != 0);
  return light.kind == LIGHT_TRIANGLE ? e : 0.0;
}

/// The light projected onto the hemisphere about `n` at `from`. It is sampled by projected solid angle if the
/// result's `area` is above 0; light_irradiance computes that area more precisely.
FN ProjectedPolygon project_light(Light light, vec3 from, vec3 n) {
  const vec3 p0 = sub(light.p0, from), p1 = sub(light.p1, from);
  const vec3 p2 = sub(light.p2, from);
  const bool behind = (light.two_sided != 0) & (dot3(cross3(sub(p1, p0), sub(p2, p0)), p0) > 0.0f);
  ProjectedPolygon polygon = project_triangle(to_frame(n, p0), to_frame(n, select3(behind, p2, p1)),
                                              to_frame(n, select3(behind, p1, p2)));
  const bool projected = (light.kind == LIGHT_TRIANGLE) & (light.sampling == EMITTER_PROJECTED);
  polygon.area = projected ? polygon.area : 0.0f;
  return polygon;
}

/// Pdf, by projected solid angle, of the direction in which a ray hit `light` from a point with shading
/// normal `n`; negative: the light is not sampled that way.
FN float projected_density(Light light, FoundLight found, vec3 n) {
  const ProjectedPolygon polygon = project_light(light, found.from, n);
  const float area = (float)light_irradiance(light, found.from.x, found.from.y, found.from.z, n.x, n.y, n.z);
  const bool some = (found.light >= 0) & (polygon.area > 0.0f) & (area > 0.0f);
  const float cosine = max_f(dot3(n, found.wi), 0.0f);
  return some ? cosine / (some ? area : 1.0f) : -1.0f;
}

/// Samples a direction from the receiver to the light by (u, v). `area` is its light_irradiance. Receivers
/// without a normal get no direction.
FN void sample_projected_light(Light light, LightReceiver r, float area, float u, float v,
                               PRIVATE LightSamplings* samplings, int j) {
  const ProjectedPolygon polygon = project_light(light, r.p, r.shading);
  const bool some = r.has_normal & (polygon.area > 0.0f) & (area > 0.0f);
  const vec3 w = sample_projected_polygon(polygon, u, v);
  const vec3 wi = from_frame(r.shading, w.x, w.y, w.z);
  STORE_LANE_vec3(samplings->wi, j, wi);
  samplings->scale[j] = some ? 1.0f / (some ? area : 1.0f) : -1.0f;
}

PENUMBRA_NAMESPACE_END
#endif
