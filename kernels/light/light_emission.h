// Photons leave lights: rays whose origin and direction are sampled in proportion to the emitted power, as
// far as a light's kind allows. Each kind has emit_<name>_light, here by the numbers of two pairs: (u, v)
// samples the point, (s, t) the direction.
//
// The result is a LightSample. `origin` and `toward` are the ray's; `radiance` is the power over the density
// of the ray, so that the mean over all numbers is the light's power; `tmax` is negative if there is no ray.
#ifndef PENUMBRA_LIGHT_EMISSION_H
#define PENUMBRA_LIGHT_EMISSION_H
#include "kernels/light/light.h"

PENUMBRA_NAMESPACE_BEGIN

FN LightSample emitted_ray(LightPoint at, vec3 origin, vec3 direction, vec3 power) {
  LightSample s = no_light_sample();
  s.origin = origin;
  s.toward = direction;
  s.wi = negate(direction);
  s.radiance = power;
  s.pdf = 1.0f;
  s.tmax = max_component(power) > 0.0f ? NO_LIMIT : -1.0f;
  return at_place(s, at);
}

/// A receiver for which points on the light are uniform by area: none subtends a cone or a solid angle there.
FN LightReceiver receiver_at_light(Light light) { return receiver_of(surface_in_medium(light.p0)); }

/// A cosine-weighted ray from a point on a light's surface that is uniform by area.
FN LightSample emit_from_surface(Light light, SampledPoint point, vec3 radiance, float s, float t) {
  const bool two_sided = light.two_sided != 0, back = two_sided & (s >= 0.5f);
  const float along = min_f(two_sided ? 2.0f * s - (back ? 1.0f : 0.0f) : s, ONE_MINUS_EPSILON);
  const vec3 normal = scale(point.at.normal, back ? -1.0f : 1.0f);
  const vec3 direction = sample_cosine_hemisphere(normal, along, t);
  const vec3 origin = leave_surface(point.at.p, normal, POSITION_ERROR * point.spread, direction);
  return emitted_ray(point.at, origin, direction,
                     scale(radiance, PI_F * light.area * (two_sided ? 2.0f : 1.0f)));
}

// The strategies of sampling points that depend on a receiver are left out.
#define POINT_STRATEGIES(strategies) ((strategies) & ~(FEATURE_SOLID_ANGLE | FEATURE_PROJECTED))

#define EMIT_LIGHT_BY_POINT(name, ...)                                                                     \
  FN LightSample emit_##name##_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,   \
                                     float u, float v, float s, float t, LightSampling sampling,           \
                                     ulong strategies) {                                                   \
    const SampledPoint point =                                                                             \
        sample_##name##_point(scene, index, light, __VA_ARGS__ POINT_STRATEGIES(strategies));              \
    return emit_from_surface(light, point, name##_light_radiance(scene, light, point.at, point.at.normal), \
                             s, t);                                                                        \
  }
#define AND ,
EMIT_LIGHT_BY_POINT(triangle, receiver_at_light(light) AND u AND v AND sampling AND)
EMIT_LIGHT_BY_POINT(rectangle, axes AND receiver_at_light(light) AND u AND v AND)
EMIT_LIGHT_BY_POINT(sphere, axes AND receiver_at_light(light) AND u AND v AND)
EMIT_LIGHT_BY_POINT(disk, axes AND receiver_at_light(light) AND u AND v AND)
EMIT_LIGHT_BY_POINT(cylinder, axes AND receiver_at_light(light) AND u AND v AND)
#undef AND
#undef EMIT_LIGHT_BY_POINT

/// A ray of light from infinity, of `irradiance` perpendicular to it, through a disk that hides the scene.
FN LightSample emit_from_infinity(const PRIVATE Scene* scene, vec3 direction, vec3 irradiance, float u,
                                  float v) {
  const float radius = scene->header.integrator.emission_radius, r = radius * SQRT(u);
  float sine, cosine;
  sincos_2pi(v, &sine, &cosine);
  const vec3 origin = from_frame(direction, r * cosine, r * sine, -radius);
  return emitted_ray(light_point(origin, direction), origin, direction,
                     scale(irradiance, PI_F * sqr(radius)));
}

