// Test rows of principled BSDFs and Disney's, with bounds from their formulas.
//
// They reflect more light than they receive: the diffuse lobe's retroreflection and the sheen are added to
// what the microfacets reflect. How much, in the red of kBase, is the measured `gain` of a row.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes/bsdfs.h"
#include "tests/kernels/bsdf/bsdf_case.h"

namespace penumbra {

const glm::vec3 kBase(0.8f, 0.35f, 0.1f);
constexpr double kMostTint = 1.9;  // of kBase, by either luminance

/// Of the diffuse lobe and the sheen, over base_color / pi cos. From a direction whose cosine is 1e-7 the
/// flattened lobe is 1.25 over the cosine of the other, which samples have to 2^-12.
inline double most_dull(double roughness, double flatness, double sheen) {
  const double retro = std::max(1.0, 0.5 + 2 * roughness);
  const double flat = flatness > 0 ? flatness * 1.25 * 0x1p12 : 0;
  return 0.8 * (retro * retro + flat) + 3.15 * sheen * kMostTint;
}

inline double least_alpha(double roughness, double anisotropic) {
  return std::max(1e-3, roughness * roughness * std::sqrt(1 - 0.9 * anisotropic));
}

/// The clearcoat's D changes half as fast as that of GGX.
inline double coat_alpha(double clearcoat, double gloss) {
  return clearcoat > 0 ? 2 * (0.1 - 0.099 * gloss) : 1;
}

inline BsdfCase facet_case(const std::string& name, const Material& m, double alpha, double most_weight,
                           double gain) {
  // Of the logarithm of D over the normal's angle: 2 / alpha, and 4 for its cosine.
  return {name, m, most_weight, 2 / alpha + 4, gain, alpha > 0.05, false};
}

inline BsdfCase principled_case(const std::string& name, PrincipledBsdf p, double gain) {
  p.base_color = kBase;
  const double brdf = (1 - p.metallic.value) * (1 - p.spec_trans.value);
  const double bsdf = (1 - p.metallic.value) * p.spec_trans.value;
  const double coat = 0.25 * p.clearcoat.value;
  const double total = p.inside ? 1 : brdf * p.diffuse_rate + coat * p.clearcoat_rate + 1.0 * p.specular_rate;
  const double facets = p.inside ? 1 : total / p.specular_rate;
  // A weight is at most the largest of the lobes' own.
  const double index = p.inside ? 1 / p.eta : p.eta;
  double most = facets * (bsdf < 1 ? kMostTint / (1 - bsdf) : 1);
  if (bsdf > 0) most = std::max(most, facets / (index * index));
  if (brdf > 0)
    most = std::max(
        most, total / p.diffuse_rate * most_dull(p.roughness.value, p.flatness.value, p.sheen.value / brdf));
  if (coat > 0) most = std::max(most, 0.4 * total / p.clearcoat_rate);
  const double alpha = std::min(least_alpha(p.roughness.value, p.anisotropic.value),
                                coat_alpha(p.clearcoat.value, p.clearcoat_gloss.value));
  return facet_case(name, material_of(p), alpha, most, gain);
}

inline BsdfCase principled_inside_case(const std::string& name, const PrincipledBsdf& p) {
  return principled_case(name, *p.other_side(), 1);
}

inline BsdfCase thin_case(const std::string& name, PrincipledThinBsdf p, double gain) {
  p.base_color = kBase;
  const double through = 0.5 * p.diff_trans.value, pane = 0.5 * p.spec_trans.value;
  const double total =
      pane * (p.specular_rate + p.spec_trans_rate) +
      (1 - p.spec_trans.value) * (p.diffuse_rate * (1 - through) + p.diff_trans_rate * through);
  double most = 0;
  if (pane > 0) most = 2 * total * kMostTint / std::min(p.specular_rate, p.spec_trans_rate);
  if (through < 1)
    most = std::max(most,
                    total / p.diffuse_rate * most_dull(p.roughness.value, p.flatness.value, p.sheen.value));
  if (through > 0) most = std::max(most, total / p.diff_trans_rate);
  // What passes is less rough.
  const double alpha = least_alpha(p.roughness.value * std::min(1.0, std::abs(0.65 * p.eta.value - 0.35)),
                                   p.anisotropic.value);
  return facet_case(name, material_of(p), pane > 0 ? alpha : 1, most, gain);
}

inline BsdfCase disney_case(const std::string& name, DisneyBsdf d, double gain) {
  d.base_color = kBase;
  const double dull = 1 - d.metallic.value, total = dull + 0.25 * d.clearcoat.value + 1;
  double most = total * kMostTint;
  if (dull > 0)
    most = std::max(most, total * most_dull(d.roughness.value, d.subsurface.value, d.sheen.value));
  if (d.clearcoat.value > 0) most = std::max(most, 5.2 * total);
  const double alpha = std::min(least_alpha(d.roughness.value, d.anisotropic.value),
                                coat_alpha(d.clearcoat.value, d.clearcoat_gloss.value));
  return facet_case(name, material_of(d), alpha, most, gain);
}

inline std::vector<BsdfCase> disney_cases() {
  const PrincipledBsdf metal{.roughness = 0.4f, .anisotropic = 0.9f, .metallic = 1.0f};
  const PrincipledBsdf coated{.roughness = 0.6f, .specular = 0.5f, .clearcoat = 1.0f};
  const PrincipledBsdf cloth{.roughness = 1.0f, .sheen = 1.0f, .sheen_tint = 0.5f, .flatness = 0.7f};
  const PrincipledBsdf glass{.roughness = 0.55f, .spec_trans = 1.0f};
  const PrincipledBsdf mixed{.roughness = 0.7f,
                             .anisotropic = 0.5f,
                             .metallic = 0.3f,
                             .spec_trans = 0.5f,
                             .eta = 1.33f,
                             .spec_tint = 0.5f,
                             .clearcoat = 0.5f,
                             .specular_rate = 0.7f,
                             .diffuse_rate = 2.0f,
                             .clearcoat_rate = 3.0f};
  const PrincipledBsdf thinner{.roughness = 0.6f, .spec_trans = 0.8f, .eta = 0.7f, .spec_tint = 0.2f};
  const PrincipledBsdf sharp{.roughness = 0.01f, .clearcoat = 1.0f, .clearcoat_gloss = 1.0f};
  const PrincipledBsdf sharp_glass{.roughness = 1e-4f, .spec_trans = 0.9f};
  const PrincipledThinBsdf paper{.roughness = 0.8f, .sheen = 0.5f, .flatness = 0.5f, .diff_trans = 1.2f};
  const PrincipledThinBsdf pane{.roughness = 0.7f, .spec_trans = 1.0f, .eta = 1.8f};
  const PrincipledThinBsdf leaf{.roughness = 0.7f,
                                .anisotropic = 0.4f,
                                .spec_trans = 0.5f,
                                .eta = 1.6f,
                                .spec_tint = 0.7f,
                                .diff_trans = 0.6f,
                                .diffuse_rate = 0.5f,
                                .diff_trans_rate = 2.0f,
                                .specular_rate = 3.0f};
  const DisneyBsdf disney_metal{.metallic = 1.0f, .roughness = 0.5f, .anisotropic = 0.8f};
  const DisneyBsdf disney_cloth{.subsurface = 1.0f, .specular_tint = 1.0f, .roughness = 0.9f, .sheen = 1.0f};
  const DisneyBsdf disney_coat{.roughness = 0.7f, .clearcoat = 1.0f, .clearcoat_gloss = 0.0f};
  const DisneyBsdf disney_sharp{.metallic = 0.5f, .roughness = 1e-4f, .clearcoat = 1.0f};
  DisneySumParameters half_glass;  // what beside its glass is there
  half_glass.specular_transmission = 0.5f;
  half_glass.sheen = 0.5f;
  half_glass.clearcoat = 0.5f;
  return {
      principled_case("Principled", {}, 1),
      principled_case("PrincipledMetal", metal, 1),
      principled_case("PrincipledCoat", coated, 1.03),
      principled_case("PrincipledCloth", cloth, 1.4),
      principled_case("PrincipledGlass", glass, 1),
      principled_inside_case("PrincipledGlassInside", glass),
      principled_case("PrincipledMixed", mixed, 1),
      principled_inside_case("PrincipledMixedInside", mixed),
      principled_case("PrincipledThinner", thinner, 1),
      principled_case("PrincipledSharp", sharp, 1.5),
      principled_case("PrincipledSharpGlass", sharp_glass, 1.5),
      principled_inside_case("PrincipledSharpGlassInside", sharp_glass),
      thin_case("ThinSheet", {}, 1),
      thin_case("ThinPaper", paper, 1),
      thin_case("ThinPane", pane, 1),
      thin_case("ThinLeaf", leaf, 1),
      disney_case("Disney", {}, 1),
      disney_case("DisneyMetal", disney_metal, 1),
      disney_case("DisneyCloth", disney_cloth, 1.33),
      disney_case("DisneyCoat", disney_coat, 1.13),
      disney_case("DisneySharp", disney_sharp, 1.5),
      disney_case("LajollaDiffuse", DisneyDiffuseParameters{}.model(), 1.2),
      disney_case("LajollaClearcoat", DisneyClearcoatParameters{TexturedNumber(0.0f)}.model(), 1.1),
      disney_case("LajollaSum", half_glass.model(), 1.4),
  };
}

}  // namespace penumbra
