// Lambert and a rough dielectric boundary beside it, as in Nori: f = diffuse / pi + specular F D G / (4 cos
// cos) of isotropic microfacets, roughness alpha_u. Nothing ties the two parts together: `specular` is what
// the diffuse one leaves.
#ifndef PENUMBRA_MICROFACET_DIFFUSE_H
#define PENUMBRA_MICROFACET_DIFFUSE_H
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/phong.h"
#include "kernels/bsdf/roughplastic.h"

PENUMBRA_NAMESPACE_BEGIN

FN BsdfValue microfacet_diffuse_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = (wi.z > 0.0f) & (wo.z > 0.0f);
  const BoundaryValue boundary = rough_boundary(c, wo, wi);
  const float lambert = wi.z * INV_PI_F, share = phong_lobe_share(c);
  BsdfValue value;
  value.f_cos = add(scale(c.specular, boundary.f_cos), scale(c.diffuse, lambert));
  value.pdf = (1.0f - share) * lambert + share * boundary.pdf;
  return select_bsdf_value(reflects, value, no_bsdf_value());
}

FN BsdfSample microfacet_diffuse_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                        float choice) {
  const vec3 mirrored = sample_rough_boundary(c, wo, u, v);
  const vec3 wi = select3(choice < phong_lobe_share(c), mirrored, cosine_hemisphere(u, v));
  return sample_of_value(wi, microfacet_diffuse_eval(scene, c, wo, wi));
}

PENUMBRA_NAMESPACE_END
#endif
