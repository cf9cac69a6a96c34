// Fibres of hair and fur (Chiang, Bitterli, Tappan, Burley 2016; d'Eon et al. 2011; Marschner et al. 2003),
// as in pbrt-v4 and Mitsuba 3. Light is reflected (R), passes through (TT), passes with one reflection
// inside (TRT), or with more, which are one lobe. Each lobe is a product of a longitudinal part, with an
// attenuation, and an azimuthal one: its values include the cosine, and integrate over the sphere to the sum
// of the attenuations, which is 1 of a fibre that absorbs nothing. It is not reciprocal: attenuations are
// those of wo.
//
// `alpha_u` and `alpha_v` are the longitudinal and azimuthal roughness in [0, 1]; `tilt` is the angle of the
// scales in turns; `transmitted` is the absorption coefficient in 1 / radius, unless `variant` says that
// `diffuse`, the fibre's colour in multiple scattering, determines it.
#ifndef PENUMBRA_HAIR_H
#define PENUMBRA_HAIR_H
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/fresnel.h"
#include "kernels/bsdf/hair_colour.h"
#include "kernels/math/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// e^-x I0(x) for x >= 0; relative error below 1e-6 (Abramowitz and Stegun 9.8.1, 9.8.2).
FN float scaled_bessel_i0(float x) {
  const bool near = x < 3.75f;
  const float t = near ? sqr(x * (1.0f / 3.75f)) : 0.0f, r = 3.75f / (near ? 3.75f : x);
  const float small =
      1.0f + t * (3.5156229f +
                  t * (3.0899424f + t * (1.2067492f + t * (0.2659732f + t * (0.0360768f + t * 0.0045813f)))));
  const float large =
      0.39894228f +
      r * (0.01328592f +
           r * (0.00225319f +
                r * (-0.00157565f +
                     r * (0.00916281f +
                          r * (-0.02057706f + r * (0.02635537f + r * (-0.01647633f + r * 0.00392377f)))))));
  return near ? small * exp_f(-x) : large / SQRT(near ? 1.0f : x);
}

/// The longitudinal part M (d'Eon et al. 2011, equation 7), which integrates to 1 over the angle with its
/// cosine. Its sinh and its exponentials are put together: the exponent is cos(theta_i + theta_o) - 1 over
/// the variance `v`, half the squared distance of two points of a circle.
FN float hair_longitudinal(float sine_i, float cosine_i, float sine_o, float cosine_o, float v) {
  const float distance2 = sqr(cosine_i - cosine_o) + sqr(sine_i + sine_o), inverse = 1.0f / v;
  return scaled_bessel_i0(cosine_i * cosine_o * inverse) * exp_f(-0.5f * distance2 * inverse) /
         (-expm1_f(-2.0f * inverse) * v);
}

/// The share of a logistic distribution of scale s that lies below -pi.
FN float hair_logistic_tail(float s) {
  const float e = exp_f(-PI_F / s);
  return e / (1.0f + e);
}

/// The azimuthal part: the logistic distribution of scale s, cut off at -pi and pi, of the angle x in
/// radians.
FN float hair_azimuthal(float x, float s) {
  const float turns = x * (0.5f * INV_PI_F), wrapped = x - 2.0f * PI_F * floor_f(turns + 0.5f);
  const float e = exp_f(-FABS(wrapped) / s);
  return e / (s * sqr(1.0f + e) * (1.0f - 2.0f * hair_logistic_tail(s)));
}

/// The angle of hair_azimuthal at the share u in [0, 1) of its distribution.
FN float hair_sample_azimuthal(float u, float s) {
  const float tail = hair_logistic_tail(s), between = 1.0f - 2.0f * tail;
  const float below = max_f(tail + u * between, 1e-30f), above = max_f(tail + (1.0f - u) * between, 1e-30f);
  return clamp_f(s * (log_f(below) - log_f(above)), -PI_F, PI_F);
}

/// A fibre along the x axis as seen from wo.
typedef struct {
  vec3 wo;
  float across;                    ///< length of wo's part across the fibre, the cosine of theta_o
  float gamma_o, gamma_t;          ///< angles to the normal in the cross section, outside and inside
  float v, s;                      ///< longitudinal variance of TT times 4, azimuthal scale
  vec3 r, tt, trt, rest;           ///< attenuations
  float p_r, p_tt, p_trt, p_rest;  ///< probabilities of sampling, by luminance
} HairFibre;