FN LightSample emit_directional_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                      float u, float v, float s, float t, LightSampling sampling,
                                      ulong strategies) {
  return emit_from_infinity(scene, light.p1, light.radiance, s, t);
}

FN LightSample emit_sun_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes, float u,
                              float v, float s, float t, LightSampling sampling, ulong strategies) {
  return emit_from_infinity(scene, negate(toward_sun(light, u, v)),
                            scale(light.radiance, sun_solid_angle(light)), s, t);
}

#define EMIT_ENVIRONMENT(name)                                                                           \
  FN LightSample emit_##name##_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes, \
                                     float u, float v, float s, float t, LightSampling sampling,         \
                                     ulong strategies) {                                                 \
    const LightReceiver centre = receiver_of(surface_in_medium(make_vec3(0.0f, 0.0f, 0.0f)));            \
    const LightSample seen =                                                                             \
        sample_##name##_light(scene, index, light, axes, centre, u, v, sampling, strategies);            \
    const float inverse = seen.pdf > 0.0f ? 1.0f / seen.pdf : 0.0f;                                      \
    return emit_from_infinity(scene, negate(seen.wi), scale(seen.radiance, inverse), s, t);              \
  }
EMIT_ENVIRONMENT(environment)
EMIT_ENVIRONMENT(envmap)
#undef EMIT_ENVIRONMENT

/// A ray from a point light; `intensity` over the density of `direction` per solid angle.
FN LightSample emit_from_point(Light light, LightPoint at, vec3 direction, vec3 power) {
  return emitted_ray(at, light.p0, direction, power);
}

FN LightSample emit_point_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes, float u,
                                float v, float s, float t, LightSampling sampling, ulong strategies) {
  const vec3 direction = sample_uniform_sphere(s, t);
  return emit_from_point(light, light_point(light.p0, direction), direction,
                         scale(light.radiance, 4.0f * PI_F));
}

/// A direction uniform in the cone beyond which a spot light is dark, whose solid angle it sets.
FN vec3 sample_beam_cone(Beam beam, float s, float t, PRIVATE float* solid_angle) {
  float half_sine, half_cosine, sine, cosine;
  sincos_2pi(min_f(beam.cutoff, PI_F) * (0.25f * INV_PI_F), &half_sine, &half_cosine);
  const float widest = beam.falloff == SPOT_LINEAR ? 2.0f * sqr(half_sine) : min_f(beam.cutoff, 2.0f);
  const float versine = s * widest, across = safe_sqrt(versine * (2.0f - versine));
  sincos_2pi(t, &sine, &cosine);
  *solid_angle = 2.0f * PI_F * widest;
  return add_scaled(add(scale(beam.x, across * cosine), scale(beam.y, across * sine)), 1.0f - versine,
                    beam.z);
}

FN LightSample emit_spot_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes, float u,
                               float v, float s, float t, LightSampling sampling, ulong strategies) {
  const Beam beam = beam_along(scene, index, axes);
  float solid_angle;
  const vec3 direction = sample_beam_cone(beam, s, t, &solid_angle);
  const LightPoint at = beam_point(light, beam, negate(direction));
  const vec3 intensity = spot_intensity(light, beam, at, negate(direction));
  return emit_from_point(light, at, direction, scale(intensity, solid_angle));
}

/// From the half of the sphere that is seen from that direction, uniform over its section.
FN LightSample emit_round_spot_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                     float u, float v, float s, float t, LightSampling sampling,
                                     ulong strategies) {
  LightSample ray = emit_spot_light(scene, index, light, axes, u, v, s, t, sampling, strategies);
  const float radius = light.p2.x, r = SQRT(u);
  float sine, cosine;
  sincos_2pi(v, &sine, &cosine);
  const vec3 outward = from_frame(ray.toward, r * cosine, r * sine, safe_sqrt(1.0f - u));
  ray.origin = add_scaled(ray.origin, radius, outward);
  return ray;
}

