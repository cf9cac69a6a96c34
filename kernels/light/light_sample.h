// The result of sampling a light, and what all kinds of lights make it with.
#ifndef PENUMBRA_LIGHT_SAMPLE_H
#define PENUMBRA_LIGHT_SAMPLE_H
#include "kernels/light/light_receiver.h"

PENUMBRA_NAMESPACE_BEGIN

// A shadow ray ends this much before the light.
#define SHADOW_RAY_END (1.0f - 64.0f * HALF_EPSILON)

// clang-format off
#define LIGHT_SAMPLE_FIELDS(F, a)                                                                                 \
  F(a, vec3, origin)     /* where the shadow ray starts */                                                        \
  F(a, vec3, toward)     /* unit, its direction */                                                                \
  F(a, vec3, wi)         /* unit, direction of the light: the same but for the offset of the origin, which counts \
                            near a light */                                                                       \
  F(a, float, tmax)      /* of the shadow ray; negative: no contribution possible */                              \
  F(a, float, pdf)       /* per solid angle, the choice of the light included; of a delta light the choice's */   \
  F(a, bool, delta)      /* a light of one point or direction: no other strategy finds it */                                          \
  F(a, bool, of_polygon) /* a part of a polygon light, whose closed form is known */                              \
  F(a, vec3, radiance)   /* arriving along wi if nothing is in the way, the inverse square law included */        \
  F(a, int, light)       /* index of the light */
// clang-format on
// Where on the light it is, for scenes with FEATURE_LIGHT_TEXTURES. Elsewhere lanes hold nothing here.
#define LIGHT_SAMPLE_PLACE_FIELDS(F, a)          \
  F(a, vec3, place)                              \
  F(a, float, place_u) /* texture coordinates */ \
  F(a, float, place_v)
#define LIGHT_SAMPLE_ALL_FIELDS(F, a) LIGHT_SAMPLE_FIELDS(F, a) LIGHT_SAMPLE_PLACE_FIELDS(F, a)
LANE_RECORD(LightSample, LightSamples, light_sample, LIGHT_SAMPLE_ALL_FIELDS)
LANE_RECORD_PART(LightSample, LightSamples, light_sample_direction, LIGHT_SAMPLE_FIELDS)
LANE_RECORD_PART(LightSample, LightSamples, light_sample_place, LIGHT_SAMPLE_PLACE_FIELDS)

/// Of a light that gives nothing.
FN LightSample no_light_sample(void) {
  LightSample s;
  s.origin = s.radiance = make_vec3(0.0f, 0.0f, 0.0f);
  s.toward = s.wi = make_vec3(0.0f, 0.0f, 1.0f);
  s.tmax = -1.0f;
  s.pdf = 0.0f;
  s.delta = s.of_polygon = false;
  s.light = 0;
  s.place = s.origin;
  s.place_u = s.place_v = 0.0f;
  return s;
}

/// A point of a light. What it emits may depend on where it is: on its place on the light as well.
typedef struct {
  vec3 p;
  vec3 normal;  ///< unit, of the side that shines
  float u, v;   ///< as of a surface there (FEATURE_UV); 0 if the light is none
} LightPoint;

FN LightPoint light_point(vec3 p, vec3 normal) {
  LightPoint at;
  at.p = p;
  at.normal = normal;
  at.u = at.v = 0.0f;
  return at;
}

/// A point of a light's surface as it is sampled.
typedef struct {
  LightPoint at;
  float spread;  ///< how far it may be off the light, in units of POSITION_ERROR
  float pdf;     ///< per solid angle; 0 for points that are uniform by area
} SampledPoint;

/// Whether a scene's lights are sampled in this way, of `strategies`, a constant.
#define BY(strategies, name) (HAS(name) && ((strategies)&FEATURE_##name) != 0)

/// The sample of a light that is there, with the place on it.
FN LightSample at_place(LightSample s, LightPoint at) {
  s.place = at.p;
  s.place_u = at.u;
  s.place_v = at.v;
  return s;
}

/// Density per solid angle of a point at distance^2 `d2`, seen under `cosine` at the light, chosen uniformly
/// by area.
FN float area_to_solid_angle(float d2, float cosine, float area) {
  return cosine > 0.0f ? d2 / (cosine * area) : 0.0f;
}

/// The sample of a light at infinity in the unit direction. Density and radiance are up to the caller.
FN LightSample toward_infinity(LightReceiver r, vec3 wi) {
  LightSample s = no_light_sample();
  s.wi = s.toward = wi;
  s.origin = leave_surface(r.p, r.geometric, r.error, wi);
  s.tmax = NO_LIMIT;
  return s;
}

/// The shadow ray from the receiver to a point, and distance^2 of it from the ray's origin. Density and
/// radiance are up to the caller.
FN LightSample toward_point(LightReceiver r, vec3 target, PRIVATE float* d2) {
  LightSample s = no_light_sample();
  s.origin = leave_surface(r.p, r.geometric, r.error, sub(target, r.p));
  const vec3 way = sub(target, s.origin);
  *d2 = dot3(way, way);
  const float distance = SQRT(*d2);
  s.toward = s.wi = scale(way, 1.0f / max_f(distance, 1e-30f));
  s.tmax = distance > 0.0f ? distance * SHADOW_RAY_END : -1.0f;
  return s;
}

/// The same to a point of a light's surface, with its density.
FN LightSample toward_light(GLOBAL const Light* light, LightReceiver r, SampledPoint point) {
  const LightPoint at = point.at;
  // At most half the way to the point's side: one that is closer to the light than its position's error would
  // look the wrong way.
  const vec3 back = sub(r.p, at.p);
  const float error = min_f(POSITION_ERROR * point.spread, 0.5f * FABS(dot3(back, at.normal)));
  float d2;
  LightSample s = toward_point(r, leave_surface(at.p, at.normal, error, back), &d2);
  const float cosine_front = -dot3(s.wi, at.normal);
  const float cosine = light->two_sided ? FABS(cosine_front) : cosine_front;
  s.pdf = point.pdf > 0.0f ? point.pdf : area_to_solid_angle(d2, cosine, light->area);
  s.tmax = cosine > 0.0f ? s.tmax : -1.0f;
  return at_place(s, at);
}

/// The sample of a light that is a point, but for its radiance, which is intensity times `inverse_d2`.
/// Nothing where the receiver is that point itself.
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
