// A pane of two parallel smooth boundaries, so thin that it does not displace rays. Light that is reflected
// inside any number of times is included.
#ifndef PENUMBRA_THINDIELECTRIC_H
#define PENUMBRA_THINDIELECTRIC_H
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/fresnel.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// Reflectance of a pane with this relative index at a cosine above 0. With Fresnel's r and t = 1 - r it is r
/// + t^2 r + t^2 r^3 + ... = 2 r / (1 + r).
FN float pane_reflectance(float cosine, float ior) {
  const float r = dielectric_fresnel(cosine, ior).reflectance;
  return 2.0f * r / (1.0f + r);
}

/// Probability of reflection, which is sampled if `choice` is below it.
FN float thindielectric_lobe_probability(Closure c, vec3 wo) { return pane_reflectance(wo.z, c.ior); }

FN BsdfValue thindielectric_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  return no_bsdf_value();
}

FN BsdfSample thindielectric_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                    float choice) {
  const bool reflects = choice < thindielectric_lobe_probability(c, wo);
  BsdfSample s = no_bsdf_sample();
  s.wi = select3(reflects, make_vec3(-wo.x, -wo.y, wo.z), negate(wo));
  s.weight = select3(reflects, c.specular, c.transmitted);
  s.pdf = wo.z > 0.0f ? DELTA_PDF : 0.0f;
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
