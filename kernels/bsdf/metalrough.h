// The metallic-roughness BSDF of glTF 2.0 (appendix B) with KHR_materials_ior, _specular and _clearcoat: GGX
// microfacets on a Lambert base, mixed with a metal of the same microfacets, below a clear coat.
//
// The appendix, which is no norm, weighs base and layer by Schlick's term at the half vector, and so a smooth
// white surface reflects up to twice what arrives at grazing angles. Here the base has what the layer leaves:
// 1 minus the layer's albedo for wo, as in Cycles. What a single reflection loses between microfacets is
// given back (Turquin 2019). A white dielectric then reflects all light, and nothing reflects more than
// arrives. The base's weight depends on wo alone, so that the BSDF is not reciprocal.
//
// Base colour is `diffuse`, the extension's specularColor `specular`, its specular `specular_level`, and the
// coat's roughness `clearcoat_gloss`. `curve` is that of reflection_albedo.
#ifndef PENUMBRA_METALROUGH_H
#define PENUMBRA_METALROUGH_H
#include "kernels/bsdf/disney_lobes.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// Directional albedo of microfacets that reflect all light; and of such that reflect (1 - cos)^5 of it, with
/// the cosine at the half vector.
typedef struct {
  float plain, schlick;
} ReflectionAlbedo;

/// Interpolates rows of curves, as many for `plain` as for `schlick`. Rows are equidistant in the fourth root
/// of the roughness alpha from 0.001 to 1, knots in that of the cosine. The error is below
/// 0.001 from a cosine of 0.01 on.
FN ReflectionAlbedo reflection_albedo(const PRIVATE Scene* scene, Closure c, float alpha, float cosine) {
  const int rows = c.curve_rows / 2, last = max_i(rows - 1, 0);  // lanes of other families may have no rows
  const float least = FIRST_REFLECTION_PLACE, place = SQRT(SQRT(clamp_f(alpha, 0.0f, 1.0f)));
  const float x = max_f((place - least) / (1.0f - least), 0.0f) * (float)last;
  const float y = SQRT(SQRT(clamp_f(cosine, 0.0f, 1.0f))) * (float)(CURVE_KNOTS - 1);
  const int row = min_i((int)x, last), next = min_i(row + 1, last), knot = min_i((int)y, CURVE_KNOTS - 2);
  const float s = x - (float)row, t = y - (float)knot;
  GLOBAL const float* low = scene->curves + (c.curve + row * CURVE_STRIDE + knot);
  GLOBAL const float* high = scene->curves + (c.curve + next * CURVE_STRIDE + knot);
  const int schlick = rows * CURVE_STRIDE;
  ReflectionAlbedo albedo;
  albedo.plain = mix_f(mix_f(low[0], low[1], t), mix_f(high[0], high[1], t), s);
  albedo.schlick =
      mix_f(mix_f(low[schlick], low[schlick + 1], t), mix_f(high[schlick], high[schlick + 1], t), s);
  return albedo;
}

/// The parts that depend on wo alone.
typedef struct {
  Microfacets facets, coat_facets;
  vec3 at_normal, at_horizon;  // Schlick's reflectances of the microfacets
  vec3 base;                   // albedo of the Lambert lobe
  float coat;                  // weight of the coat's microfacets
  DisneyShares shares;         // sampling probabilities
} MetalRough;

FN MetalRough metalrough_of(const PRIVATE Scene* scene, Closure c, float cosine) {
  const vec3 white = make_vec3(1.0f, 1.0f, 1.0f);
  const float dielectric = 1.0f - c.metallic;
  MetalRough m;
  m.facets = disney_microfacets(c.roughness, 0.0f);
  m.coat_facets = disney_microfacets(c.clearcoat_gloss, 0.0f);
  const ReflectionAlbedo albedo = reflection_albedo(scene, c, m.facets.alpha_u, cosine);
  const float lost = (1.0f - albedo.plain) / max_f(albedo.plain, 1e-6f);

  const float level = c.specular_level, f0 = normal_reflectance(c.ior);
  const vec3 tint = make_vec3(level * min_f(f0 * c.specular.x, 1.0f), level * min_f(f0 * c.specular.y, 1.0f),
                              level * min_f(f0 * c.specular.z, 1.0f));
  const vec3 given = add_scaled(white, lost, tint), metal_given = add_scaled(white, lost, c.diffuse);
  const vec3 layer_at_normal = mul(tint, given), layer_at_horizon = scale(given, level);
  const float rest = albedo.plain - albedo.schlick;
  const vec3 layer = add_scaled(scale(layer_at_normal, rest), albedo.schlick, layer_at_horizon);

  m.coat = c.clearcoat * mix_f(CLEARCOAT_REFLECTANCE, 1.0f, schlick_weight(cosine));
  const float below = 1.0f - m.coat;
  m.at_normal = scale(mix3(layer_at_normal, mul(c.diffuse, metal_given), c.metallic), below);
  m.at_horizon = scale(mix3(layer_at_horizon, metal_given, c.metallic), below);
  m.base = scale(c.diffuse, below * dielectric * max_f(1.0f - max_component(layer), 0.0f));
  m.shares = disney_shares(luminance(m.base), m.coat,
                           luminance(m.at_normal) * rest + luminance(m.at_horizon) * albedo.schlick);
  return m;
}

FN BsdfValue metalrough_value(MetalRough m, vec3 wo, vec3 wi) {
  const MicrofacetReflection facets = microfacet_reflection(m.facets, wo, wi);
  const MicrofacetReflection coat = microfacet_reflection(m.coat_facets, wo, wi);
  const vec3 reflected = mix3(m.at_normal, m.at_horizon, schlick_weight(facets.cosine));
  const float lambert = INV_PI_F * wi.z, coat_cos = m.coat * coat.f_cos;
  BsdfValue value;
  value.f_cos = add(add_scaled(scale(m.base, lambert), facets.f_cos, reflected),
                    make_vec3(coat_cos, coat_cos, coat_cos));
  value.pdf = m.shares.diffuse * lambert + m.shares.specular * facets.pdf + m.shares.clearcoat * coat.pdf;
  return select_bsdf_value((wi.z > 0.0f) & (wo.z > 0.0f), value, no_bsdf_value());
}

FN BsdfValue metalrough_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  return metalrough_value(metalrough_of(scene, c, wo.z), wo, wi);
}

FN BsdfSample metalrough_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                float choice) {
  const MetalRough m = metalrough_of(scene, c, wo.z);
  const bool is_coat = choice >= m.shares.diffuse + m.shares.specular;
  Microfacets chosen = m.facets;
  chosen.alpha_u = chosen.alpha_v = is_coat ? m.coat_facets.alpha_u : m.facets.alpha_u;
  const vec3 mirrored = mirror_about(wo, sample_microfacet(chosen, wo, u, v));
  const vec3 wi = select3(choice < m.shares.diffuse, cosine_hemisphere(u, v), mirrored);
  return sample_of_value(wi, metalrough_value(m, wo, wi));
}

/// Without the coat.
FN ControlLobes metalrough_control(const PRIVATE Scene* scene, Closure c, float cosine) {
  const MetalRough m = metalrough_of(scene, c, cosine);
  const MicrofacetLobe lobe = microfacet_lobe(scene, DISTRIBUTION_GGX, m.facets.alpha_u, cosine);
  return make_control_lobes(m.base, lobe, mix3(m.at_normal, m.at_horizon, lobe.schlick));
}

PENUMBRA_NAMESPACE_END
#endif
