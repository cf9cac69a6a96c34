// The lobes of Disney's BSDF and their sum as lajolla has them (UCSD's CSE 272, github.com/BachiLi/
// lajolla_public; the formulas are those of its homework 1). They become Penumbra's `disney` and
// `roughdielectric`.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/bsdfs/dielectric.h"
#include "scenes/bsdfs/disney.h"
#include "scenes/plugin_values.h"

namespace penumbra {

/// Reflectance along the normal for a relative refractive index (Schlick 1994).
inline float normal_reflectance_of(float eta) { return std::pow((eta - 1.0f) / (eta + 1.0f), 2.0f); }

/// Reports a texture that would replace a number which model() computes with. `where`: "a disneyglass takes
/// no texture".
template <typename Textured>
void refuse_texture(Findings& findings, const char* name, const Textured& value, const char* where) {
  if (value.texture != kNoTexture) findings.push_back({name, fmt::format("{} of {}", name, where)});
}

/// The indices that lajolla's parameter `eta` may have.
inline NumberWithin lajolla_eta() { return {LowEnd::kClosed, 1.0f, 2.0f}; }

struct DisneyDiffuseParameters {
  static constexpr const char* kPlugin = "disneydiffuse";
  static constexpr const char* kText = "diffuse lobe of lajolla's disneybsdf";
  TexturedColour base_color{glm::vec3(0.5f)};
  TexturedNumber roughness{0.5f}, subsurface{};

  template <typename Row>
  static void parameters(const Row& row) {
    using P = DisneyDiffuseParameters;
    row("base_color", &P::base_color, ColourWithin{}, "albedo, but for what grazing angles change");
    row("roughness", &P::roughness, NumberWithin{}, "how much it reflects back");
    row("subsurface", &P::subsurface, NumberWithin{}, "from diffuse to like scattering beneath the surface");
  }
  [[nodiscard]] DisneyBsdf model() const {
    DisneyBsdf lobe;
    lobe.base_color = base_color;
    lobe.roughness = roughness;
    lobe.subsurface = subsurface;
    lobe.microfacets = false;
    return lobe;
  }
};

struct DisneyMetalParameters {
  static constexpr const char* kPlugin = "disneymetal";
  static constexpr const char* kText = "metallic lobe of lajolla's disneybsdf";
  TexturedColour base_color{glm::vec3(0.5f)};
  TexturedNumber roughness{0.5f}, anisotropic{};

  template <typename Row>
  static void parameters(const Row& row) {
    using P = DisneyMetalParameters;
    row("base_color", &P::base_color, ColourWithin{}, "reflectance along the normal");
    row("roughness", &P::roughness, NumberWithin{}, "of the microfacets: their alpha is its square");
    row("anisotropic", &P::anisotropic, NumberWithin{}, "how much longer highlights are along the tangent");
  }
  [[nodiscard]] DisneyBsdf model() const {
    DisneyBsdf lobe;
    lobe.base_color = base_color;
    lobe.roughness = roughness;
    lobe.anisotropic = anisotropic;
    lobe.metallic = TexturedNumber(1.0f);
    return lobe;
  }
};

struct DisneyClearcoatParameters {
  static constexpr const char* kPlugin = "disneyclearcoat";
  static constexpr const char* kText = "clearcoat of lajolla's disneybsdf, at full strength";
  TexturedNumber clearcoat_gloss{1.0f};

  template <typename Row>
  static void parameters(const Row& row) {
    row("clearcoat_gloss", &DisneyClearcoatParameters::clearcoat_gloss, NumberWithin{},
        "from a satin to a glossy clearcoat");
  }
  [[nodiscard]] DisneyBsdf model() const {
    DisneyBsdf lobe;
    lobe.clearcoat = TexturedNumber(4.0f);  // `disney` has a quarter of it
    lobe.clearcoat_gloss = clearcoat_gloss;
    lobe.diffuse_weight = 0.0f;
    lobe.microfacets = false;
    return lobe;
  }
};

struct DisneySheenParameters {
  static constexpr const char* kPlugin = "disneysheen";
  static constexpr const char* kText = "sheen of lajolla's disneybsdf";
  TexturedColour base_color{glm::vec3(0.5f)};
  TexturedNumber sheen_tint{0.5f};

