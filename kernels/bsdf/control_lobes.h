// Control lobes of a glossy closure under polygon lights: a Lambert lobe and a linearly transformed cosine
// that approximate the closure and have closed forms. Used as a control variate, any such pair is unbiased;
// the variance depends on how close it is.
//
// A family with control lobes has a row in LTC_FAMILIES (families.h), and beside its eval
//   ControlLobes <name>_control(scene, closure, cosine of wo)
#ifndef PENUMBRA_CONTROL_LOBES_H
#define PENUMBRA_CONTROL_LOBES_H
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/ltc.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

// f times the cosine of wi: above the horizon it is diffuse / pi times that cosine plus specular times the
// lobe's density, and 0 below.
#define CONTROL_LOBES_FIELDS(F, a)                                     \
  F(a, vec3, diffuse)                                                  \
  F(a, vec3, specular)                                                 \
  F(a, float, width_x) /* of the lobe's matrix, see Ltc; 0: no lobe */ \
  F(a, float, width_y)                                                 \
  F(a, float, shift)
LANE_RECORD(ControlLobes, ControlLanes, control_lobes, CONTROL_LOBES_FIELDS)

FN ControlLobes no_control_lobes(void) {
  ControlLobes c;
  c.diffuse = c.specular = make_vec3(0.0f, 0.0f, 0.0f);
  c.width_x = c.width_y = c.shift = 0.0f;
  return c;
}

/// A microfacet reflection, approximated by a linearly transformed cosine.
typedef struct {
  Ltc ltc;
  float albedo;   ///< directional albedo without the Fresnel term
  float schlick;  ///< mean of (1 - cos)^5 over the lobe, cos at the microfacets
} MicrofacetLobe;

/// Interpolates the scene's table bilinearly. `alpha` > 0 is clamped to widths that floats can represent;
/// `cosine` is in [0, 1].
FN MicrofacetLobe microfacet_lobe(const PRIVATE Scene* scene, int distribution, float alpha, float cosine) {
  const float most = (float)(LTC_SIZE - 1), a = clamp_f(alpha, 1e-4f, 10.0f);
  const float row = SQRT(min_f(a, 1.0f)) * most, column = SQRT(clamp_f(cosine, 0.0f, 1.0f)) * most;
  const int i = min_i((int)row, LTC_SIZE - 2), j = min_i((int)column, LTC_SIZE - 2);
  const float s = row - (float)i, t = column - (float)j;
  const int table = distribution == DISTRIBUTION_BECKMANN ? LTC_SIZE * LTC_SIZE : 0;
  GLOBAL const LtcCell* at = scene->ltc_cells + (table + i * LTC_SIZE + j);
  const float w00 = (1.0f - s) * (1.0f - t), w01 = (1.0f - s) * t, w10 = s * (1.0f - t), w11 = s * t;
#define MIXED(field) \
  ((w00 * at[0].field + w01 * at[1].field) + (w10 * at[LTC_SIZE].field + w11 * at[LTC_SIZE + 1].field))
  MicrofacetLobe lobe;
  lobe.ltc = make_ltc(MIXED(lean), MIXED(width_x), MIXED(width_y), a, cosine);
  lobe.albedo = MIXED(albedo);
  lobe.schlick = MIXED(schlick);
#undef MIXED
  return lobe;
}

/// The cosine at the microfacets for which Schlick's Fresnel term equals its mean over the lobe. Other
/// Fresnel terms have about their mean there, too.
FN float fresnel_cosine(MicrofacetLobe lobe) {
  return 1.0f - exp_f(0.2f * log_f(clamp_f(lobe.schlick, 1e-20f, 1.0f)));
}

/// The control lobes of a microfacet reflection with this reflectance and a Lambert lobe.
FN ControlLobes make_control_lobes(vec3 diffuse, MicrofacetLobe lobe, vec3 reflectance) {
  ControlLobes c;
  c.diffuse = diffuse;
  c.specular = scale(reflectance, lobe.albedo);
  c.width_x = lobe.ltc.width_x;
  c.width_y = lobe.ltc.width_y;
  c.shift = lobe.ltc.shift;
  return c;
}

FN Ltc ltc_of(ControlLobes c) {
  Ltc ltc;
  ltc.width_x = c.width_x > 0.0f ? c.width_x : 1.0f;
  ltc.width_y = c.width_x > 0.0f ? c.width_y : 1.0f;
  ltc.shift = c.shift;
  return ltc;
}

/// f times the cosine of wi. Directions are in the normal's frame.
FN vec3 control_value(ControlLobes c, vec3 wo, vec3 wi) {
  const float cosine = max_f(wi.z, 0.0f);
  const float density = cosine * ltc_density_over_cosine(ltc_of(c), to_lobe_frame(wo, wi));
  return add(scale(c.diffuse, cosine * INV_PI_F), scale(c.specular, density));
}

/// Whether samples of polygon lights at such a closure may use the lobes as control variate. Families that
/// transmit have none, since their lights are sampled differently.
FN bool has_ltc_form(Closure c) { return is_among(c, ltc_families()); }

PENUMBRA_NAMESPACE_END
#endif
