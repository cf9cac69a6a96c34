// Functions that several kinds of lights share; `name` is that of LIGHT_KINDS.
#ifndef PENUMBRA_KIND_FUNCTIONS_H
#define PENUMBRA_KIND_FUNCTIONS_H
#include "kernels/light/light_found.h"

PENUMBRA_NAMESPACE_BEGIN

// Defines <name>_light_radiance for a light that emits the same from all points into all directions, except
// for its texture: radiance; radiant intensity of a point light; irradiance of a directional light.
#define LIGHT_EMITS_UNIFORMLY(name)                                                                \
  FN vec3 name##_light_radiance(const PRIVATE Scene* scene, Light light, LightPoint at, vec3 wi) { \
    return light.radiance;                                                                         \
  }

// Defines sample_<name>_light for a light with a surface, by sample_<name>_point.
#define SAMPLE_LIGHT_BY_POINT(name)                                                                        \
  FN LightSample sample_##name##_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes, \
                                       LightReceiver r, float u, float v, LightSampling sampling,          \
                                       ulong strategies) {                                                 \
    const SampledPoint point = sample_##name##_point(scene, index, light, axes, r, u, v, strategies);      \
    LightSample s = toward_light(light, r, point);                                                         \
    s.radiance = name##_light_radiance(scene, light, point.at, s.wi);                                      \
    return s;                                                                                              \
  }

// Defines <name>_light_pdf for a light that is sampled uniformly by area.
#define FIND_LIGHT_BY_AREA(name)                                                                           \
  FN float name##_light_pdf(const PRIVATE Scene* scene, Light light, FoundLight found, ulong strategies) { \
    return area_to_solid_angle(sqr(found.distance), found.cosine, light.area);                             \
  }

PENUMBRA_NAMESPACE_END
#endif
