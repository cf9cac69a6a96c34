// A diffuse base under a rough dielectric boundary (Mitsuba 3's roughplastic): F D G / (4 cos cos) of
// isotropic microfacets, roughness alpha_u, a family for each distribution, beside what plastic.h has for the
// base, with the boundary's transmittance from a curve over the cosine. scenes/bsdfs/rough_boundary.h makes
// the curve.
#ifndef PENUMBRA_ROUGHPLASTIC_H
#define PENUMBRA_ROUGHPLASTIC_H
#include "kernels/bsdf/microfacet.h"
#include "kernels/bsdf/plastic.h"

PENUMBRA_NAMESPACE_BEGIN

/// The curve's value between its knots.
FN float curve_at(const PRIVATE Scene* scene, int curve, float cosine) {
  const float x = clamp_f(cosine, 0.0f, 1.0f) * (float)(CURVE_KNOTS - 1);
  const int knot = min_i((int)x, CURVE_KNOTS - 2);
  const float w = x - (float)knot;
  return (1.0f - w) * scene->curves[curve + knot] + w * scene->curves[curve + knot + 1];
}

FN BsdfValue plastic_lobes_eval(Microfacets m, const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = (wi.z > 0.0f) & (wo.z > 0.0f);
  const MicrofacetReflection r = microfacet_reflection(m, wo, wi);
  const float fresnel = dielectric_fresnel(r.cosine, c.ior).reflectance;
  const float out = curve_at(scene, c.curve, wo.z), in = curve_at(scene, c.curve, wi.z);
  const float lambert = wi.z * INV_PI_F, share = boundary_share(c, out);
  BsdfValue value;
  value.f_cos = add(scale(c.specular, r.f_cos * fresnel), scale(base_reflectance(c), (out * in) * lambert));
  value.pdf = (1.0f - share) * lambert + share * r.pdf;
  return select_bsdf_value(reflects, value, no_bsdf_value());
}

FN BsdfSample plastic_lobes_sample(Microfacets m, const PRIVATE Scene* scene, Closure c, vec3 wo, float u,
                                   float v, float choice) {
  const vec3 mirrored = mirror_about(wo, sample_microfacet(m, wo, u, v));
  const float share = boundary_share(c, curve_at(scene, c.curve, wo.z));
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

#if HAS(LTC)
  #define ROUGH_PLASTIC_CONTROL(name, NAME)                                                       \
    FN ControlLobes name##_control(const PRIVATE Scene* scene, Closure c, float cosine) {         \
      const Microfacets m = make_microfacets(DISTRIBUTION_##NAME, c.alpha_u, c.alpha_u);          \
      const MicrofacetLobe lobe = microfacet_lobe(scene, DISTRIBUTION_##NAME, m.alpha_u, cosine); \
      const float fresnel = dielectric_fresnel(fresnel_cosine(lobe), c.ior).reflectance;          \
      return make_control_lobes(base_as_lambert(c, curve_at(scene, c.curve, cosine)), lobe,       \
                                scale(c.specular, fresnel));                                      \
    }
ROUGH_PLASTIC_CONTROL(roughplastic_ggx, GGX)
ROUGH_PLASTIC_CONTROL(roughplastic_beckmann, BECKMANN)
  #undef ROUGH_PLASTIC_CONTROL
#endif

PENUMBRA_NAMESPACE_END
#endif