  template <typename Row>
  static void parameters(const Row& row) {
    row("base_color", &DisneySheenParameters::base_color, ColourWithin{}, "whose hue the sheen may have");
    row("sheen_tint", &DisneySheenParameters::sheen_tint, NumberWithin{}, "how much it has that hue");
  }
  [[nodiscard]] DisneyBsdf model() const {
    DisneyBsdf lobe;
    lobe.base_color = base_color;
    lobe.sheen = TexturedNumber(1.0f);
    lobe.sheen_tint = sheen_tint;
    lobe.diffuse_weight = 0.0f;
    lobe.microfacets = false;
    lobe.luminance_tint = true;
    return lobe;
  }
};

struct DisneyGlassParameters {
  static constexpr const char* kPlugin = "disneyglass";
  static constexpr const char* kText = "rough boundary of coloured glass, of lajolla's disneybsdf";
  TexturedColour base_color{glm::vec3(0.5f)};
  TexturedNumber roughness{0.5f}, anisotropic{};
  float eta = 1.5f;

  template <typename Row>
  static void parameters(const Row& row) {
    using P = DisneyGlassParameters;
    row("base_color", &P::base_color, ColourWithin{}, "factor of reflection; of refraction its square root");
    row("roughness", &P::roughness, NumberWithin{}, "of the microfacets: their alpha is its square");
    row("anisotropic", &P::anisotropic, NumberWithin{}, "how much longer highlights are along the tangent");
    row("eta", &P::eta, lajolla_eta(), "refractive index inside over that outside");
  }
  void complete(Findings& findings) const {
    constexpr const char* kWhere = "a disneyglass, or of a disneybsdf that transmits, takes no texture here";
    refuse_texture(findings, "base_color", base_color, kWhere);
    refuse_texture(findings, "roughness", roughness, kWhere);
    refuse_texture(findings, "anisotropic", anisotropic, kWhere);
  }
  [[nodiscard]] RoughDielectricBsdf model() const {
    RoughDielectricBsdf glass;
    glass.distribution = DISTRIBUTION_GGX;
    const float square = roughness.value * roughness.value;
    const float aspect = std::sqrt(1.0f - 0.9f * anisotropic.value);
    glass.alpha_u = TexturedNumber(square / aspect);
    glass.alpha_v = TexturedNumber(square * aspect);
    glass.int_ior = eta;
    glass.ext_ior = 1.0f;
    glass.specular_reflectance = base_color;
    glass.specular_transmittance = TexturedColour(glm::sqrt(base_color.value));
    return glass;
  }
};

/// The sum of all lobes. The share `transmission()` is glass, the rest is the model().
struct DisneySumParameters {
  static constexpr const char* kPlugin = "disneybsdf";
  static constexpr const char* kText = "lajolla's Disney BSDF (Burley 2012, with the glass of Burley 2015)";
  TexturedColour base_color{glm::vec3(0.5f)};
  TexturedNumber specular_transmission{}, metallic{}, subsurface{};
  TexturedNumber specular{0.5f};
  TexturedNumber roughness{0.5f};
  TexturedNumber specular_tint{}, anisotropic{}, sheen{};
  TexturedNumber sheen_tint{0.5f};
  TexturedNumber clearcoat{};
  TexturedNumber clearcoat_gloss{1.0f};
  float eta = 1.5f;

