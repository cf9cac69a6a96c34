// Mitsuba 3's principled BSDF, see kernels/bsdf/principled.h.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "scenes/bsdfs/material.h"
#include "scenes/plugin_values.h"

namespace penumbra {

/// The rate at which a lobe is sampled, relative to the other lobes.
constexpr NumberWithin kSamplingRate{LowEnd::kClosed, 0.0f, kAnyNumber};

/// Warns if a lobe that the material has is never sampled.
inline void check_sampling_rate(const char* parameter, float rate, Findings& findings) {
  if (rate > 0.0f) return;
  findings.push_back({parameter,
                      std::string(parameter) + " is 0: that lobe is never sampled, and shows only what "
                                               "samples of lights find",
                      true});
}

struct PrincipledBsdf {
  static constexpr const char* kPlugin = "principled";
  static constexpr const char* kText = "Disney BSDF (Burley 2015)";
  TexturedColour base_color{glm::vec3(0.5f)};
  TexturedNumber roughness{0.5f};
  TexturedNumber anisotropic{}, metallic{}, spec_trans{};
  float eta = 1.5f;       ///< inside over outside
  float specular = 0.5f;  ///< alternative to eta
  TexturedNumber spec_tint{}, sheen{}, sheen_tint{}, flatness{}, clearcoat{}, clearcoat_gloss{};
  float specular_rate = 1.0f, diffuse_rate = 1.0f, clearcoat_rate = 1.0f;
  bool inside = false;  ///< whether this is the BSDF of the inner side

  template <typename Row>
  static void parameters(const Row& row) {
    using P = PrincipledBsdf;
    row("base_color", &P::base_color, ColourWithin{}, "colour of the material");
    row("roughness", &P::roughness, NumberWithin{}, "of the microfacets: their alpha is its square");
    row("anisotropic", &P::anisotropic, NumberWithin{}, "how much longer highlights are along the tangent");
    row("metallic", &P::metallic, NumberWithin{}, "from a dielectric to a metal");
    row("spec_trans", &P::spec_trans, NumberWithin{}, "how much of the dielectric transmits");
    row("eta", &P::eta, NumberWithin{LowEnd::kOpen, 0.0f, kAnyNumber},
        "refractive index inside over that outside");
    row("specular", &P::specular, NumberWithin{}, "instead of eta: 0 for 1, 0.5 for 1.5, 1 for 1.79");
    row("spec_tint", &P::spec_tint, NumberWithin{},
        "how much the dielectric's reflection has the base colour");
    row("sheen", &P::sheen, NumberWithin{}, "of cloth, at grazing angles");
    row("sheen_tint", &P::sheen_tint, NumberWithin{}, "how much the sheen has the base colour");
    row("flatness", &P::flatness, NumberWithin{}, "from diffuse to like scattering beneath the surface");
    row("clearcoat", &P::clearcoat, NumberWithin{}, "of a second, colourless reflection");
    row("clearcoat_gloss", &P::clearcoat_gloss, NumberWithin{}, "from a satin to a glossy clearcoat");
    row("main_specular_sampling_rate", &P::specular_rate, kSamplingRate,
        "how often the microfacets are sampled");
    row("diffuse_reflectance_sampling_rate", &P::diffuse_rate, kSamplingRate,
        "how often the diffuse lobe is sampled");
    row("clearcoat_sampling_rate", &P::clearcoat_rate, kSamplingRate, "how often the clearcoat is sampled");
  }

  [[nodiscard]] bool transmits() const { return spec_trans.value > 0.0f; }
  /// The BSDF seen from inside; none (black) if the material does not transmit.
  [[nodiscard]] std::optional<PrincipledBsdf> other_side() const {
    if (!transmits()) return std::nullopt;
    PrincipledBsdf other = *this;
    other.inside = true;
    return other;
  }

  template <typename Given>
  void complete(Findings& findings, const Given& given) {
    if (given("eta") && given("specular"))
      findings.push_back({"specular", "specular is another name for eta: give one of the two"});
    // With an index of exactly 1 a transmitted direction does not determine a half-vector, so the BSDF has no
    // density. An index slightly above 1 has one.
    if (!given("eta")) {
      if (transmits()) specular = std::max(specular, 1e-3f);
      eta = 2.0f / (1.0f - std::sqrt(0.08f * specular)) - 1.0f;
    } else if (transmits() && eta == 1.0f) {
      eta = 1.001f;
    }
    check_sampling_rate("main_specular_sampling_rate", specular_rate, findings);
    check_sampling_rate("diffuse_reflectance_sampling_rate", diffuse_rate, findings);
    if (clearcoat.value > 0.0f) check_sampling_rate("clearcoat_sampling_rate", clearcoat_rate, findings);
  }
};

inline Material material_of(const PrincipledBsdf& principled) {
  Material m =
      material_of_family(principled.transmits() ? FAMILY_PRINCIPLED_TRANSMITTING : FAMILY_PRINCIPLED);
  PENUMBRA_SET_FIELD(m, diffuse, principled.base_color);
  PENUMBRA_SET_FIELD(m, roughness, principled.roughness);
  PENUMBRA_SET_FIELD(m, anisotropic, principled.anisotropic);
  PENUMBRA_SET_FIELD(m, metallic, principled.metallic);
  PENUMBRA_SET_FIELD(m, spec_trans, principled.spec_trans);
  PENUMBRA_SET_FIELD(m, spec_tint, principled.spec_tint);
  PENUMBRA_SET_FIELD(m, sheen, principled.sheen);
  PENUMBRA_SET_FIELD(m, sheen_tint, principled.sheen_tint);
  PENUMBRA_SET_FIELD(m, flatness, principled.flatness);
  PENUMBRA_SET_FIELD(m, clearcoat, principled.clearcoat);
  PENUMBRA_SET_FIELD(m, clearcoat_gloss, principled.clearcoat_gloss);
  m.ior = principled.inside ? 1.0f / principled.eta : principled.eta;
  m.specular_rate = principled.specular_rate;
  m.diffuse_rate = principled.diffuse_rate;
  m.clearcoat_rate = principled.clearcoat_rate;
  m.variant = principled.inside ? PRINCIPLED_INSIDE : 0;
  return m;
}

}  // namespace penumbra
