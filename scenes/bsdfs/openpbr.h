// The surface of OpenPBR 1.1 (Academy Software Foundation), see kernels/bsdf/openpbr.h.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "kernels/bsdf/microfacet.h"
#include "scenes/bsdfs/facet_albedo.h"
#include "scenes/bsdfs/material.h"
#include "scenes/bsdfs/material_tables.h"
#include "scenes/plugin_values.h"
#include "scenes/refractive_indices.h"

namespace penumbra {

/// Two values that stand for the roughnesses alpha of microfacets along the tangent and across it.
struct OpenPbrRoughness {
  float roughness = 0, anisotropy = 0;
};
/// For `across` <= `along` <= 1, `along` above 0: the inverse of openpbr_microfacets.
inline OpenPbrRoughness along_and_across(double along, double across) {
  const double ratio = across / along;
  return {float(std::sqrt(along * std::sqrt((1 + ratio * ratio) / 2))), float(1 - ratio)};
}

struct OpenPbrBsdf {
  static constexpr float kMostFilm = 1e4f;  ///< micrometres
  static constexpr const char* kPlugin = "openpbr";
  static constexpr const char* kText = "OpenPBR surface (Academy Software Foundation)";
  TexturedNumber base_weight{1.0f};
  TexturedColour base_color{glm::vec3(0.8f)};
  TexturedNumber base_diffuse_roughness{}, base_metalness{};
  TexturedNumber specular_weight{1.0f};
  TexturedColour specular_color{glm::vec3(1.0f)};
  bool specular_color_fades = false;
  bool coat_roughens = true;
  TexturedNumber specular_roughness{0.3f}, specular_anisotropy{};
  bool gltf = false;
  float specular_ior = 1.5f;  ///< inside over outside
  TexturedNumber transmission_weight{};
  TexturedColour transmission_color{glm::vec3(1.0f)};
  float transmission_depth = 0.0f;  ///< 0: the colour is that of the surface
  /// The colour inside, if that of transmission is the surface's nevertheless, as in glTF.
  std::optional<glm::vec3> attenuation{};
  glm::vec3 transmission_scatter{0.0f};
  float transmission_anisotropy = 0.0f;
  TexturedNumber subsurface_weight{};
  TexturedColour subsurface_color{glm::vec3(0.8f)};
  float subsurface_radius = 1.0f;
  glm::vec3 subsurface_radius_scale{1.0f, 0.5f, 0.25f};
  float subsurface_anisotropy = 0.0f;
  float dispersion_scale = 0.0f, dispersion_abbe = 20.0f;  ///< the Abbe number is that over the scale
  TexturedNumber film_weight{};
  TexturedNumber film_thickness{0.5f};        ///< micrometres; a texture is its place between these:
  float film_least = 0.0f, film_most = 1.0f;  ///< micrometres
  float film_ior = 1.4f;
  TexturedNumber coat_weight{};
  TexturedColour coat_color{glm::vec3(1.0f)};
  TexturedNumber coat_roughness{};
  float coat_ior = 1.6f, coat_darkening = 1.0f;
  TexturedNumber fuzz_weight{};
  TexturedColour fuzz_color{glm::vec3(1.0f)};
  TexturedNumber fuzz_roughness{0.5f};
  bool thin_walled = false;
  bool inside = false;  ///< whether this is the BSDF of the inner side
  /// Bound of the mean cosines of scattering inside.
  static constexpr float kMostAnisotropy = 0.99f;