/// Turns the frame of the surface so that x is along the fibre, and back.
FN vec3 to_fibre(Closure c, vec3 v) {
  return select3((c.variant & HAIR_ALONG_V) != 0, make_vec3(v.y, -v.x, v.z), v);
}
FN vec3 from_fibre(Closure c, vec3 v) {
  return select3((c.variant & HAIR_ALONG_V) != 0, make_vec3(-v.y, v.x, v.z), v);
}

FN HairFibre hair_fibre(Closure c, vec3 wo) {
  HairFibre f;
  f.wo = wo;
  f.across = max_f(SQRT(wo.y * wo.y + wo.z * wo.z), 1e-10f);
  // Seen from wo, the normal of a round fibre leans to the side where it is met.
  const bool by_v = (c.variant & HAIR_OFFSET_BY_V) != 0;
  const float h = clamp_f(by_v ? c.offset : -wo.y / f.across, -1.0f, 1.0f);
  const float cosine_gamma = safe_sqrt((1.0f - h) * (1.0f + h));
  f.gamma_o = atan2_f(h, cosine_gamma);
  // Bravais' index of what is seen along the fibre.
  const float index = safe_sqrt(sqr(c.ior) - sqr(wo.x)) / f.across;
  const float sine_t = clamp_f(h / max_f(index, 1e-10f), -1.0f, 1.0f);
  const float cosine_t = safe_sqrt((1.0f - sine_t) * (1.0f + sine_t));
  f.gamma_t = atan2_f(sine_t, cosine_t);

  const float m = clamp_f(c.alpha_u, LEAST_HAIR_ROUGHNESS, 1.0f),
              n = clamp_f(c.alpha_v, LEAST_HAIR_ROUGHNESS, 1.0f);
  const float m4 = sqr(sqr(m)), m16 = sqr(sqr(m4)), n2 = n * n, n4 = n2 * n2, n16 = sqr(sqr(n4));
  f.v = sqr(m * (0.726f + 0.812f * m) + 3.7f * (m16 * m4));
  // sqrt(pi / 8) is the scale of a logistic distribution of the slope of a normal one at its middle.
  f.s = 0.626657069f * (n * (0.265f + 1.194f * n) + 5.372f * (n16 * n4 * n2));

  const float reflected = dielectric_fresnel(f.across * cosine_gamma, c.ior).reflectance;
  const float sine_refracted = wo.x / c.ior;
  const float path = 2.0f * cosine_t / max_f(safe_sqrt(1.0f - sqr(sine_refracted)), 1e-4f);
  const bool by_colour = (c.variant & HAIR_OF_COLOUR) != 0;
  const float factor = hair_colour_factor(n);
  const vec3 of_colour =
      make_vec3(hair_absorption_of(c.diffuse.x, factor), hair_absorption_of(c.diffuse.y, factor),
                hair_absorption_of(c.diffuse.z, factor));
  const vec3 absorbed = select3(by_colour, of_colour, c.transmitted);
  const vec3 through =
      make_vec3(exp_f(-absorbed.x * path), exp_f(-absorbed.y * path), exp_f(-absorbed.z * path));
  const vec3 inside = scale(through, reflected);
  f.r = make_vec3(reflected, reflected, reflected);
  f.tt = scale(through, sqr(1.0f - reflected));
  f.trt = mul(f.tt, inside);
  const vec3 more = mul(f.trt, inside);
  f.rest = make_vec3(more.x / max_f(1.0f - inside.x, 1e-7f), more.y / max_f(1.0f - inside.y, 1e-7f),
                     more.z / max_f(1.0f - inside.z, 1e-7f));
  const float in_r = luminance(f.r), in_tt = luminance(f.tt), in_trt = luminance(f.trt),
              in_rest = luminance(f.rest);
  const float all = 1.0f / max_f(in_r + in_tt + in_trt + in_rest, 1e-20f);
  f.p_r = in_r * all;
  f.p_tt = in_tt * all;
  f.p_trt = in_trt * all;
  f.p_rest = in_rest * all;
  return f;
}

/// What lobe p's azimuths have in their middle, relative to wo's.
FN float hair_azimuth(HairFibre f, float p) { return p * (2.0f * f.gamma_t + PI_F) - 2.0f * f.gamma_o; }

/// The sine and cosine of wo's inclination for a lobe, which the scales turn by a multiple of their tilt.
typedef struct {
  float sine, cosine;
} HairInclination;
FN HairInclination hair_inclination(HairFibre f, float turns) {
  float s, c;
  sincos_2pi(turns, &s, &c);
  HairInclination t;
  t.sine = f.wo.x * c - f.across * s;
  t.cosine = FABS(f.across * c + f.wo.x * s);
  return t;
}
// Multiples of the tilt.
#define HAIR_TILT_R 2.0f
#define HAIR_TILT_TT -1.0f
#define HAIR_TILT_TRT -4.0f

