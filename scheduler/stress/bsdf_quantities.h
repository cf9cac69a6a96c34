// Quantities of BSDFs. See quantities.h.
#ifndef PENUMBRA_STRESS_BSDF_QUANTITIES_H
#define PENUMBRA_STRESS_BSDF_QUANTITIES_H
#include "kernels/bsdf/bsdf.h"
#include "kernels/math/math_double.h"
#include "scheduler/stress/quantity_numbers.h"

PENUMBRA_NAMESPACE_BEGIN

/// In: reflectances of the diffuse and the Phong lobe, exponent.
FN Closure closure_in(GLOBAL const double* in) {
  Closure c = black_closure();
  c.family = FAMILY_PHONG;
  c.diffuse = make_vec3(in_f(in, 0), in_f(in, 0), in_f(in, 0));
  c.specular = make_vec3(in_f(in, 1), in_f(in, 1), in_f(in, 1));
  c.exponent = in_f(in, 2);
  return c;
}

/// In: closure, normal, wo, wi. Out: f cos, pdf.
STAGE void bsdf_value_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const BsdfValue value = eval_bsdf(0, closure_in(in), in_v(in, 3), in_v(in, 6), in_v(in, 9));
  out[0] = value.f_cos.x;
  out[1] = value.pdf;
}

/// In: closure, normal, wo, u, v, choice. Out: direction, weight, pdf.
STAGE void bsdf_sample_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const BsdfSample s =
      sample_bsdf(0, closure_in(in), in_v(in, 3), in_v(in, 6), in_f(in, 9), in_f(in, 10), in_f(in, 11));
  out_v(out, 0, s.wi);
  out[3] = s.weight.x;
  out[4] = s.pdf;
}

/// In: closure, normal, wo, size N of a grid. Out: the albedo (mean weight of N x N samples at the centres of
/// the cells of (u, v), with both lobes chosen in proportion to their probability); the largest weight; the
/// number of directions that are not unit vectors.
STAGE void bsdf_albedo_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const Closure c = closure_in(in);
  const double share = (double)phong_lobe_share(c);
  const vec3 n = in_v(in, 3), wo = in_v(in, 6);
  const int size = (int)in[9];
  double sum = 0.0, largest = 0.0, bad = 0.0;
  for (int i = 0; i < size; i++) {
    for (int k = 0; k < size; k++) {
      const float u = ((float)i + 0.5f) / (float)size, v = ((float)k + 0.5f) / (float)size;
      const BsdfSample a = sample_bsdf(0, c, n, wo, u, v, 0.0f);
      const BsdfSample b = sample_bsdf(0, c, n, wo, u, v, ONE_MINUS_EPSILON);
      sum += share * a.weight.x + (1.0 - share) * b.weight.x;
      largest = max_d(largest, max_d(a.weight.x, b.weight.x));
      const float length2 = dot3(a.wi, a.wi);
      bad += FABS(length2 - 1.0f) < 1e-5f ? 0.0 : 1.0;
    }
  }
  out[0] = sum / ((double)size * (double)size);
  out[1] = largest;
  out[2] = bad;
}

/// In: family, variant, reflectances of base and lobe, refractive index, internal reflectance (for a
/// conductor its absorption), roughness along and across the tangent, exponent.
FN Closure mixture_in(GLOBAL const double* in) {
  Closure c = black_closure();
  c.family = (int)in[0];
  c.variant = (int)in[1];
  c.diffuse = make_vec3(in_f(in, 2), in_f(in, 2), in_f(in, 2));
  c.specular = make_vec3(in_f(in, 3), in_f(in, 3), in_f(in, 3));
  c.transmitted = c.specular;
  c.ior = in_f(in, 4);
  c.eta = make_vec3(c.ior, c.ior, c.ior);
  c.internal = in_f(in, 5);
  c.k = make_vec3(c.internal, c.internal, c.internal);
  c.alpha_u = in_f(in, 6);
  c.alpha_v = in_f(in, 7);
  c.exponent = in_f(in, 8);
  return c;
}

/// In: closure, wo, wi, in the frame of the normal. Out: f cos, pdf.
STAGE void mixture_value_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const vec3 z = make_vec3(0.0f, 0.0f, 1.0f);
  const BsdfValue value = eval_bsdf(0, mixture_in(in), z, in_v(in, 9), in_v(in, 12));
  out[0] = value.f_cos.x;
  out[1] = value.pdf;
}

/// In: closure, wo in the frame of the normal, size N of a grid. Out: the largest weight of N x N samples of
/// either lobe; the number of samples with an invalid weight or direction.
STAGE void mixture_samples_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const vec3 z = make_vec3(0.0f, 0.0f, 1.0f);
  const Closure c = mixture_in(in);
  const int size = (int)in[12];
  const bool transmits = (families_with(TRANSMITS) >> c.family & 1u) != 0u;
  double largest = 0.0, bad = 0.0;
  for (int i = 0; i < size * size; i++) {
    const float u = ((float)(i / size) + 0.5f) / (float)size, v = ((float)(i % size) + 0.5f) / (float)size;
    for (int lobe = 0; lobe < 2; lobe++) {
      const BsdfSample s = sample_bsdf(0, c, z, in_v(in, 9), u, v, lobe == 0 ? 0.0f : ONE_MINUS_EPSILON);
      const bool unit = FABS(dot3(s.wi, s.wi) - 1.0f) < 1e-5f;
      const bool found = s.pdf > 0.0f;
      const bool good = (s.weight.x >= 0.0f) & (s.weight.x < 1e30f) & (transmits | (s.wi.z > 0.0f));
      bad += (unit & (found ? good : true)) ? 0.0 : 1.0;
      largest = max_d(largest, found ? s.weight.x : 0.0);
    }
  }
  out[0] = largest;
  out[1] = bad;
}

/// In: cosine, refractive index, absorption. Out: the reflectance of a dielectric, the cosine of the
/// transmitted direction; the reflectance of a conductor.
STAGE void fresnel_quantity(GLOBAL const double* in, GLOBAL double* out) {
  const DielectricFresnel f = dielectric_fresnel(in_f(in, 0), in_f(in, 1));
  out[0] = f.reflectance;
  out[1] = f.cosine;
  out[2] = conductor_reflectance(in_f(in, 0), in_f(in, 1), in_f(in, 2));
}

PENUMBRA_NAMESPACE_END
#endif