  template <typename Row>
  static void parameters(const Row& row) {
    using O = OpenPbrBsdf;
    constexpr NumberWithin kIndex{LowEnd::kClosed, 1.0f, kAnyNumber},
        kLength{LowEnd::kClosed, 0.0f, kAnyNumber};
    constexpr NumberWithin kCosine{LowEnd::kClosed, -kMostAnisotropy, kMostAnisotropy};
    row("base_weight", &O::base_weight, NumberWithin{}, "factor of the base's colour");
    row("base_color", &O::base_color, ColourWithin{},
        "of the diffuse base and of the metal along the normal");
    row("base_diffuse_roughness", &O::base_diffuse_roughness, NumberWithin{}, "of the diffuse base");
    row("base_metalness", &O::base_metalness, NumberWithin{}, "from a dielectric to a metal");
    row("specular_weight", &O::specular_weight, NumberWithin{LowEnd::kClosed, 0.0f, kAnyNumber},
        "factor of what is reflected along the normal, by another index; of all that a metal reflects");
    row("specular_color", &O::specular_color, ColourWithin{0.0f, kAnyNumber},
        "factor of the dielectric's reflection; of the metal's at grazing angles; at most 1, unless glTF's");
    row("specular_color_fades", &O::specular_color_fades, TrueOrFalse{},
        "whether the dielectric's reflection becomes white at grazing angles, as in glTF");
    row("specular_roughness", &O::specular_roughness, NumberWithin{},
        "of the microfacets: their alpha is its square");
    row("specular_roughness_anisotropy", &O::specular_anisotropy, NumberWithin{},
        "how much longer highlights are along the tangent");
    row("gltf", &O::gltf, TrueOrFalse{},
        "whether anisotropy, specular and fuzz have the meaning of glTF's extensions");
    row("specular_ior", &O::specular_ior, kIndex, "refractive index of the dielectric");
    row("transmission_weight", &O::transmission_weight, NumberWithin{},
        "how much of the dielectric transmits instead of reflecting diffusely");
    row("transmission_color", &O::transmission_color, ColourWithin{}, "of light that went in and out");
    row("transmission_depth", &O::transmission_depth, kLength,
        "way along which light takes on that colour inside; 0: it does so at the surface");
    row("transmission_scatter", &O::transmission_scatter, ColourWithin{},
        "scattering coefficient inside, times the depth");
    row("transmission_scatter_anisotropy", &O::transmission_anisotropy, kCosine,
        "mean cosine of that scattering");
    row("transmission_dispersion_scale", &O::dispersion_scale, NumberWithin{},
        "how much of the dispersion there is; not of sheets");
    row("transmission_dispersion_abbe_number", &O::dispersion_abbe,
        NumberWithin{LowEnd::kOpen, 0.0f, kAnyNumber}, "of the dispersion");
    constexpr NumberWithin kThickness{LowEnd::kClosed, 0.0f, kMostFilm};
    row("thin_film_weight", &O::film_weight, NumberWithin{}, "how much of the base has a thin film");
    row("thin_film_thickness", &O::film_thickness, kThickness,
        "thickness of the film in micrometres; a texture lies between the two that follow");
    row("thin_film_thickness_minimum", &O::film_least, kThickness, "... where the texture is 0");
    row("thin_film_thickness_maximum", &O::film_most, kThickness, "... where it is 1");
    row("thin_film_ior", &O::film_ior, kIndex, "refractive index of the film");
    row("subsurface_weight", &O::subsurface_weight, NumberWithin{},
        "how much of the opaque base scatters light below its surface; with path and volpath");
    row("subsurface_color", &O::subsurface_color, ColourWithin{}, "albedo of what scatters there");
    row("subsurface_radius", &O::subsurface_radius, kLength, "mean free path");
    row("subsurface_radius_scale", &O::subsurface_radius_scale, ColourWithin{}, "its factor for each colour");
    row("subsurface_scatter_anisotropy", &O::subsurface_anisotropy,
        NumberWithin{LowEnd::kClosed, -1.0f, 1.0f},
        "mean cosine of scattering; of sheets, from reflection to transmission");
    row("coat_weight", &O::coat_weight, NumberWithin{}, "how much of the surface has a coat");
    row("coat_color", &O::coat_color, ColourWithin{},
        "of light that went through the coat twice, along the normal");
    row("coat_roughness", &O::coat_roughness, NumberWithin{}, "of the coat's microfacets");
    row("coat_ior", &O::coat_ior, kIndex, "refractive index of the coat");
    row("coat_darkening", &O::coat_darkening, NumberWithin{},
        "how much of the light between coat and base is taken into account");
    row("coat_roughens", &O::coat_roughens, TrueOrFalse{},
        "whether the coat's roughness makes the base look rougher; false, as in glTF: it does not");
    row("fuzz_weight", &O::fuzz_weight, NumberWithin{}, "how much of the surface has fuzz");
    row("fuzz_color", &O::fuzz_color, ColourWithin{}, "of the fuzz");
    row("fuzz_roughness", &O::fuzz_roughness, NumberWithin{}, "of the fuzz");
    row("geometry_thin_walled", &O::thin_walled, TrueOrFalse{}, "whether it is a sheet without an inside");
  }

