// Direct light with n_g emitter samples and n_f direction samples for each camera ray, in steps: step k
// traces the k-th direction and asks for the k-th shadow ray, all from the surface that the camera ray hit.
#ifndef PENUMBRA_INTEGRATOR_DIRECT_H
#define PENUMBRA_INTEGRATOR_DIRECT_H
#include "kernels/block/shadow_ray.h"
#include "kernels/bsdf/bsdf.h"
#include "kernels/light/light.h"
#include "kernels/light/mis.h"
#include "kernels/sampler/sampler.h"

PENUMBRA_NAMESPACE_BEGIN

/// Density of the scene's way of choosing directions about the surface's shading normal.
FN float direction_pdf(int kind, vec3 n, vec3 wi, float bsdf_pdf) {
  const float cosine = max_f(dot3(n, wi), 0.0f);
  const float pdf = kind == DIRECTION_COSINE ? cosine * INV_PI_F : (cosine > 0.0f ? 0.5f * INV_PI_F : 0.0f);
  return kind == DIRECTION_BSDF ? bsdf_pdf : pdf;
}

/// Keeps lane i's camera ray and its hit, before the first step.
FN void keep_camera_ray(GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints, int capacity, int i) {
  const vec3 origin = LOAD3(f, capacity, RAY_ORIGIN_X, i), direction = LOAD3(f, capacity, RAY_DIRECTION_X, i);
  STORE3(f, capacity, CAMERA_ORIGIN_X, i, origin);
  STORE3(f, capacity, CAMERA_DIRECTION_X, i, direction);
  ints[CAMERA_HIT * capacity + i] = ints[HIT * capacity + i];
}

/// Adds what lane i's camera ray found, where no other sample finds emitters.
FN void see_emitter(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, int capacity, int i,
                    Emission emission) {
  const float seen = scene->header.hide_emitters != HIDE_NOTHING ? 0.0f : 1.0f;
  const vec3 sum = add(LOAD3(f, capacity, RADIANCE_X, i), scale(emission.radiance, seen));
  STORE3(f, capacity, RADIANCE_X, i, sum);
}

/// Adds what lane i's last ray found: at first the camera's, then one of the direction samples'.
FN void weigh_emitter(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                      int capacity, int i, Emission emission) {
  const bool first = ints[RAY_SKIP * capacity + i] < 0;  // a camera ray starts on no primitive
  const vec3 throughput = LOAD3(f, capacity, THROUGHPUT_X, i);
  const float by_direction = (float)scene->header.bsdf_samples * f[DIRECTION_PDF * capacity + i];
  const float by_emitter = (float)scene->header.emitter_samples * emission.pdf;
  const float share = mis_weight(scene->header.heuristic, by_direction, by_emitter);
  const float seen = scene->header.hide_emitters != HIDE_NOTHING ? 0.0f : 1.0f;
  const bool traced = f[RAY_TMAX * capacity + i] > 0.0f;
  const float weight = first ? seen : (traced ? share : 0.0f);
  const vec3 before = LOAD3(f, capacity, RADIANCE_X, i);
  const vec3 sum = add(before, mul(throughput, scale(emission.radiance, weight)));
  STORE3(f, capacity, RADIANCE_X, i, sum);
}

/// Lane i's emitter sample: `light`, for the surface that its camera ray hit.
FN void sample_emitter(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                       int capacity, int i, Surface s, LightSample light) {
  const int emitter_samples = scene->header.emitter_samples, bsdf_samples = scene->header.bsdf_samples;
  const int primitive = ints[CAMERA_HIT * capacity + i];
  const BsdfValue value = eval_bsdf(scene->materials + s.material, s.shading, s.wo, light.wi);
  const float other = direction_pdf(scene->header.bsdf_sampling, s.shading, light.wi, value.pdf);
  const float by_emitter = (float)emitter_samples * light.pdf, by_direction = (float)bsdf_samples * other;
  const float share = light.delta ? 1.0f : mis_weight(scene->header.heuristic, by_emitter, by_direction);
  const float weight = share / ((float)emitter_samples * (light.pdf > 0.0f ? light.pdf : 1.0f));
  const bool lit = s.valid & (light.tmax > 0.0f) & (value.pdf > 0.0f);
  const vec3 arriving = scale(mul(value.f_cos, light.radiance), weight);
  ask_for_shadow_ray(scene, f, ints, capacity, i, s, light, arriving, lit, primitive);
}

/// Lane i's direction sample by u, which holds STEP_DIMENSIONS * LANES numbers, those of lane i at j: its
/// next ray, from the surface that its camera ray hit.
FN void sample_direction(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                         int capacity, int i, const PRIVATE float* u, int j, Surface s) {
  const int kind = scene->header.bsdf_sampling;
  const int primitive = ints[CAMERA_HIT * capacity + i];
  GLOBAL const Material* material = scene->materials + s.material;
  const float du = u[DIM_BSDF_U * LANES + j], dv = u[DIM_BSDF_V * LANES + j];
  const BsdfSample by_bsdf = sample_bsdf(material, s.shading, s.wo, du, dv, u[DIM_LOBE_CHOICE * LANES + j]);
  const vec3 by_cosine = sample_cosine_hemisphere(s.shading, du, dv);
  const vec3 by_area = sample_uniform_hemisphere(s.shading, du, dv);
  const vec3 wi =
      select3(kind == DIRECTION_BSDF, by_bsdf.wi, select3(kind == DIRECTION_COSINE, by_cosine, by_area));
  const BsdfValue next = eval_bsdf(material, s.shading, s.wo, wi);
  const float pdf = direction_pdf(kind, s.shading, wi, next.pdf);
  const bool traces = s.valid & (pdf > 0.0f) & (next.pdf > 0.0f) & !is_beneath(s, wi);
  const vec3 by_quotient = scale(next.f_cos, 1.0f / (pdf > 0.0f ? pdf : 1.0f));
  const vec3 weight = scale(select3(kind == DIRECTION_BSDF, by_bsdf.weight, by_quotient),
                            1.0f / (float)scene->header.bsdf_samples);
  const vec3 origin = leave_surface(s.p, s.geometric, s.error, wi);
  STORE3(f, capacity, RAY_ORIGIN_X, i, origin);
  STORE3(f, capacity, RAY_DIRECTION_X, i, wi);
  STORE3(f, capacity, THROUGHPUT_X, i, weight);
  f[RAY_TMAX * capacity + i] = traces ? NO_LIMIT : -1.0f;
  f[DIRECTION_PDF * capacity + i] = pdf;
  ints[RAY_SKIP * capacity + i] = primitive;
}

/// Before a step's samples ask for rays: none, and lane i goes on if a step is left and there is a surface.
FN void begin_step(GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints, int capacity, bool is_last, int i) {
  f[RAY_TMAX * capacity + i] = -1.0f;
  f[SHADOW_TMAX * capacity + i] = -1.0f;
  ints[ALIVE * capacity + i] = ((ints[CAMERA_HIT * capacity + i] >= 0) & !is_last) ? 1 : 0;
}

PENUMBRA_NAMESPACE_END
#endif
