// Evaluation and sampling of the tests' additional BSDF families, for kernels/bsdf/bsdf.h.
#ifndef PENUMBRA_EXTRA_FAMILY_FUNCTIONS_H
#define PENUMBRA_EXTRA_FAMILY_FUNCTIONS_H
#include "kernels/bsdf/control_lobes.h"
#include "kernels/bsdf/phong.h"

PENUMBRA_NAMESPACE_BEGIN

/// The one direction, with `specular` of its light.
FN BsdfSample only_direction(Closure c, vec3 wi, float eta) {
  BsdfSample s = no_bsdf_sample();
  s.wi = wi;
  s.weight = scale(c.specular, 1.0f / (eta * eta));
  s.pdf = DELTA_PDF;
  s.eta = eta;
  return s;
}

FN BsdfValue mirror_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) { return no_bsdf_value(); }
FN BsdfSample mirror_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, float choice) {
  return only_direction(c, make_vec3(-wo.x, -wo.y, wo.z), 1.0f);
}

FN BsdfValue window_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) { return no_bsdf_value(); }
FN BsdfSample window_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, float choice) {
  return only_direction(c, negate(wo), 1.0f);
}

/// `exponent` is the refractive index of the other side over that of wo's.
FN BsdfValue refracting_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  return no_bsdf_value();
}
FN BsdfSample refracting_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                float choice) {
  const float x = -wo.x / c.exponent, y = -wo.y / c.exponent, cosine2 = 1.0f - (x * x + y * y);
  const bool gets_through = cosine2 > 0.0f;
  const vec3 through = make_vec3(x, y, -safe_sqrt(cosine2)), reflected = make_vec3(-wo.x, -wo.y, wo.z);
  return only_direction(c, select3(gets_through, through, reflected), gets_through ? c.exponent : 1.0f);
}

#define PHONG_AGAIN(name, NAME, number, properties, text)                                       \
  FN BsdfValue name##_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {           \
    return phong_eval(scene, c, wo, wi);                                                        \
  }                                                                                             \
  FN BsdfSample name##_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, \
                              float choice) {                                                   \
    return phong_sample(scene, c, wo, u, v, choice);                                            \
  }
PHONG_AGAIN(glossy, , , , )
PHONG_AGAIN(crude, , , , )
#undef PHONG_AGAIN

/// A microfacet lobe of about the width, half as bright again, beside too dark a Lambert of another colour.
FN ControlLobes crude_control(const PRIVATE Scene* scene, Closure c, float cosine) {
  const MicrofacetLobe lobe =
      microfacet_lobe(scene, DISTRIBUTION_GGX, SQRT(2.0f / (c.exponent + 2.0f)), cosine);
  const vec3 diffuse = make_vec3(0.5f * c.diffuse.x, 0.8f * c.diffuse.y, 0.2f * c.diffuse.z);
  return make_control_lobes(diffuse, lobe, scale(c.specular, 1.5f));
}

PENUMBRA_NAMESPACE_END
#endif
