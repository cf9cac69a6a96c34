// Lights that rays never hit: point, directional and spot lights, and projectors.
#ifndef PENUMBRA_DELTA_LIGHTS_H
#define PENUMBRA_DELTA_LIGHTS_H
#include "kernels/light/kind_functions.h"

PENUMBRA_NAMESPACE_BEGIN

// Defines <name>_light_pdf for a light that rays never hit.
#define NO_RAY_FINDS_LIGHT(name)                                                                           \
  FN float name##_light_pdf(const PRIVATE Scene* scene, Light light, FoundLight found, ulong strategies) { \
    return 0.0f;                                                                                           \
  }
// The same, and a radiance, for a light with a beam, whose samples use <name>_intensity.
#define NO_RAY_FINDS_BEAM(name)                                                                    \
  NO_RAY_FINDS_LIGHT(name)                                                                         \
  FN vec3 name##_light_radiance(const PRIVATE Scene* scene, Light light, LightPoint at, vec3 wi) { \
    return make_vec3(0.0f, 0.0f, 0.0f);                                                            \
  }

// Point lights.

/// Radiant intensity.
LIGHT_EMITS_UNIFORMLY(point)

FN LightSample sample_point_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                  LightReceiver r, float u, float v, LightSampling sampling,
                                  ulong strategies) {
  float inverse_d2;
  LightSample s = toward_delta_point(light, r, &inverse_d2);
  const LightPoint at = light_point(light.p0, negate(s.wi));
  s.radiance = scale(point_light_radiance(scene, light, at, s.wi), inverse_d2);
  return s;
}

NO_RAY_FINDS_LIGHT(point)

// Directional lights: irradiance perpendicular to one direction, from infinity.

/// Irradiance on a surface perpendicular to the direction.
LIGHT_EMITS_UNIFORMLY(directional)

FN LightSample sample_directional_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                        LightReceiver r, float u, float v, LightSampling sampling,
                                        ulong strategies) {
  LightSample s = toward_infinity(r, negate(light.p1));
  s.pdf = 1.0f;
  s.delta = true;
  s.radiance = directional_light_radiance(scene, light, light_point(s.origin, negate(s.wi)), s.wi);
  return s;
}

NO_RAY_FINDS_LIGHT(directional)

// What spot lights and projectors share: the light's own frame, whose z axis is the centre of the beam, and
// samples of a point light whose radiant intensity depends on the direction.

/// The light's position as seen in direction wi from the receiver, with its texture coordinates for that
/// direction.
FN LightPoint beam_point(Light light, Beam beam, vec3 wi) {
  LightPoint at = light_point(light.p0, negate(wi));
  const float z = -dot3(beam.z, wi), inverse = 1.0f / (z > 0.0f ? z : 1.0f);
  at.u = 0.5f - beam.u_by_x * dot3(beam.x, wi) * inverse;
  at.v = 0.5f - beam.v_by_y * dot3(beam.y, wi) * inverse;
  return at;
}

/// The beam of light `index`, with those axes.
FN Beam beam_along(const PRIVATE Scene* scene, int index, LightAxes axes) {
  Beam beam = load_beam(beam_of(scene, index));
  beam.x = axes.x;
  beam.y = axes.y;
  beam.z = axes.z;
  return beam;
}

// Defines sample_<name>_light for a light with a beam.
#define SAMPLE_LIGHT_BY_BEAM(name)                                                                         \
  FN LightSample sample_##name##_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes, \
                                       LightReceiver r, float u, float v, LightSampling sampling,          \
                                       ulong strategies) {                                                 \
    float inverse_d2;                                                                                      \
    LightSample s = toward_delta_point(light, r, &inverse_d2);                                             \
    const Beam beam = beam_along(scene, index, axes);                                                      \
    const LightPoint at = beam_point(light, beam, s.wi);                                                   \
    s.radiance = scale(name##_intensity(light, beam, at, s.wi), inverse_d2);                               \
    s.tmax = max_component(s.radiance) > 0.0f ? s.tmax : -1.0f;                                            \
    return at_place(s, at);                                                                                \
  }

// Spot lights: the radiant intensity falls off between two angles to an axis, linearly in the angle
// (Mitsuba), or as a cubic (pbrt) or quadratic (glTF) function of the cosine. A texture may multiply it.

/// The fraction of the intensity that is emitted in the unit direction w. Angles are computed from sines, and
/// 1 - cosine from squared sines, so that narrow beams keep their digits.
FN float spot_falloff(Beam beam, vec3 w) {
  const float x = dot3(beam.x, w), y = dot3(beam.y, w), z = dot3(beam.z, w);
  const float sine2 = sqr(x) + sqr(y);
  const float versine = z > 0.0f ? sine2 / (1.0f + z) : 1.0f - z;
  const int falloff = beam.falloff;
  const float off = falloff == SPOT_LINEAR ? atan2_f(SQRT(sine2), z) : versine;
  const float t = clamp_f((beam.cutoff - off) * beam.inverse_width, 0.0f, 1.0f);
  const float fallen =
      falloff == SPOT_LINEAR ? t : sqr(t) * (falloff == SPOT_SQUARED ? 1.0f : 3.0f - 2.0f * t);
  return off <= beam.beam_width ? 1.0f : fallen;
}

/// Radiant intensity without the texture.
FN vec3 spot_intensity(Light light, Beam beam, LightPoint at, vec3 wi) {
  return scale(light.radiance, spot_falloff(beam, negate(wi)));
}

SAMPLE_LIGHT_BY_BEAM(spot)

NO_RAY_FINDS_BEAM(spot)

// Projectors: an image in focus at every distance (Mitsuba 3). `radiance` times the texture is the irradiance
// over pi on a plane at distance 1 perpendicular to the beam.

/// Radiant intensity without the texture. A point of that plane is at distance 1 / cos and sees the light
/// under that cosine, hence 1 / cos^3.
FN vec3 projector_intensity(Light light, Beam beam, LightPoint at, vec3 wi) {
  const float cosine = -dot3(beam.z, wi);
  const bool within = (cosine > 0.0f) & (at.u >= 0.0f) & (at.u <= 1.0f) & (at.v >= 0.0f) & (at.v <= 1.0f);
  const float divisor = within ? cosine * sqr(cosine) : 1.0f;
  return scale(light.radiance, within ? PI_F / divisor : 0.0f);
}

SAMPLE_LIGHT_BY_BEAM(projector)

NO_RAY_FINDS_BEAM(projector)

PENUMBRA_NAMESPACE_END
#endif
