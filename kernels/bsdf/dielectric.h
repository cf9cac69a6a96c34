// A smooth boundary between dielectrics: reflects by Fresnel's equations, refracts the rest by Snell's law.
// `ior` is the index of the side that the viewer does not see, over that of the side that he sees.
#ifndef PENUMBRA_DIELECTRIC_H
#define PENUMBRA_DIELECTRIC_H
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/fresnel.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// Probability of the reflection, which is sampled for a choice below it.
FN float dielectric_lobe_probability(Closure c, vec3 wo) {
  return dielectric_fresnel(wo.z, c.ior).reflectance;
}

FN BsdfValue dielectric_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  return no_bsdf_value();
}

/// Radiance that crosses into a medium grows by the square of the index (Veach 1997, section 5.2).
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
