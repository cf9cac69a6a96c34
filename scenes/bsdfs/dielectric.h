// Dielectric boundaries: smooth, rough, and thin panes. They transmit, so each side has a BSDF.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "scenes/bsdfs/material.h"
#include "scenes/bsdfs/microfacet.h"
#include "scenes/plugin_values.h"
#include "scenes/refractive_indices.h"

namespace penumbra {

/// The refractive indices and the colours of a dielectric.
struct DielectricSurface {
  float int_ior = 1.5046f;    ///< refractive index behind the front side; BK7
  float ext_ior = 1.000277f;  ///< refractive index before the front side; air
  TexturedColour specular_reflectance{glm::vec3(1.0f)};
  TexturedColour specular_transmittance{glm::vec3(1.0f)};

  template <typename Row>
  static void parameters(const Row& row) {
    row("int_ior", &DielectricSurface::int_ior, RefractiveIndex{}, "refractive index inside");
    row("ext_ior", &DielectricSurface::ext_ior, RefractiveIndex{}, "refractive index outside");
    row("specular_reflectance", &DielectricSurface::specular_reflectance, ColourWithin{},
        "factor of the reflection");
    row("specular_transmittance", &DielectricSurface::specular_transmittance, ColourWithin{},
        "factor of what passes");
  }

  [[nodiscard]] float ior() const { return int_ior / ext_ior; }
  [[nodiscard]] Material material_with(int family) const {
    Material m = material_of_family(family);
    PENUMBRA_SET_FIELD(m, specular, specular_reflectance);
    PENUMBRA_SET_FIELD(m, transmitted, specular_transmittance);
    m.ior = ior();
    return m;
  }
};

/// A dielectric that refracts each colour channel by an index of its own.
struct DispersingSurface : DielectricSurface {
  float abbe = 0.0f;    ///< Abbe number of the interior; 0: the same index for all channels
  bool turned = false;  ///< whether this is the other side's: ext_ior is the index of the interior

  template <typename Row>
  static void parameters(const Row& row) {
    DielectricSurface::parameters(row);
    row("abbe", &DispersingSurface::abbe, NumberWithin{LowEnd::kClosed, 0.0f, kAnyNumber},
        "Abbe number of the inside, whose int_ior is that of yellow light; 0: no dispersion");
  }
  template <typename Given>
  void complete(Findings& findings, const Given&) {
    if (disperses() && abbe < kLeastAbbe)
      findings.push_back({"abbe", "an Abbe number is at least 1, or 0 without dispersion"});
  }
  [[nodiscard]] bool disperses() const { return abbe > 0.0f; }
  /// The relative refractive index of each channel.
  [[nodiscard]] glm::vec3 channel_iors() const {
    const glm::dvec3 inside = channel_indices(turned ? ext_ior : int_ior, abbe);
    return glm::vec3(turned ? double(int_ior) / inside : inside / double(ext_ior));
  }
  [[nodiscard]] Material material_with(int family) const {
    Material m = DielectricSurface::material_with(family);
    if (disperses()) m.channel_ior = to_vec3(channel_iors());
    return m;
  }
};

/// The BSDF of the other side: interior and exterior are exchanged.
template <typename Model>
Model turned_dielectric(Model model) {
  std::swap(model.int_ior, model.ext_ior);
  model.turned = !model.turned;
  return model;
}

struct DielectricBsdf : DispersingSurface {
  static constexpr const char* kPlugin = "dielectric";
  static constexpr const char* kText = "smooth boundary of glass, water and the like";

  [[nodiscard]] DielectricBsdf other_side() const { return turned_dielectric(*this); }
};

struct ThinDielectricBsdf : DielectricSurface {
  static constexpr const char* kPlugin = "thindielectric";
  static constexpr const char* kText = "thin pane of glass, without refraction";
  static constexpr bool kSidesAreAlike = true;
};

struct RoughDielectricBsdf : DispersingSurface, RoughSurface {
  static constexpr const char* kPlugin = "roughdielectric";
  static constexpr const char* kText = "rough boundary of glass and the like (microfacets)";
  /// If the indices differ by less than this, light passes straight through, as if they were equal. With so
  /// small a difference the half-vector of a refraction cannot be found in single precision.
  static constexpr float kLeastStep = 1e-3f;

  template <typename Row>
  static void parameters(const Row& row) {
    DispersingSurface::parameters(row);
    RoughSurface::parameters(row);
  }
  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    DispersingSurface::complete(findings, given);
    RoughSurface::complete(findings, given);
    if (passes())
      findings.push_back({"", "int_ior and ext_ior are the same, or nearly: everything passes", true});
  }
  [[nodiscard]] RoughDielectricBsdf other_side() const { return turned_dielectric(*this); }
  [[nodiscard]] bool passes() const {
    return std::abs(int_ior - ext_ior) < kLeastStep * std::min(int_ior, ext_ior);
  }
};

inline Material material_of(const DielectricBsdf& dielectric) {
  return dielectric.material_with(FAMILY_DIELECTRIC);
}
inline Material material_of(const ThinDielectricBsdf& dielectric) {
  return dielectric.material_with(FAMILY_THINDIELECTRIC);
}
inline Material material_of(const RoughDielectricBsdf& dielectric) {
  const bool passes = dielectric.passes();
  Material m = dielectric.material_with(
      passes ? FAMILY_DIELECTRIC
             : dielectric.family(FAMILY_ROUGHDIELECTRIC_GGX, FAMILY_ROUGHDIELECTRIC_BECKMANN));
  if (passes) m.ior = 1.0f;
  if (passes) m.channel_ior = {};
  if (!passes) dielectric.set_roughness(m);
  if (disperses(m)) m.channel_ior = to_vec3(microfacet_indices(glm::dvec3(dielectric.channel_iors())));
  return m;
}

}  // namespace penumbra
