// The result of sampling a light, functions that all kinds of lights use to make it, and the light sampling
// stage that precedes it.
#ifndef PENUMBRA_LIGHT_SAMPLE_H
#define PENUMBRA_LIGHT_SAMPLE_H
#include "kernels/light/light_receiver.h"
#include "kernels/light/moving_light.h"

PENUMBRA_NAMESPACE_BEGIN

// A shadow ray ends slightly before the light.
#define SHADOW_RAY_END (1.0f - 64.0f * HALF_EPSILON)

// clang-format off
#define LIGHT_SAMPLE_FIELDS(F, a)                                                                         \
  F(a, vec3, origin)     /* start of the shadow ray */                                                    \
  F(a, vec3, toward)     /* unit, direction of the shadow ray */                                          \
  F(a, vec3, wi)         /* unit, direction to the light, without the offset of the origin */             \
  F(a, float, tmax)      /* length of the shadow ray; negative: no contribution */                        \
  F(a, float, pdf)       /* per solid angle, times that of choosing the light; delta light: the latter */ \
  F(a, bool, delta)      /* a delta or unseen light: no other strategy samples it */                      \
  F(a, bool, of_polygon) /* part of a polygon light, which has a closed form */                           \
  F(a, vec3, radiance)   /* arriving along wi if unoccluded, including the inverse square law */          \
  F(a, int, light)       /* index of the light */
// clang-format on
// The position on the light, with FEATURE_LIGHT_TEXTURES only. Otherwise lanes do not store these fields.
#define LIGHT_SAMPLE_PLACE_FIELDS(F, a)          \
  F(a, vec3, place)                              \
  F(a, float, place_u) /* texture coordinates */ \
  F(a, float, place_v)
#define LIGHT_SAMPLE_ALL_FIELDS(F, a) LIGHT_SAMPLE_FIELDS(F, a) LIGHT_SAMPLE_PLACE_FIELDS(F, a)
LANE_RECORD(LightSample, LightSamples, light_sample, LIGHT_SAMPLE_ALL_FIELDS)
LANE_RECORD_PART(LightSample, LightSamples, light_sample_direction, LIGHT_SAMPLE_FIELDS)
LANE_RECORD_PART(LightSample, LightSamples, light_sample_place, LIGHT_SAMPLE_PLACE_FIELDS)

/// A sample without contribution.
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

/// A point on a light, on which its emission may depend.
typedef struct {
  vec3 p;
  vec3 normal;  ///< unit, of the side that emits
  float u, v;   ///< texture coordinates of the surface there (FEATURE_UV), or 0 if the light is no surface
} LightPoint;

FN LightPoint light_point(vec3 p, vec3 normal) {
  LightPoint at;
  at.p = p;
  at.normal = normal;
  at.u = at.v = 0.0f;
  return at;
}

/// A sampled point on the surface of a light.
typedef struct {
  LightPoint at;
  float spread;  ///< bound of its distance from the surface, in units of POSITION_ERROR
  float pdf;     ///< per solid angle; 0: the point is uniform by area
} SampledPoint;

/// Sets the position on the light.
FN LightSample at_place(LightSample s, LightPoint at) {
  s.place = at.p;
  s.place_u = at.u;
  s.place_v = at.v;
  return s;
}

/// Converts uniform sampling by area to a pdf per solid angle: squared distance `d2`, `cosine` at the light.
FN float area_to_solid_angle(float d2, float cosine, float area) {
  return cosine > 0.0f ? d2 / (cosine * area) : 0.0f;
}

/// The sample of a light at infinity in direction wi (unit). The caller sets pdf and radiance.
FN LightSample toward_infinity(LightReceiver r, vec3 wi) {
  LightSample s = no_light_sample();
  s.wi = s.toward = wi;
  s.origin = leave_surface(r.p, r.geometric, r.error, wi);
  s.tmax = NO_LIMIT;
  return s;
}

/// The shadow ray from the receiver to a point, and its squared length. The caller sets pdf and radiance.
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

/// The same to a point on a light's surface; sets the pdf.
FN LightSample toward_light(Light light, LightReceiver r, SampledPoint point) {
  const LightPoint at = point.at;
  // The offset is at most half of the receiver's distance to the light's plane: a receiver closer to the
  // light than the position's error would otherwise see the wrong side.
  const vec3 back = sub(r.p, at.p);
  const float error = min_f(POSITION_ERROR * point.spread, 0.5f * FABS(dot3(back, at.normal)));
  float d2;
  LightSample s = toward_point(r, leave_surface(at.p, at.normal, error, back), &d2);
  const float cosine_front = -dot3(s.wi, at.normal);
  const float cosine = light.two_sided ? FABS(cosine_front) : cosine_front;
  s.pdf = point.pdf > 0.0f ? point.pdf : area_to_solid_angle(d2, cosine, light.area);
  s.delta = light.unseen == UNSEEN_BY_RAYS;
  s.tmax = cosine > 0.0f ? s.tmax : -1.0f;
  return at_place(s, at);
}

/// The sample of a point light. The caller sets the radiance: intensity times `inverse_d2`. No contribution
/// if the receiver is at the light itself.
FN LightSample toward_delta_point(Light light, LightReceiver r, PRIVATE float* inverse_d2) {
  float d2;
  LightSample s = toward_point(r, light.p0, &d2);
  s.pdf = 1.0f;
  s.delta = true;
  *inverse_d2 = 1.0f / d2;
  return s;
}

// The result of the light sampling stage, which precedes an integrator's step. The stage is separate because
// it costs many times as much arithmetic as the step; scenes that do not need it skip it.

// The part of a light sample that the stage decides. Pdfs by projected solid angle do not include the
// probability of choosing the light.
#define LIGHT_SAMPLING_FIELDS(F, a)                                                              \
  F(a, int, light)   /* index of the light to sample; negative: the step chooses one by power */ \
  F(a, float, pmf)   /* probability of choosing the light */                                     \
  F(a, vec3, wi)     /* direction towards the light */                                           \
  F(a, float, scale) /* pdf of wi over its cosine; negative: the step samples a point */         \
  /* For an environment map, once its cell is chosen: */                                         \
  F(a, int, column)                                                                              \
  F(a, int, row)                                                                                 \
  F(a, float, between) /* position between that row and the next */
LANE_RECORD(LightSampling, LightSamplings, light_sampling, LIGHT_SAMPLING_FIELDS)

FN LightSampling no_light_sampling(void) {
  LightSampling sampling;
  sampling.scale = -1.0f;
  sampling.light = -1;
  sampling.pmf = 0.0f;
  sampling.wi = make_vec3(0.0f, 0.0f, 1.0f);
  sampling.column = sampling.row = 0;
  sampling.between = 0.0f;
  return sampling;
}

STAGE void clear_light_samplings(PRIVATE LightSamplings* RESTRICT samplings) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) store_light_sampling(samplings, j, no_light_sampling());
}

PENUMBRA_NAMESPACE_END
#endif
