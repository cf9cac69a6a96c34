// A diffuse base under a rough dielectric boundary (Mitsuba 3's roughplastic): F D G / (4 cos cos) of
// isotropic microfacets with roughness alpha_u, one family for each distribution, plus the base of plastic.h.
// The transmittance of boundary and coating is a curve over the cosine; after its knots follows the
// boundary's reflectance for diffuse light from inside. There is one curve for one roughness, or rows of
// curves. scenes/bsdfs/rough_boundary.h computes them.
#ifndef PENUMBRA_ROUGHPLASTIC_H
#define PENUMBRA_ROUGHPLASTIC_H
#include "kernels/bsdf/microfacet.h"
#include "kernels/bsdf/plastic.h"

PENUMBRA_NAMESPACE_BEGIN

#define FIRST_ROW_PLACE 0.1f  // fourth root of LEAST_ALPHA

/// The two rows (offsets in the table of curves) between which a roughness lies. Rows are equidistant in the
/// fourth root of the roughness, from LEAST_ALPHA to 1; larger values use the last row. The interpolation
/// error is up to 0.003, and up to 0.005 where light from outside may be totally reflected.
typedef struct {
  int first, second;
  float w;
} CurveRows;

FN CurveRows curve_rows(Closure c) {
  const float place = SQRT(SQRT(clamp_f(c.alpha_u, LEAST_ALPHA, 1.0f)));
  const int last = c.curve_rows > 0 ? c.curve_rows - 1 : 0;  // lanes of other families have no rows
  const float x = max_f((place - FIRST_ROW_PLACE) / (1.0f - FIRST_ROW_PLACE), 0.0f) * (float)last;
  const int row = min_i((int)x, last), next = min_i(row + 1, last);
  CurveRows rows;
  rows.first = c.curve + row * CURVE_STRIDE;
  rows.second = c.curve + next * CURVE_STRIDE;
  rows.w = x - (float)row;
  return rows;
}

/// The value at offset `at`, interpolated between the rows.
FN float between_rows(const PRIVATE Scene* scene, CurveRows rows, int at) {
  return (1.0f - rows.w) * scene->curves[rows.first + at] + rows.w * scene->curves[rows.second + at];
}

/// The curve's value, interpolated between its knots.
FN float curve_at(const PRIVATE Scene* scene, CurveRows rows, float cosine) {
  const float x = clamp_f(cosine, 0.0f, 1.0f) * (float)(CURVE_KNOTS - 1);
  const int knot = min_i((int)x, CURVE_KNOTS - 2);
  const float w = x - (float)knot;
  return (1.0f - w) * between_rows(scene, rows, knot) + w * between_rows(scene, rows, knot + 1);
}

FN Closure with_internal(const PRIVATE Scene* scene, Closure c, CurveRows rows) {
  c.internal = between_rows(scene, rows, CURVE_KNOTS);
  return c;
}

FN BsdfValue plastic_lobes_eval(Microfacets m, const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = (wi.z > 0.0f) & (wo.z > 0.0f);
  const MicrofacetReflection r = microfacet_reflection(m, wo, wi);
  const float fresnel = dielectric_fresnel(r.cosine, c.ior).reflectance;
  const CurveRows rows = curve_rows(c);
  const float out = curve_at(scene, rows, wo.z), in = curve_at(scene, rows, wi.z);
  const float lambert = wi.z * INV_PI_F, share = boundary_share(c, out);
  const vec3 base = base_reflectance(with_internal(scene, c, rows));
  BsdfValue value;
  value.f_cos = add(scale(c.specular, r.f_cos * fresnel), scale(base, (out * in) * lambert));
  value.pdf = (1.0f - share) * lambert + share * r.pdf;
  return select_bsdf_value(reflects, value, no_bsdf_value());
}

FN BsdfSample plastic_lobes_sample(Microfacets m, const PRIVATE Scene* scene, Closure c, vec3 wo, float u,
                                   float v, float choice) {
  const vec3 mirrored = mirror_about(wo, sample_microfacet(m, wo, u, v));
  const float share = boundary_share(c, curve_at(scene, curve_rows(c), wo.z));
  const vec3 wi = select3(choice < share, mirrored, cosine_hemisphere(u, v));
  return sample_of_value(wi, plastic_lobes_eval(m, scene, c, wo, wi));
}

#define ROUGH_PLASTIC(name, NAME)                                                               \
  FN BsdfValue name##_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {           \
    const Microfacets m = make_microfacets(DISTRIBUTION_##NAME, c.alpha_u, c.alpha_u);          \
    return plastic_lobes_eval(m, scene, c, wo, wi);                                             \
  }                                                                                             \
  FN BsdfSample name##_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, \
                              float choice) {                                                   \
    const Microfacets m = make_microfacets(DISTRIBUTION_##NAME, c.alpha_u, c.alpha_u);          \
    return plastic_lobes_sample(m, scene, c, wo, u, v, choice);                                 \
  }
ROUGH_PLASTIC(roughplastic_ggx, GGX)
ROUGH_PLASTIC(roughplastic_beckmann, BECKMANN)
#undef ROUGH_PLASTIC

#define ROUGH_PLASTIC_CONTROL(name, NAME)                                                       \
  FN ControlLobes name##_control(const PRIVATE Scene* scene, Closure c, float cosine) {         \
    const Microfacets m = make_microfacets(DISTRIBUTION_##NAME, c.alpha_u, c.alpha_u);          \
    const MicrofacetLobe lobe = microfacet_lobe(scene, DISTRIBUTION_##NAME, m.alpha_u, cosine); \
    const float fresnel = dielectric_fresnel(fresnel_cosine(lobe), c.ior).reflectance;          \
    const CurveRows rows = curve_rows(c);                                                       \
    const Closure base = with_internal(scene, c, rows);                                         \
    return make_control_lobes(base_as_lambert(base, curve_at(scene, rows, cosine)), lobe,       \
                              scale(c.specular, fresnel));                                      \
  }
ROUGH_PLASTIC_CONTROL(roughplastic_ggx, GGX)
ROUGH_PLASTIC_CONTROL(roughplastic_beckmann, BECKMANN)
#undef ROUGH_PLASTIC_CONTROL

PENUMBRA_NAMESPACE_END
#endif
