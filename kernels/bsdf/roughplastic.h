// A diffuse base under a rough dielectric boundary (Mitsuba 3's roughplastic): F D G / (4 cos cos) of
// isotropic microfacets, roughness alpha_u, beside what plastic.h has for the base, with the boundary's
// transmittance from a curve over the cosine. scenes/bsdfs/rough_boundary.h makes the curve.
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

typedef struct {
  float f_cos;  ///< F D G / (4 cos), for light under a positive cosine
  float pdf;    ///< with which sample_rough_boundary finds it
} BoundaryValue;

/// What the boundary reflects.
FN BoundaryValue rough_boundary(Closure c, vec3 wo, vec3 wi) {
  const Microfacets m = make_microfacets(c.distribution, c.alpha_u, c.alpha_u);
  const vec3 h = normalize3(add(wo, wi));
  const float density = 0.25f * microfacet_density(m, h);
  const float fresnel = dielectric_fresnel(clamp_f(dot3(wo, h), 0.0f, 1.0f), c.ior).reflectance;
  BoundaryValue value;
  value.f_cos = density * microfacet_masking_over_cosine(m, wo) * (microfacet_masking(m, wi) * fresnel);
  value.pdf = density * microfacet_visible_over_cosine(m, wo);
  return value;
}

FN vec3 sample_rough_boundary(Closure c, vec3 wo, float u, float v) {
  const vec3 h = sample_microfacet(make_microfacets(c.distribution, c.alpha_u, c.alpha_u), wo, u, v);
  return add_scaled(negate(wo), 2.0f * dot3(wo, h), h);
}

FN BsdfValue roughplastic_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = (wi.z > 0.0f) & (wo.z > 0.0f);
  const BoundaryValue boundary = rough_boundary(c, wo, wi);
  const float out = curve_at(scene, c.curve, wo.z), in = curve_at(scene, c.curve, wi.z);
  const float lambert = wi.z * INV_PI_F, share = boundary_share(c, out);
  BsdfValue value;
  value.f_cos = add(scale(c.specular, boundary.f_cos), scale(base_reflectance(c), (out * in) * lambert));
  value.pdf = (1.0f - share) * lambert + share * boundary.pdf;
  return select_bsdf_value(reflects, value, no_bsdf_value());
}

FN BsdfSample roughplastic_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                  float choice) {
  const vec3 mirrored = sample_rough_boundary(c, wo, u, v);
  const float share = boundary_share(c, curve_at(scene, c.curve, wo.z));
  const vec3 wi = select3(choice < share, mirrored, cosine_hemisphere(u, v));
  return sample_of_value(wi, roughplastic_eval(scene, c, wo, wi));
}

PENUMBRA_NAMESPACE_END
#endif