  template <typename Given>
  void complete(Findings& findings, const Given&) {
    const glm::vec3 tint = specular_color.value;
    if (std::max({tint.x, tint.y, tint.z}) > 1.0f && !(gltf && specular_color_fades))
      findings.push_back(
          {"specular_color", "it is at most 1, unless gltf and specular_color_fades are true"});
    if (!thin_walled)
      check_within(findings, "subsurface_scatter_anisotropy", double(subsurface_anisotropy),
                   -double(kMostAnisotropy), double(kMostAnisotropy));
    if (disperses() && dispersion_abbe < kLeastAbbe * dispersion_scale)
      findings.push_back(
          {"transmission_dispersion_abbe_number", "an Abbe number over its scale is at least 1"});
  }
  [[nodiscard]] bool transmits() const {
    return transmission_weight.value > 0.0f || transmission_weight.texture != kNoTexture;
  }
  [[nodiscard]] bool scatters_below() const {
    return subsurface_weight.value > 0.0f || subsurface_weight.texture != kNoTexture;
  }
  /// Whether light that scatters below the surface may leave it elsewhere. Where a surface also transmits, or
  /// without a radius, it does not.
  [[nodiscard]] bool walks() const {
    const glm::vec3 radius = subsurface_radius * subsurface_radius_scale;
    return scatters_below() && !transmits() && !thin_walled &&
           std::max({radius.x, radius.y, radius.z}) > 0.0f;
  }
  /// Whether what it transmits takes on its colour inside.
  [[nodiscard]] bool colours_inside() const {
    return transmits() && !thin_walled && transmission_depth > 0.0f;
  }
  [[nodiscard]] bool disperses() const { return transmits() && !thin_walled && dispersion_scale > 0.0f; }
  [[nodiscard]] bool coated() const { return coat_weight.value > 0.0f || coat_weight.texture != kNoTexture; }
  [[nodiscard]] bool fuzzy() const { return fuzz_weight.value > 0.0f || fuzz_weight.texture != kNoTexture; }
  [[nodiscard]] bool filmed() const { return film_weight.value > 0.0f || film_weight.texture != kNoTexture; }
  [[nodiscard]] bool anisotropic() const {
    return specular_anisotropy.value > 0.0f || specular_anisotropy.texture != kNoTexture;
  }
  /// Whether it is more than what the family of the base has.
  [[nodiscard]] bool layered() const {
    return transmits() || filmed() || scatters_below() || coated() || fuzzy() || anisotropic() ||
           base_diffuse_roughness.value > 0.0f || base_diffuse_roughness.texture != kNoTexture;
  }
  /// The BSDF seen from inside; none (black) if the material does not transmit.
  [[nodiscard]] std::optional<OpenPbrBsdf> other_side() const {
    if (!transmits()) return std::nullopt;
    OpenPbrBsdf other = *this;
    other.inside = !thin_walled;
    return other;
  }

  /// How much of an opaque base is below a coat.
  [[nodiscard]] float coat_over_base() const {
    const float weight = coat_weight.texture == kNoTexture ? coat_weight.value : 1.0f;
    return transmits() ? 0.0f : weight;
  }

