// Phase functions: mixtures of PHASE_LOBES lobes, which depend on the angle between the directions before and
// after. A closure of this family scatters a path inside a medium, not at a surface. Its values are pdfs, so
// sampled directions have weight 1.
#ifndef PENUMBRA_PHASE_H
#define PENUMBRA_PHASE_H
#include "kernels/bsdf/families.h"
#include "kernels/math/frame.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// Henyey and Greenstein 1941, per solid angle: (1 - g^2) / (4 pi (1 + g^2 - 2 g mu)^(3/2)). `versine` is 1 -
/// mu for g >= 0, else 1 + mu: near the peak of |g| near 1 the cosine has no digits left.
FN float henyey_greenstein(float g, float versine) {
  const float m = FABS(g), rest = 1.0f - m;
  const float square = sqr(rest) + 2.0f * m * versine;
  return rest * (1.0f + m) * (0.25f * INV_PI_F) / (square * SQRT(square));
}

/// Samples a direction by it about the unit vector `forward`. The distribution function is inverted (Pharr,
/// Jakob and Humphreys 2016, section 15.2.3) to 1 - mu and the sine, both without cancellation for any g in
/// (-1, 1).
FN vec3 sample_henyey_greenstein(vec3 forward, float g, float u, float v) {
  const float m = FABS(g), rest = 1.0f - m, inverse = 1.0f / (rest + 2.0f * m * u);
  const float versine = 2.0f * sqr(rest * inverse) * (1.0f - u) * (1.0f + m * u);
  const float radius =
      2.0f * rest * (1.0f + m) * sqr(inverse) * safe_sqrt(u * (1.0f - u) * (1.0f + m * u) * (rest + m * u));
  float sine, cosine;
  sincos_2pi(v, &sine, &cosine);
  const float sign = g < 0.0f ? -1.0f : 1.0f;
  return from_frame(scale(forward, sign), radius * cosine, radius * sine, 1.0f - versine);
}

/// Rayleigh's phase function for unpolarised light: 3 / (16 pi) (1 + mu^2).
FN float rayleigh_phase(float mu) { return 3.0f / 16.0f * INV_PI_F * (1.0f + sqr(mu)); }

/// Samples a direction by it: mu inverts the distribution function mu (mu^2 + 3) / 8 + 1/2, as the real root
/// of a cubic equation (Frisvad 2011, "Importance sampling the Rayleigh phase function").
FN vec3 sample_rayleigh(vec3 forward, float u, float v) {
  const float z = 4.0f * u - 2.0f;
  const float root = exp_f(log_f(FABS(z) + SQRT(sqr(z) + 1.0f)) * (1.0f / 3.0f));
  const float size = min_f(root - 1.0f / root, 1.0f);
  const float mu = z < 0.0f ? -size : size;
  float sine, cosine;
  sincos_2pi(v, &sine, &cosine);
  const float radius = safe_sqrt(1.0f - sqr(mu));
  return from_frame(forward, radius * cosine, radius * sine, mu);
}

FN BsdfValue phase_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  // The path arrives along -wo and continues along wi: 1 - mu and 1 + mu from their sum and difference.
  const vec3 sum = add(wi, wo), difference = sub(wi, wo);
  const float forward = 0.5f * dot3(sum, sum), backward = 0.5f * dot3(difference, difference);
  float density = 0.0f;
  for (int k = 0; k < PHASE_LOBES; k++) {
    GLOBAL const PhaseLobe* lobe = scene->phase_lobes + c.first_lobe + k;
    const float g = lobe->g, weight = lobe->weight;
    const float hg = henyey_greenstein(g, g < 0.0f ? backward : forward);
    density += weight * (lobe->kind == PHASE_RAYLEIGH ? rayleigh_phase(1.0f - forward) : hg);
  }
  BsdfValue value;
  value.f_cos = make_vec3(density, density, density);
  value.pdf = density;
  return value;
}

FN BsdfSample phase_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, float choice) {
  int kind = PHASE_HG;
  float g = 0.0f, below = 0.0f;
  for (int k = 0; k < PHASE_LOBES; k++) {
    GLOBAL const PhaseLobe* lobe = scene->phase_lobes + c.first_lobe + k;
    const bool taken = (lobe->weight > 0.0f) & (choice >= below);
    kind = taken ? lobe->kind : kind;
    g = taken ? lobe->g : g;
    below += lobe->weight;
  }
  const vec3 ahead = negate(wo);
  const vec3 wi =
      select3(kind == PHASE_RAYLEIGH, sample_rayleigh(ahead, u, v), sample_henyey_greenstein(ahead, g, u, v));
  return sample_of_value(wi, phase_eval(scene, c, wo, wi));
}

PENUMBRA_NAMESPACE_END
#endif