/// Uniform over the image of a projector on a plane, of which its radiance is a share.
FN LightSample emit_projector_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                    float u, float v, float s, float t, LightSampling sampling,
                                    ulong strategies) {
  const Beam beam = beam_along(scene, index, axes);
  const float by_x = FABS(beam.u_by_x), by_y = FABS(beam.v_by_y);
  const float width = by_x > 0.0f ? 1.0f / by_x : 0.0f, height = by_y > 0.0f ? 1.0f / by_y : 0.0f;
  const vec3 onto = add_scaled(add_scaled(beam.z, (s - 0.5f) * width, beam.x), (t - 0.5f) * height, beam.y);
  const vec3 direction = normalize3(onto);
  return emit_from_point(light, beam_point(light, beam, negate(direction)), direction,
                         scale(light.radiance, PI_F * width * height));
}

/// No photons: what they light has its light from media by rays alone.
FN LightSample emit_medium_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes, float u,
                                 float v, float s, float t, LightSampling sampling, ulong strategies) {
  return no_light_sample();
}

// For each kind of light, the lanes that chose it.
#define EMIT_LANES(name, NAME, number, strategies, description)                                            \
  STAGE void emit_##name##_lights(                                                                         \
      const PRIVATE Scene* scene, const PRIVATE ChosenLights* RESTRICT chosen,                             \
      const PRIVATE PlacedLights* RESTRICT places, const PRIVATE float* RESTRICT v,                        \
      const PRIVATE float* RESTRICT s, const PRIVATE float* RESTRICT t,                                    \
      const PRIVATE LightSamplings* RESTRICT samplings, bool first, PRIVATE LightSamples* RESTRICT rays) { \
    LANE_LOOP                                                                                              \
      for (int j = 0; j < LANES; j++) {                                                                    \
        const LaneLight choice = load_chosen_light(chosen, j);                                             \
        LightSample ray =                                                                                  \
            emit_##name##_light(scene, choice.light, PLACED_LIGHT(choice.light),                           \
                                PLACED_AXES(choice.light, LIGHT_##NAME), choice.u, v[j], s[j], t[j],       \
                                load_light_sampling(samplings, j), COMPILED_FEATURES & (strategies));      \
        ray.radiance = scale(ray.radiance, 1.0f / (choice.pmf > 0.0f ? choice.pmf : 1.0f));                \
        keep_light_sample(choice, LIGHT_##NAME, ray, first, COMPILED_FEATURES&(strategies), rays, j);      \
      }                                                                                                    \
  }
LIGHT_KINDS(EMIT_LANES)
#undef EMIT_LANES

/// LANES rays from lights at `time`, 0 to 1. `number` and `fine` choose the light, see choose_light; the
/// remainder of `number` and `v` sample the point, or the direction from which an environment shines; `s` and
/// `t` the rest.
CALLED_FN void emit_rays(const PRIVATE Scene* scene, float time, const PRIVATE float* number,
                         const PRIVATE float* v, const PRIVATE float* fine, const PRIVATE float* s,
                         const PRIVATE float* t, PRIVATE LightSamples* rays) {
  Surfaces nowhere;
  ChosenLights chosen;
  LightSamplings samplings;
  PlacedLights places;
  float of_grid[LANES], times[LANES];
  for (int j = 0; j < LANES; j++) {
    store_surface(&nowhere, j, surface_in_medium(make_vec3(0.0f, 0.0f, 0.0f)));
    times[j] = time;
  }
  clear_light_samplings(&samplings);
  const uint among = choose_lane_lights(scene, &nowhere, number, v, fine, &samplings, &chosen, of_grid);
  if (NEEDS(scene, LIGHT_TEXTURES)) v = of_grid;
  place_lights(scene, chosen.light, times, &places.places);
  place_light_axes(scene, chosen.light, times, &places.axes);
  bool first = true;
#define EMIT_KIND(name, NAME, number, strategies, description)                       \
  if (HAS_LIGHT_OF(number) && (among >> (number)&1u) != 0u) {                        \
    emit_##name##_lights(scene, &chosen, &places, v, s, t, &samplings, first, rays); \
    first = false;                                                                   \
  }
  LIGHT_KINDS(EMIT_KIND)
#undef EMIT_KIND
  if (first) sample_no_lights(rays);
  if (NEEDS(scene, LIGHT_TEXTURES)) texture_light_samples(scene, times, rays);
  if (NEEDS(scene, SPREAD)) spread_light_samples(scene, &places.places, rays);
}

PENUMBRA_NAMESPACE_END
#endif