  /// The index of the dielectric that reflects specular_weight times as much along the normal, under the
  /// coat; of one that transmits at least 1.001: by an index of 1 a direction would not determine a
  /// microfacet.
  [[nodiscard]] float effective_ior() const {
    const float coat = coat_over_base(), ratio = specular_ior / coat_ior;
    const float under = std::lerp(specular_ior, std::max(ratio, 1.0f / ratio), coat);
    const float step = (under - 1.0f) / (under + 1.0f);
    const float weight = specular_weight.texture == kNoTexture && !gltf ? specular_weight.value : 1.0f;
    const float root = std::min(std::sqrt(weight) * step, 0.999f);
    return std::max((1.0f + root) / (1.0f - root), transmits() ? float(kLeastMicrofacetIndex) : 1.0f);
  }

  /// The film at its first thickness, as light meets it: from the air or the coat, or from inside.
  [[nodiscard]] ThinFilm film() const {
    const double outside = std::lerp(1.0, double(coat_ior), double(coat_over_base())),
                 base = double(effective_ior());
    ThinFilm result;
    result.optical = double(film_ior);
    result.index = double(film_ior) / outside / (inside ? base : 1.0);
    result.base = inside ? 1.0 / base : base;
    const bool textured = film_thickness.texture != kNoTexture;
    result.nanometres = 1e3 * double(textured ? film_least : film_thickness.value);
    return result;
  }
  /// How many thicknesses its table has: they differ by an eighth of the shortest wavelengths' period, if
  /// that is possible.
  [[nodiscard]] int film_rows() const {
    if (film_thickness.texture == kNoTexture) return 1;
    constexpr double kStep = 0.025;  // micrometres, optical
    const double range = std::abs(double(film_most - film_least)) * double(film_ior);
    return std::clamp(int(std::ceil(range / kStep)) + 1, 2, FILM_ROWS);
  }

