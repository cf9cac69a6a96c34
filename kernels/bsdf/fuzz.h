// The fuzz of OpenPBR's surface: the sheen of Zeltner, Burley and Chiang 2022, a transformed cosine whose
// numbers are in curves (scenes/bsdfs/sheen_table.h). That of glTF (KHR_materials_sheen): Estevez and Kulla
// 2017
// ("Production friendly microfacet sheen BRDF"), with the square of the roughness and without their change
// near the terminator.
#ifndef PENUMBRA_FUZZ_H
#define PENUMBRA_FUZZ_H
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/ltc.h"
#include "kernels/math/math.h"

PENUMBRA_NAMESPACE_BEGIN

#define LEAST_FUZZ_COSINE 1e-4f  // the fit is for larger ones

/// The lobe towards the viewer. The matrix to cosines has the rows (narrow, 0, lean), (0, narrow, 0), (0, 0,
/// 1), with the x axis on the viewer's side.
FN Ltc fuzz_ltc(float narrow, float lean) {
  Ltc lobe;
  lobe.width_x = lobe.width_y = 1.0f / max_f(narrow, 1e-3f);
  lobe.shift = lean * lobe.width_x;  // along the mirror direction
  return lobe;
}
/// The pdf of unit directions wi above the horizon.
FN float fuzz_pdf(Ltc lobe, vec3 wo, vec3 wi) {
  return ltc_density_over_cosine(lobe, to_lobe_frame(wo, wi)) * wi.z;
}
FN vec3 sample_fuzz(Ltc lobe, vec3 wo, vec3 cosine) {
  return from_lobe_frame(wo, normalize3(from_cosine_space(lobe, cosine)));
}

FN float fuzz_alpha(float roughness) { return sqr(max_f(roughness, LEAST_FUZZ_ROUGHNESS)); }

/// Smith's Lambda by the authors' fit, for a cosine in (0, 1].
FN float fuzz_lambda(float alpha, float cosine) {
  const float w = sqr(1.0f - alpha), x = cosine < 0.5f ? cosine : 1.0f - cosine;
  const float a = mix_f(21.5473f, 25.3245f, w), b = mix_f(3.82987f, 3.32435f, w);
  const float c = mix_f(0.19823f, 0.16801f, w), d = mix_f(-1.97760f, -1.27393f, w);
  const float e = mix_f(-4.32054f, -4.85967f, w);
  const float l = a / (1.0f + b * exp_f(c * log_f(max_f(x, 1e-6f)))) + d * x + e;
  const float middle = a / (1.0f + b * exp_f(c * -0.693147181f)) + 0.5f * d + e;  // at a half
  return exp_f(cosine < 0.5f ? l : 2.0f * middle - l);
}

/// V, the masking over 4 cos_o cos_i, for cosines in (0, 1].
FN float fuzz_visibility(float alpha, float cos_o, float cos_i) {
  const float o = max_f(cos_o, LEAST_FUZZ_COSINE), i = max_f(cos_i, LEAST_FUZZ_COSINE);
  return 0.25f / ((1.0f + fuzz_lambda(alpha, o) + fuzz_lambda(alpha, i)) * (o * i));
}

/// D V, for unit directions above the horizon with half vector h.
FN float fuzz_lobe(float roughness, float cos_o, float cos_i, float cos_h) {
  const float alpha = fuzz_alpha(roughness), inverse = 1.0f / alpha;
  const float sine2 = max_f(1.0f - cos_h * cos_h, 1e-12f);
  const float density = (2.0f + inverse) * (0.5f * INV_PI_F) * exp_f(0.5f * inverse * log_f(sine2));
  return density * fuzz_visibility(alpha, cos_o, cos_i);
}

PENUMBRA_NAMESPACE_END
#endif
