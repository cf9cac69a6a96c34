// Spot lights with a radius: a sphere (p2.x) of which every point seen in a direction has the same radiance,
// that which makes the radiant intensity in this direction that of the spot light without a radius. Nothing
// is lit inside the sphere. Only samples of the light find it, by the cone that it subtends.
#ifndef PENUMBRA_ROUND_SPOT_LIGHT_H
#define PENUMBRA_ROUND_SPOT_LIGHT_H
#include "kernels/light/delta_lights.h"
#include "kernels/light/sphere_light.h"

PENUMBRA_NAMESPACE_BEGIN

FN LightSample sample_round_spot_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                       LightReceiver r, float u, float v, LightSampling sampling,
                                       ulong strategies) {
  const SampledPoint point = sample_sphere_point(scene, index, light, axes, r, u, v, 0u);
  LightSample s = toward_light(light, r, point);
  const Beam beam = beam_along(scene, index, axes);
  const LightPoint at = beam_point(light, beam, s.wi);
  // The solid angle of the cone over the section of the sphere.
  const vec3 way = sub(light.p0, r.p);
  const float d2 = dot3(way, way), r2 = sqr(light.p2.x);
  const bool outside = d2 > r2;
  const float over = 2.0f / (outside ? d2 * (1.0f + safe_sqrt(1.0f - r2 / d2)) : 1.0f);
  s.radiance = scale(spot_intensity(light, beam, at, s.wi), outside ? over : 0.0f);
  s.pdf = 1.0f;
  s.delta = true;
  s.tmax = max_component(s.radiance) > 0.0f ? s.tmax : -1.0f;
  return at_place(s, at);
}

NO_RAY_FINDS_BEAM(round_spot)

PENUMBRA_NAMESPACE_END
#endif
