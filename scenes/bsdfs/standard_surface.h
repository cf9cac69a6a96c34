// Autodesk's Standard Surface 1.0.1 (Georgiev et al. 2019) as parameters of an OpenPBR surface, by the
// translation graph of MaterialX 1.39 (standard_surface_to_open_pbr_surface), but for
// `transmission_dispersion`, which is an Abbe number as in the former. Readers of names take `specular_IOR`
// for `specular_ior`, and so on.
#pragma once

#include <algorithm>
#include <cmath>

#include "scenes/bsdfs/openpbr.h"
#include "scenes/plugin_values.h"

namespace penumbra {

struct StandardSurfaceParameters {
  static constexpr const char* kPlugin = "standard_surface";
  static constexpr const char* kText = "Standard Surface (Autodesk), as an openpbr";
  TexturedNumber base{1.0f};
  TexturedColour base_color{glm::vec3(0.8f)};
  TexturedNumber diffuse_roughness{}, metalness{};
  TexturedNumber specular{1.0f};
  TexturedColour specular_color{glm::vec3(1.0f)};
  TexturedNumber specular_roughness{0.2f}, specular_anisotropy{};
  float specular_ior = 1.5f;
  TexturedNumber transmission{};
  TexturedColour transmission_color{glm::vec3(1.0f)};
  float transmission_dispersion = 0.0f;  ///< Abbe number; 0: none
  TexturedNumber sheen{};
  TexturedColour sheen_color{glm::vec3(1.0f)};
  TexturedNumber sheen_roughness{0.3f};
  TexturedNumber coat{};
  TexturedColour coat_color{glm::vec3(1.0f)};
  TexturedNumber coat_roughness{0.1f};
  float coat_ior = 1.5f, coat_affect_roughness = 0.0f;
  float thin_film_thickness = 0.0f;  ///< nanometres; 0: no film
  float thin_film_ior = 1.5f;
  TexturedNumber opacity{1.0f};
  bool thin_walled = false;

  template <typename Row>
  static void parameters(const Row& row) {
    using S = StandardSurfaceParameters;
    constexpr NumberWithin kIndex{LowEnd::kClosed, 1.0f, kAnyNumber};
    row("base", &S::base, NumberWithin{}, "factor of the base's colour");
    row("base_color", &S::base_color, ColourWithin{}, "of the base and of the metal");
    row("diffuse_roughness", &S::diffuse_roughness, NumberWithin{}, "of the diffuse base");
    row("metalness", &S::metalness, NumberWithin{}, "from a dielectric to a metal");
    row("specular", &S::specular, NumberWithin{}, "factor of what a dielectric reflects along the normal");
    row("specular_color", &S::specular_color, ColourWithin{}, "factor of the dielectric's reflection");
    row("specular_roughness", &S::specular_roughness, NumberWithin{}, "of the microfacets");
    row("specular_ior", &S::specular_ior, kIndex, "refractive index");
    row("specular_anisotropy", &S::specular_anisotropy, NumberWithin{},
        "how much longer highlights are along the tangent");
    row("transmission", &S::transmission, NumberWithin{}, "how much of the dielectric transmits");
    row("transmission_color", &S::transmission_color, ColourWithin{}, "of light that went in and out");
    row("transmission_dispersion", &S::transmission_dispersion,
        NumberWithin{LowEnd::kClosed, 0.0f, kAnyNumber}, "Abbe number; 0: no dispersion");
    row("sheen", &S::sheen, NumberWithin{}, "how much of the surface has a sheen");
    row("sheen_color", &S::sheen_color, ColourWithin{}, "of the sheen");
    row("sheen_roughness", &S::sheen_roughness, NumberWithin{}, "of the sheen");
    row("coat", &S::coat, NumberWithin{}, "how much of a dielectric has a coat");
    row("coat_color", &S::coat_color, ColourWithin{}, "of light that went through the coat");
    row("coat_roughness", &S::coat_roughness, NumberWithin{}, "of the coat");
    row("coat_ior", &S::coat_ior, kIndex, "refractive index of the coat");
    row("coat_affect_roughness", &S::coat_affect_roughness, NumberWithin{}, "how much the coat darkens");
    row("thin_film_thickness", &S::thin_film_thickness,
        NumberWithin{LowEnd::kClosed, 0.0f, 1e3f * OpenPbrBsdf::kMostFilm}, "nanometres; 0: no film");
    row("thin_film_ior", &S::thin_film_ior, kIndex, "refractive index of the film");
    row("opacity", &S::opacity, NumberWithin{}, "how much of the surface there is");
    row("thin_walled", &S::thin_walled, TrueOrFalse{}, "whether it is a sheet without an inside");
  }

  template <typename Given>
  void complete(Findings& findings, const Given&) {
    if (transmission_dispersion > 0.0f && transmission_dispersion < kLeastAbbe)
      findings.push_back(
          {"transmission_dispersion", "an Abbe number is at least 1, or 0 without dispersion"});
  }

  [[nodiscard]] OpenPbrBsdf as_openpbr() const {
    const auto there = [](const TexturedNumber& n) { return n.value > 0.0f || n.texture != kNoTexture; };
    OpenPbrBsdf surface;
    surface.base_weight = base;
    surface.base_color = base_color;
    const float coated = coat.texture == kNoTexture ? coat.value : 1.0f;
    surface.base_color.value *= glm::mix(glm::vec3(1.0f), coat_color.value, coated);
    surface.base_diffuse_roughness = diffuse_roughness;
    surface.base_metalness = metalness;
    surface.specular_weight = there(metalness) ? TexturedNumber(1.0f) : specular;
    const bool black = specular_color == TexturedColour(glm::vec3(0.0f));
    surface.specular_color = black ? TexturedColour(glm::vec3(1.0f)) : specular_color;
    surface.specular_roughness = specular_roughness;
    surface.specular_anisotropy = specular_anisotropy;
    surface.specular_ior = specular_ior;
    surface.transmission_weight = transmission;
    surface.transmission_color = transmission_color;
    if (transmission_dispersion > 0.0f) {
      surface.dispersion_scale = 1.0f;
      surface.dispersion_abbe = transmission_dispersion;
    }
    surface.fuzz_weight = sheen;
    surface.fuzz_color = sheen_color;
    surface.fuzz_roughness = sheen_roughness;
    surface.fuzz_roughness.value = std::pow(sheen_roughness.value, 0.4f);
    if (!there(metalness)) surface.coat_weight = coat;
    surface.coat_color = coat_color;
    surface.coat_roughness = coat_roughness;
    surface.coat_ior = coat_ior;
    surface.coat_darkening = coat_affect_roughness;
    surface.film_weight = TexturedNumber(thin_film_thickness > 0.0f ? 1.0f : 0.0f);
    surface.film_thickness = TexturedNumber(1e-3f * thin_film_thickness);
    surface.film_ior = thin_film_ior;
    surface.thin_walled = thin_walled;
    return surface;
  }
};

}  // namespace penumbra
