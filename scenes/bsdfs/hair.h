// Fibres of hair and fur.
#pragma once

#include <algorithm>

#include "kernels/bsdf/hair_colour.h"
#include "scenes/bsdfs/material.h"
#include "scenes/plugin_values.h"
#include "scenes/refractive_indices.h"

namespace penumbra {

/// Hair of Chiang et al. 2016, see kernels/bsdf/hair.h; with Mitsuba 3's parameters and defaults.
struct HairBsdf {
  static constexpr const char* kPlugin = "hair";
  static constexpr const char* kText = "fibre of hair or fur (Chiang et al. 2016)";
  static constexpr bool kSidesAreAlike = true;
  /// What determines the absorption.
  enum class Absorption { kPigments, kCoefficient, kColour };
  static constexpr float kMostPigment = 1e3f, kMostTilt = 45.0f;
  static constexpr int kFromNormal = 0, kFromV = 1;

  float eumelanin = 1.3f, pheomelanin = 0.2f;
  TexturedColour sigma_a{glm::vec3(0.0f)};
  float scale = 1.0f;
  TexturedColour reflectance{glm::vec3(0.5f)};
  TexturedNumber longitudinal_roughness{0.3f}, azimuthal_roughness{0.3f};
  float scale_tilt = 2.0f;
  float int_ior = 1.55f;
  float ext_ior = 1.000277f;
  int offset = kFromNormal;
  Absorption absorption = Absorption::kPigments;  ///< after `complete`

  template <typename Row>
  static void parameters(const Row& row) {
    const NumberWithin share{LowEnd::kClosed, 0.0f, 1.0f}, pigment{LowEnd::kClosed, 0.0f, kMostPigment};
    row("eumelanin", &HairBsdf::eumelanin, pigment, "concentration of the brown pigment");
    row("pheomelanin", &HairBsdf::pheomelanin, pigment, "concentration of the red pigment");
    row("sigma_a", &HairBsdf::sigma_a, IndexColour{}, "absorption in 1 / radius, instead of pigments");
    row("scale", &HairBsdf::scale, NumberWithin{LowEnd::kClosed, 0.0f, kAnyNumber}, "factor of `sigma_a`");
    row("reflectance", &HairBsdf::reflectance, ColourWithin{},
        "colour of a mass of such hair, instead of pigments; not in Mitsuba");
    row("longitudinal_roughness", &HairBsdf::longitudinal_roughness, share, "roughness along the fibre");
    row("azimuthal_roughness", &HairBsdf::azimuthal_roughness, share, "roughness around it");
    row("scale_tilt", &HairBsdf::scale_tilt, NumberWithin{LowEnd::kClosed, -kMostTilt, kMostTilt},
        "angle of the scales on the fibre, in degrees");
    row("int_ior", &HairBsdf::int_ior, RefractiveIndex{}, "refractive index inside");
    row("ext_ior", &HairBsdf::ext_ior, RefractiveIndex{}, "refractive index outside");
    row("offset", &HairBsdf::offset, OneOf<int>{{{"normal", kFromNormal}, {"v", kFromV}}},
        "where a ray meets the fibre: its normal tells, and v is along the fibre; or u is along it and v "
        "across "
        "it, as in pbrt. Not in Mitsuba");
  }
  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    const bool pigments = given("eumelanin") || given("pheomelanin");
    if (pigments + given("sigma_a") + given("reflectance") > 1)
      findings.push_back({given("sigma_a") ? "sigma_a" : "reflectance",
                          "give either pigments (eumelanin, pheomelanin), or sigma_a, or reflectance"});
    absorption = given("sigma_a")       ? Absorption::kCoefficient
                 : given("reflectance") ? Absorption::kColour
                                        : Absorption::kPigments;
    if (scale != 1.0f && sigma_a.texture != kNoTexture)
      findings.push_back({"scale", "a texture of sigma_a has no scale"});
  }
};

/// The absorption coefficient of pigments in 1 / radius (d'Eon et al. 2011, as in pbrt-v4).
inline glm::vec3 hair_absorption(float eumelanin, float pheomelanin) {
  return eumelanin * glm::vec3(0.419f, 0.697f, 1.37f) + pheomelanin * glm::vec3(0.187f, 0.4f, 1.05f);
}

inline Material material_of(const HairBsdf& hair) {
  Material m = material_of_family(FAMILY_HAIR);
  const bool coloured = hair.absorption == HairBsdf::Absorption::kColour;
  m.variant =
      (hair.offset == HairBsdf::kFromV ? HAIR_OFFSET_BY_V : HAIR_ALONG_V) | (coloured ? HAIR_OF_COLOUR : 0);
  PENUMBRA_SET_FIELD(m, alpha_u, hair.longitudinal_roughness);
  PENUMBRA_SET_FIELD(m, alpha_v, hair.azimuthal_roughness);
  m.ior = hair.int_ior / hair.ext_ior;
  m.tilt = hair.scale_tilt / 360.0f;
  if (coloured) {
    PENUMBRA_SET_FIELD(m, diffuse, hair.reflectance);
    return m;
  }
  TexturedColour absorbed = hair.sigma_a;
  if (hair.absorption == HairBsdf::Absorption::kPigments)
    absorbed = TexturedColour(hair_absorption(hair.eumelanin, hair.pheomelanin));
  else
    absorbed.value *= hair.scale;
  PENUMBRA_SET_FIELD(m, transmitted, absorbed);
  // The colour that belongs to it is for the layer of albedos.
  const float factor = hair_colour_factor(std::max(hair.azimuthal_roughness.value, LEAST_HAIR_ROUGHNESS));
  m.diffuse = to_vec3(glm::exp(-glm::sqrt(absorbed.value) * factor));
  return m;
}

}  // namespace penumbra
