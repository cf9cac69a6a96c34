// A diffuse base under a smooth dielectric boundary (Mitsuba's plastic): a mirror with the boundary's
// reflectance F, and f = d (1 - F(wo)) (1 - F(wi)) / (pi ior^2 (1 - internal)). The last factor accounts for
// light that is reflected back inside and scatters again and again; it has d internal in place of internal if
// the variant is PLASTIC_NONLINEAR. A coating below the boundary, of optical depth `diffuse_rate` along its
// normal, absorbs exp(-depth / cosine) of each way through it; `internal` includes that.
#ifndef PENUMBRA_PLASTIC_H
#define PENUMBRA_PLASTIC_H
#include "kernels/bsdf/control_lobes.h"
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/fresnel.h"
#include "kernels/math/frame.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// pi f of the base for a boundary with a transmittance of 1 in each direction.
FN vec3 base_reflectance(Closure c) {
  const vec3 tint = select3(c.variant == PLASTIC_NONLINEAR, c.diffuse, make_vec3(1.0f, 1.0f, 1.0f));
  const float ior2 = c.ior * c.ior;
  return make_vec3(c.diffuse.x / (ior2 * (1.0f - c.internal * tint.x)),
                   c.diffuse.y / (ior2 * (1.0f - c.internal * tint.y)),
                   c.diffuse.z / (ior2 * (1.0f - c.internal * tint.z)));
}

/// Probability of sampling the boundary's reflection, where its transmittance for wo is `through`: by the
/// mean reflectances.
FN float boundary_share(Closure c, float through) {
  const float boundary = (1.0f - through) * ((c.specular.x + c.specular.y) + c.specular.z);
  const float sum = boundary + through * ((c.diffuse.x + c.diffuse.y) + c.diffuse.z);
  return sum > 0.0f ? boundary / sum : 0.0f;
}

/// What the boundary lets through, and what is left of that beneath the coating.
typedef struct {
  float boundary, coating;
} SmoothTransmittance;
FN SmoothTransmittance smooth_transmittance(Closure c, float cosine) {
  const DielectricFresnel f = dielectric_fresnel(max_f(cosine, 0.0f), c.ior);
  SmoothTransmittance t;
  t.boundary = 1.0f - f.reflectance;
  t.coating = t.boundary * exp_f(-c.diffuse_rate / max_f(f.cosine, 1e-6f));
  return t;
}

FN BsdfValue plastic_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = (wi.z > 0.0f) & (wo.z > 0.0f);
  const SmoothTransmittance out = smooth_transmittance(c, wo.z), in = smooth_transmittance(c, wi.z);
  const float lambert = wi.z * INV_PI_F;
  BsdfValue value;
  value.f_cos = scale(base_reflectance(c), (out.coating * in.coating) * lambert);
  value.pdf = (1.0f - boundary_share(c, out.boundary)) * lambert;
  return select_bsdf_value(reflects, value, no_bsdf_value());
}

FN BsdfSample plastic_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, float choice) {
  const SmoothTransmittance out = smooth_transmittance(c, wo.z);
  const float share = boundary_share(c, out.boundary);
  const bool mirrors = choice < share;
  const vec3 mirrored = make_vec3(-wo.x, -wo.y, wo.z), scattered = cosine_hemisphere(u, v);
  BsdfSample s = no_bsdf_sample();
  s.wi = select3(mirrors, mirrored, scattered);
  s.pdf = mirrors ? DELTA_PDF : (1.0f - share) * (scattered.z * INV_PI_F);
  const vec3 mirror = scale(c.specular, (1.0f - out.boundary) / (share > 0.0f ? share : 1.0f));
  const float in = smooth_transmittance(c, scattered.z).coating;
  const vec3 base = scale(base_reflectance(c), out.coating * in / max_f(1.0f - share, 1e-30f));
  s.weight = select3(mirrors, mirror, base);
  return select_bsdf_sample(wo.z > 0.0f, s, no_bsdf_sample());
}

/// The base as a Lambert lobe, for a wo with boundary transmittance `through`. The boundary's transmittance
/// for uniform light from outside is that for diffuse light from inside, times ior^2.
FN vec3 base_as_lambert(Closure c, float through) {
  const float around = min_f((1.0f - c.internal) * (c.ior * c.ior), 1.0f);
  return scale(base_reflectance(c), through * around);
}

/// The mirror has no control lobe; its directions are sampled by the BSDF.
FN ControlLobes plastic_control(const PRIVATE Scene* scene, Closure c, float cosine) {
  ControlLobes lobes = no_control_lobes();
  lobes.diffuse = base_as_lambert(c, smooth_transmittance(c, cosine).coating);
  return lobes;
}

PENUMBRA_NAMESPACE_END
#endif
