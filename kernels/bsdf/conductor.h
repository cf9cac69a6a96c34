// A smooth conductor: a mirror with Fresnel's reflectance.
#ifndef PENUMBRA_CONDUCTOR_H
#define PENUMBRA_CONDUCTOR_H
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/fresnel.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

FN BsdfValue conductor_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  return no_bsdf_value();
}

FN BsdfSample conductor_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                               float choice) {
  BsdfSample s = no_bsdf_sample();
  s.wi = make_vec3(-wo.x, -wo.y, wo.z);
  s.weight = mul(c.specular, conductor_fresnel(wo.z, c.eta, c.k));
  s.pdf = wo.z > 0.0f ? DELTA_PDF : 0.0f;
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
