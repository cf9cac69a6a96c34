// Lambert: f = diffuse / pi.
#ifndef PENUMBRA_DIFFUSE_H
#define PENUMBRA_DIFFUSE_H
#include "kernels/bsdf/families.h"
#include "kernels/math/frame.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

FN BsdfValue diffuse_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = (wi.z > 0.0f) & (wo.z > 0.0f);
  BsdfValue value;
  value.pdf = reflects ? wi.z * INV_PI_F : 0.0f;
  value.f_cos = scale(c.diffuse, value.pdf);
  return value;
}

FN BsdfSample diffuse_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, float choice) {
  BsdfSample s = no_bsdf_sample();
  s.wi = cosine_hemisphere(u, v);
  s.pdf = diffuse_eval(scene, c, wo, s.wi).pdf;
  s.weight = c.diffuse;
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
