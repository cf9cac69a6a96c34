// The result of sampling a light, and what all kinds of lights make it with.
#ifndef PENUMBRA_LIGHT_SAMPLE_H
#define PENUMBRA_LIGHT_SAMPLE_H
#include "kernels/light/light_receiver.h"

PENUMBRA_NAMESPACE_BEGIN

// A shadow ray ends this much before the light.
#define SHADOW_RAY_END (1.0f - 64.0f * HALF_EPSILON)

typedef struct {
  vec3 origin;  ///< where the shadow ray starts
  vec3 toward;  ///< unit, its direction
  vec3 wi;  ///< unit, direction of the light: the same but for the offset of the origin, which counts near a
            ///< light
  float tmax;  ///< of the shadow ray; negative: no contribution possible
  float pdf;   ///< per solid angle, the choice of the light included; for a point light of the choice alone
  bool delta;  ///< a point light: no other strategy finds it
  bool of_polygon;  ///< a part of a polygon light, whose closed form is known
  vec3 radiance;  ///< arriving along wi if nothing is in the way, a point light's inverse square law included
  int light;      ///< index of the light
} LightSample;

/// One a lane; coordinate c of lane j at c * LANES + j.
typedef struct {
  float origin[3 * LANES], toward[3 * LANES], wi[3 * LANES], tmax[LANES], pdf[LANES], radiance[3 * LANES];
  int delta[LANES], of_polygon[LANES], light[LANES];
} LightSamples;

FN LightSample load_light_sample(const PRIVATE LightSamples* samples, int j) {
  LightSample s;
  s.origin = LOAD3(samples->origin, LANES, 0, j);
  s.toward = LOAD3(samples->toward, LANES, 0, j);
  s.wi = LOAD3(samples->wi, LANES, 0, j);
  s.tmax = samples->tmax[j];
  s.pdf = samples->pdf[j];
  s.delta = samples->delta[j] != 0;
  s.of_polygon = samples->of_polygon[j] != 0;
  s.radiance = LOAD3(samples->radiance, LANES, 0, j);
  s.light = samples->light[j];
  return s;
}

FN void store_light_sample(PRIVATE LightSamples* samples, int j, LightSample s) {
  STORE3(samples->origin, LANES, 0, j, s.origin);
  STORE3(samples->toward, LANES, 0, j, s.toward);
  STORE3(samples->wi, LANES, 0, j, s.wi);
  samples->tmax[j] = s.tmax;
  samples->pdf[j] = s.pdf;
  samples->delta[j] = s.delta ? 1 : 0;
  samples->of_polygon[j] = s.of_polygon ? 1 : 0;
  STORE3(samples->radiance, LANES, 0, j, s.radiance);
  samples->light[j] = s.light;
}

/// Of a light that gives nothing.
FN LightSample no_light_sample(void) {
  LightSample s;
  s.origin = s.radiance = make_vec3(0.0f, 0.0f, 0.0f);
  s.toward = s.wi = make_vec3(0.0f, 0.0f, 1.0f);
  s.tmax = -1.0f;
  s.pdf = 0.0f;
  s.delta = s.of_polygon = false;
  s.light = 0;
  return s;
}

/// A point of a light. What it emits may depend on where it is: on its place on the light as well.
typedef struct {
  vec3 p;
  vec3 normal;  ///< unit, of the side that shines
} LightPoint;

/// Whether a scene's lights are sampled in this way, of `ways`, a constant.
#define BY(ways, name) (HAS(name) && ((ways)&FEATURE_##name) != 0u)

/// Density per solid angle of a point at distance^2 `d2`, seen under `cosine` at the light, chosen uniformly
/// by area.
FN float area_to_solid_angle(float d2, float cosine, float area) {
  return cosine > 0.0f ? d2 / (cosine * area) : 0.0f;
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

/// The same to a point of a light's surface, with its density. `spread`: how far the point may be off the
/// light, in units of POSITION_ERROR. `direct_pdf`: per solid angle; 0 for points that are uniform by area.
FN LightSample toward_light(GLOBAL const Light* light, LightReceiver r, LightPoint at, float spread,
                            float direct_pdf) {
  // At most half the way to the point's side: one that is closer to the light than its position's error would
  // look the wrong way.
  const vec3 back = sub(r.p, at.p);
  const float error = min_f(POSITION_ERROR * spread, 0.5f * FABS(dot3(back, at.normal)));
  float d2;
  LightSample s = toward_point(r, leave_surface(at.p, at.normal, error, back), &d2);
  const float cosine_front = -dot3(s.wi, at.normal);
  const float cosine = light->two_sided ? FABS(cosine_front) : cosine_front;
  s.pdf = direct_pdf > 0.0f ? direct_pdf : area_to_solid_angle(d2, cosine, light->area);
  s.tmax = cosine > 0.0f ? s.tmax : -1.0f;
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