  /// The roughness of the base as it is seen through the coat, where neither has a texture (OpenPBR, coat).
  [[nodiscard]] TexturedNumber effective_roughness() const {
    if (!coat_roughens || !coated() || specular_roughness.texture != kNoTexture ||
        coat_roughness.texture != kNoTexture)
      return specular_roughness;
    const float base = specular_roughness.value, coat = coat_roughness.value;
    const float both = std::pow(std::min(1.0f, std::pow(base, 4.0f) + 2.0f * std::pow(coat, 4.0f)), 0.25f);
    return {std::lerp(base, both, coat_weight.texture == kNoTexture ? coat_weight.value : 1.0f)};
  }
};

inline Material material_of(const OpenPbrBsdf& surface, MaterialTables& tables) {
  const bool layered = surface.layered();
  Material m = material_of_family(surface.filmed() ? FAMILY_OPENPBR_FILM
                                  : layered        ? FAMILY_OPENPBR_LAYERED
                                                   : FAMILY_OPENPBR);
  PENUMBRA_SET_FIELD(m, diffuse, surface.base_color);
  PENUMBRA_SET_FIELD(m, spec_tint, surface.base_weight);
  PENUMBRA_SET_FIELD(m, metallic, surface.base_metalness);
  PENUMBRA_SET_FIELD(m, specular, surface.specular_color);
  PENUMBRA_SET_FIELD(m, specular_level, surface.specular_weight);
  m.specular_level = std::min(m.specular_level, 1.0f);
  const TexturedNumber roughness = surface.effective_roughness();
  PENUMBRA_SET_FIELD(m, roughness, roughness);
  const float outside = surface.effective_ior();
  m.ior = surface.inside ? 1.0f / outside : outside;
  m.internal = float(mean_fresnel(double(m.ior)));
  if (surface.disperses()) {
    const glm::dvec3 each = microfacet_indices(
        channel_indices(double(outside), double(surface.dispersion_abbe / surface.dispersion_scale)));
    m.channel_ior = to_vec3(surface.inside ? 1.0 / each : each);
  }
  m.variant = surface.specular_weight.texture != kNoTexture || surface.gltf ? OPENPBR_WEIGHT_TINTS : 0;
  m.variant |= surface.specular_color_fades ? OPENPBR_TINT_FADES : 0;
  m.variant |= surface.gltf ? OPENPBR_GLTF : 0;

  FacetCurves curves;
  curves.ior = double(m.ior);
  curves.gltf = layered && surface.gltf && (surface.fuzzy() || surface.transmits());
  bool textured = roughness.texture != kNoTexture;
  if (layered) {
    PENUMBRA_SET_FIELD(m, flatness, surface.base_diffuse_roughness);
    PENUMBRA_SET_FIELD(m, anisotropic, surface.specular_anisotropy);
    PENUMBRA_SET_FIELD(m, spec_trans, surface.transmission_weight);
    PENUMBRA_SET_FIELD(m, transmitted, surface.transmission_color);
    PENUMBRA_SET_FIELD(m, clearcoat, surface.coat_weight);
    PENUMBRA_SET_FIELD(m, clearcoat_gloss, surface.coat_roughness);
    PENUMBRA_SET_FIELD(m, eta, surface.coat_color);
    PENUMBRA_SET_FIELD(m, diff_trans, surface.subsurface_weight);
    PENUMBRA_SET_FIELD(m, subsurface, surface.subsurface_color);
    m.diff_trans_rate = surface.thin_walled ? (1.0f + surface.subsurface_anisotropy) / 2.0f : 0.0f;
    m.clearcoat_rate = surface.coat_ior;
    m.diffuse_rate = surface.coat_darkening;
    m.coat_normal = make_vec3(0.0f, 0.0f, 1.0f);
    PENUMBRA_SET_FIELD(m, sheen, surface.fuzz_weight);
    PENUMBRA_SET_FIELD(m, sheen_tint, surface.fuzz_roughness);
    PENUMBRA_SET_FIELD(m, k, surface.fuzz_color);
    m.variant |= (surface.inside ? OPENPBR_INSIDE : 0) | (surface.thin_walled ? OPENPBR_THIN : 0);
    curves.layered = true;
    curves.transmits = surface.transmits() && !surface.thin_walled;
    if (surface.coated()) {
      curves.coat_ior = double(surface.coat_ior);
      textured |= surface.coat_roughness.texture != kNoTexture;
    }
    if (surface.fuzzy()) textured |= surface.fuzz_roughness.texture != kNoTexture;
    textured |= surface.specular_anisotropy.texture != kNoTexture;
  }
  if (textured) {
    curves.rows = FacetRows::kRoughness;
    curves.alpha_u = curves.alpha_v = 0;
    curves.fuzz_roughness = surface.fuzzy() ? 1.0 : -1.0;
  } else {
    const Microfacets base = surface.gltf ? gltf_microfacets(m.roughness, m.anisotropic)
                                          : openpbr_microfacets(m.roughness, m.anisotropic);
    curves.rows = surface.anisotropic() ? FacetRows::kAzimuth : FacetRows::kOne;
    m.variant |= surface.anisotropic() ? OPENPBR_BY_AZIMUTH : 0;
    curves.alpha_u = double(base.alpha_u);
    curves.alpha_v = double(base.alpha_v);
    if (surface.coated()) curves.coat_alpha = double(openpbr_microfacets(m.clearcoat_gloss, 0.0f).alpha_u);
    if (surface.fuzzy()) curves.fuzz_roughness = double(m.sheen_tint);
  }
  if (surface.filmed()) {
    PENUMBRA_SET_FIELD(m, film, surface.film_weight);
    PENUMBRA_SET_FIELD(m, film_thickness, surface.film_thickness);
    curves.film = surface.film();
    curves.last_nanometres = 1e3 * double(surface.film_most);
    m.film_rows = curves.film_rows = surface.film_rows();
  }
  m.curve = tables.facets(curves);
  m.curve_rows = curves.row_count() * curves.sets();
  return m;
}

}  // namespace penumbra
