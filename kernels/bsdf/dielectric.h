// A smooth dielectric boundary: reflects by Fresnel's equations and refracts the rest by Snell's law. `ior`
// is the index of the side opposite wo over that of wo's side.
#ifndef PENUMBRA_DIELECTRIC_H
#define PENUMBRA_DIELECTRIC_H
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/fresnel.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// Probability of reflection, which is sampled if `choice` is below it.
FN float dielectric_lobe_probability(Closure c, vec3 wo) {
  return dielectric_fresnel(wo.z, c.ior).reflectance;
}

FN BsdfValue dielectric_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  return no_bsdf_value();
}

/// Radiance that is refracted into a medium scales with the square of the relative index (Veach 1997, section
/// 5.2).
FN BsdfSample dielectric_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                float choice) {
  const DielectricFresnel f = dielectric_fresnel(wo.z, c.ior);
  const bool reflects = choice < f.reflectance;
  const float shrink = 1.0f / c.ior;
  const vec3 reflected = make_vec3(-wo.x, -wo.y, wo.z);
  const vec3 refracted = make_vec3(-wo.x * shrink, -wo.y * shrink, -f.cosine);
  BsdfSample s = no_bsdf_sample();
  s.wi = select3(reflects, reflected, refracted);
  s.weight = select3(reflects, c.specular, scale(c.transmitted, shrink * shrink));
  s.pdf = wo.z > 0.0f ? DELTA_PDF : 0.0f;
  s.eta = reflects ? 1.0f : c.ior;
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
