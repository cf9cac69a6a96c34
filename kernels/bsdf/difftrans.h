// A thin sheet that scatters light evenly to both sides: f = diffuse / pi for reflection, transmitted / pi
// for transmission. Both sides are alike.
#ifndef PENUMBRA_DIFFTRANS_H
#define PENUMBRA_DIFFTRANS_H
#include "kernels/bsdf/families.h"
#include "kernels/math/frame.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// Probability of reflection.
FN float difftrans_reflected_share(Closure c) {
  const float reflected = luminance(c.diffuse), sum = reflected + luminance(c.transmitted);
  return sum > 0.0f ? reflected / sum : 1.0f;
}

FN BsdfValue difftrans_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = wi.z > 0.0f;
  const float lambert = FABS(wi.z) * INV_PI_F, share = difftrans_reflected_share(c);
  BsdfValue value;
  value.pdf = (reflects ? share : 1.0f - share) * lambert;
  value.f_cos = scale(select3(reflects, c.diffuse, c.transmitted), lambert);
  return select_bsdf_value((wo.z > 0.0f) & (wi.z != 0.0f), value, no_bsdf_value());
}

FN BsdfSample difftrans_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                               float choice) {
  const vec3 above = cosine_hemisphere(u, v);
  const bool reflects = choice < difftrans_reflected_share(c);
  const vec3 wi = make_vec3(above.x, above.y, reflects ? above.z : -above.z);
  return sample_of_value(wi, difftrans_eval(scene, c, wo, wi));
}

PENUMBRA_NAMESPACE_END
#endif
