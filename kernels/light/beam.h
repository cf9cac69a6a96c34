// What spot lights and projectors share: the light's own frame, whose z axis is the centre of the beam, and
// samples of a point light whose radiant intensity depends on the direction.
#ifndef PENUMBRA_BEAM_H
#define PENUMBRA_BEAM_H
#include "kernels/light/kind_functions.h"

PENUMBRA_NAMESPACE_BEGIN

/// The beam of a spot light or projector; of other lights an arbitrary one.
FN GLOBAL const Beam* beam_of(const PRIVATE Scene* scene, GLOBAL const Light* light) {
  const int index = light->beam;
  const bool has_beam = (index >= 0) & (index < scene->header.tables.beams.count);
  return scene->beams + (has_beam ? index : 0);
}

/// The light's position as seen in direction wi from the receiver, with its texture coordinates for that
/// direction.
FN LightPoint beam_point(GLOBAL const Light* light, GLOBAL const Beam* beam, vec3 wi) {
  LightPoint at = light_point(load3(&light->p0), negate(wi));
  const float z = -dot3(load3(&beam->z), wi), inverse = 1.0f / (z > 0.0f ? z : 1.0f);
  at.u = 0.5f - beam->u_by_x * dot3(load3(&beam->x), wi) * inverse;
  at.v = 0.5f - beam->v_by_y * dot3(load3(&beam->y), wi) * inverse;
  return at;
}

// Defines sample_<name>_light for a light with a beam.
#define SAMPLE_LIGHT_BY_BEAM(name)                                                                      \
  FN LightSample sample_##name##_light(const PRIVATE Scene* scene, int index, LightReceiver r, float u, \
                                       float v, LightSampling sampling, ulong strategies) {             \
    GLOBAL const Light* light = scene->lights + index;                                                  \
    float inverse_d2;                                                                                   \
    LightSample s = toward_delta_point(light, r, &inverse_d2);                                          \
    const LightPoint at = beam_point(light, beam_of(scene, light), s.wi);                               \
    s.radiance = scale(name##_light_radiance(scene, light, at, s.wi), inverse_d2);                      \
    s.tmax = max_component(s.radiance) > 0.0f ? s.tmax : -1.0f;                                         \
    return at_place(s, at);                                                                             \
  }

PENUMBRA_NAMESPACE_END
#endif
