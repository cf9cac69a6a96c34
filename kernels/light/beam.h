// What spot lights and projectors share: directions in the light's own frame, in which z is the middle of the
// beam, and the samples of a light at a point whose radiant intensity depends on them.
#ifndef PENUMBRA_BEAM_H
#define PENUMBRA_BEAM_H
#include "kernels/light/light_found.h"

PENUMBRA_NAMESPACE_BEGIN

/// Of a spot light or a projector; of another light some beam.
FN GLOBAL const Beam* beam_of(const PRIVATE Scene* scene, GLOBAL const Light* light) {
  const int index = light->beam;
  const bool has_beam = (index >= 0) & (index < scene->header.tables.beams.count);
  return scene->beams + (has_beam ? index : 0);
}

/// The light's point as seen by the receiver, and its texture coordinates for that direction.
FN LightPoint beam_point(GLOBAL const Light* light, GLOBAL const Beam* beam, vec3 wi) {
  LightPoint at = light_point(load3(&light->p0), negate(wi));
  const float z = -dot3(load3(&beam->z), wi), inverse = 1.0f / (z > 0.0f ? z : 1.0f);
  at.u = 0.5f - beam->u_by_x * dot3(load3(&beam->x), wi) * inverse;
  at.v = 0.5f - beam->v_by_y * dot3(load3(&beam->y), wi) * inverse;
  return at;
}

/// From a point: the light's sample but for its radiance. Nothing where the receiver is that point itself.
FN LightSample toward_delta_point(GLOBAL const Light* light, LightReceiver r, PRIVATE float* inverse_d2) {
  float d2;
  LightSample s = toward_point(r, load3(&light->p0), &d2);
  s.pdf = 1.0f;
  s.delta = true;
  *inverse_d2 = 1.0f / d2;
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