  template <typename Row>
  static void parameters(const Row& row) {
    using P = DisneySumParameters;
    row("base_color", &P::base_color, ColourWithin{}, "colour of the material");
    row("specular_transmission", &P::specular_transmission, NumberWithin{},
        "how much of the dielectric transmits");
    row("metallic", &P::metallic, NumberWithin{}, "from a dielectric to a metal");
    row("subsurface", &P::subsurface, NumberWithin{}, "from diffuse to like scattering beneath the surface");
    row("specular", &P::specular, NumberWithin{}, "factor of what eta reflects along the normal");
    row("roughness", &P::roughness, NumberWithin{}, "of the microfacets: their alpha is its square");
    row("specular_tint", &P::specular_tint, NumberWithin{}, "how much that reflection has the base colour");
    row("anisotropic", &P::anisotropic, NumberWithin{}, "how much longer highlights are along the tangent");
    row("sheen", &P::sheen, NumberWithin{}, "of cloth, at grazing angles");
    row("sheen_tint", &P::sheen_tint, NumberWithin{}, "how much the sheen has the base colour");
    row("clearcoat", &P::clearcoat, NumberWithin{}, "of a second, colourless reflection");
    row("clearcoat_gloss", &P::clearcoat_gloss, NumberWithin{}, "from a satin to a glossy clearcoat");
    row("eta", &P::eta, lajolla_eta(), "refractive index inside over that outside");
  }
  [[nodiscard]] bool transmits() const {
    return specular_transmission.value > 0.0f && (metallic.value < 1.0f || metallic.texture != kNoTexture);
  }
  void complete(Findings& findings) const {
    constexpr const char* kWhere = "a disneybsdf takes a number here, no texture";
    constexpr const char* kTransmitting = "a disneybsdf that transmits takes no texture here";
    refuse_texture(findings, "specular", specular, kWhere);
    if (!transmits()) return;
    refuse_texture(findings, "sheen", sheen, kWhere);
    refuse_texture(findings, "clearcoat", clearcoat, kWhere);
    refuse_texture(findings, "specular_transmission", specular_transmission, kTransmitting);
    refuse_texture(findings, "metallic", metallic, kTransmitting);
    glass().complete(findings);
    if (whole_transmission() > kMostGlass && (sheen.value > 0.0f || clearcoat.value > 0.0f))
      findings.push_back({"specular_transmission",
                          fmt::format("under a sheen or a clearcoat at most {} of it transmits", kMostGlass),
                          true});
  }
  /// The share of the glass.
  [[nodiscard]] float transmission() const { return std::min(whole_transmission(), most_glass()); }
  [[nodiscard]] DisneyGlassParameters glass() const { return {base_color, roughness, anisotropic, eta}; }
  /// The other lobes, over 1 - transmission().
  [[nodiscard]] DisneyBsdf model() const {
    const float rest = std::max(1.0f - transmission(), 1.0f - kMostGlass);
    DisneyBsdf lobes;
    lobes.base_color = base_color;
    lobes.metallic = metallic;
    lobes.subsurface = subsurface;
    lobes.specular = specular;
    lobes.specular.value *= normal_reflectance_of(eta) / 0.08f;
    lobes.roughness = roughness;
    lobes.specular_tint = specular_tint;
    lobes.anisotropic = anisotropic;
    lobes.sheen = sheen;
    lobes.sheen.value /= rest;
    lobes.sheen_tint = sheen_tint;
    lobes.clearcoat = clearcoat;
    lobes.clearcoat.value /= rest;
    lobes.clearcoat_gloss = clearcoat_gloss;
    lobes.diffuse_weight = transmits() ? (1.0f - specular_transmission.value) / rest : 1.0f;
    lobes.luminance_tint = true;
    return lobes;
  }

 private:
  /// A blend has no room for lobes beside one whose share is 1.
  static constexpr float kMostGlass = 63.0f / 64.0f;
  [[nodiscard]] float whole_transmission() const {
    return transmits() ? specular_transmission.value * (1.0f - metallic.value) : 0.0f;
  }
  [[nodiscard]] float most_glass() const {
    return sheen.value > 0.0f || clearcoat.value > 0.0f ? kMostGlass : 1.0f;
  }
};

}  // namespace penumbra