FN BsdfValue hair_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const HairFibre f = hair_fibre(c, to_fibre(c, wo));
  const vec3 w = to_fibre(c, wi);
  const float across = SQRT(w.y * w.y + w.z * w.z);
  const float phi = atan2_f(f.wo.y * w.z - f.wo.z * w.y, f.wo.y * w.y + f.wo.z * w.z);
  const HairInclination of_r = hair_inclination(f, HAIR_TILT_R * c.tilt),
                        of_tt = hair_inclination(f, HAIR_TILT_TT * c.tilt),
                        of_trt = hair_inclination(f, HAIR_TILT_TRT * c.tilt);
  const float r = hair_longitudinal(w.x, across, of_r.sine, of_r.cosine, f.v) *
                  hair_azimuthal(phi - hair_azimuth(f, 0.0f), f.s);
  const float tt = hair_longitudinal(w.x, across, of_tt.sine, of_tt.cosine, 0.25f * f.v) *
                   hair_azimuthal(phi - hair_azimuth(f, 1.0f), f.s);
  const float trt = hair_longitudinal(w.x, across, of_trt.sine, of_trt.cosine, 4.0f * f.v) *
                    hair_azimuthal(phi - hair_azimuth(f, 2.0f), f.s);
  const float rest = hair_longitudinal(w.x, across, f.wo.x, f.across, 4.0f * f.v) * (0.5f * INV_PI_F);
  BsdfValue value;
  value.f_cos = add(add(scale(f.r, r), scale(f.tt, tt)), add(scale(f.trt, trt), scale(f.rest, rest)));
  value.pdf = f.p_r * r + f.p_tt * tt + f.p_trt * trt + f.p_rest * rest;
  return select_bsdf_value(wo.z > 0.0f, value, no_bsdf_value());
}

/// `choice` chooses the lobe, and with what remains of it the azimuth.
FN BsdfSample hair_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, float choice) {
  const HairFibre f = hair_fibre(c, to_fibre(c, wo));
  const float to_tt = f.p_r + f.p_tt, to_trt = to_tt + f.p_trt;
  const bool is_r = choice < f.p_r, is_tt = choice < to_tt, is_trt = choice < to_trt;
  const float low = is_r ? 0.0f : is_tt ? f.p_r : is_trt ? to_tt : to_trt;
  const float high = is_r ? f.p_r : is_tt ? to_tt : is_trt ? to_trt : 1.0f;
  const float within = clamp_f((choice - low) / max_f(high - low, 1e-20f), 0.0f, ONE_MINUS_EPSILON);
  const float p = is_r ? 0.0f : is_tt ? 1.0f : 2.0f;
  const float variance = f.v * (is_r ? 1.0f : is_tt ? 0.25f : 4.0f);
  const float turned = is_r ? HAIR_TILT_R : is_tt ? HAIR_TILT_TT : is_trt ? HAIR_TILT_TRT : 0.0f;
  const HairInclination o = hair_inclination(f, turned * c.tilt);
  // 1 - cos of the angle to the direction at -theta_o, then the angle about that (d'Eon et al. 2013).
  const float versine =
      clamp_f(-variance * log_f(max_f(u + (1.0f - u) * exp_f(-2.0f / variance), 1e-37f)), 0.0f, 2.0f);
  float s, cosine_about;
  sincos_2pi(v, &s, &cosine_about);
  const float sine = SQRT(versine * (2.0f - versine));
  const float along = clamp_f(sine * cosine_about * o.cosine - (1.0f - versine) * o.sine, -1.0f, 1.0f);
  const float across = safe_sqrt((1.0f - along) * (1.0f + along));
  const float phi = is_trt ? hair_azimuth(f, p) + hair_sample_azimuthal(within, f.s) : 2.0f * PI_F * within;
  const float turns = phi * (0.5f * INV_PI_F);
  float sine_phi, cosine_phi;
  sincos_2pi(turns - floor_f(turns), &sine_phi, &cosine_phi);
  const float y = f.wo.y / f.across, z = f.wo.z / f.across;
  const vec3 w =
      make_vec3(along, across * (y * cosine_phi - z * sine_phi), across * (z * cosine_phi + y * sine_phi));
  const vec3 wi = from_fibre(c, w);
  return sample_of_value(wi, hair_eval(scene, c, wo, wi));
}

PENUMBRA_NAMESPACE_END
#endif
