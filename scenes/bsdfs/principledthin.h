// Mitsuba 3's thin principled BSDF, see kernels/bsdf/principledthin.h.
#pragma once

#include "scenes/bsdfs/principled.h"

namespace penumbra {

struct PrincipledThinBsdf {
  static constexpr const char* kPlugin = "principledthin";
  static constexpr const char* kText = "Disney BSDF of thin surfaces (Burley 2015)";
  static constexpr bool kSidesAreAlike = true;
  TexturedColour base_color{glm::vec3(0.5f)};
  TexturedNumber roughness{0.5f};
  TexturedNumber anisotropic{}, spec_trans{};
  TexturedNumber eta{1.5f};
  TexturedNumber spec_tint{}, sheen{}, sheen_tint{}, flatness{}, diff_trans{};
  float diffuse_rate = 1.0f, diff_trans_rate = 1.0f, specular_rate = 1.0f, spec_trans_rate = 1.0f;

  template <typename Row>
  static void parameters(const Row& row) {
    using P = PrincipledThinBsdf;
    row("base_color", &P::base_color, ColourWithin{}, "colour of the material");
    row("roughness", &P::roughness, NumberWithin{}, "of the microfacets: their alpha is its square");
    row("anisotropic", &P::anisotropic, NumberWithin{}, "how much longer highlights are along the tangent");
    row("spec_trans", &P::spec_trans, NumberWithin{}, "from a diffuse sheet to a pane");
    row("eta", &P::eta, NumberWithin{LowEnd::kOpen, 0.0f, kAnyNumber},
        "refractive index inside over that outside");
    row("spec_tint", &P::spec_tint, NumberWithin{}, "how much the pane's reflection has the base colour");
    row("sheen", &P::sheen, NumberWithin{}, "of cloth, at grazing angles");
    row("sheen_tint", &P::sheen_tint, NumberWithin{}, "how much the sheen has the base colour");
    row("flatness", &P::flatness, NumberWithin{}, "from diffuse to like scattering beneath the surface");
    row("diff_trans", &P::diff_trans, NumberWithin{LowEnd::kClosed, 0.0f, 2.0f},
        "diffuse transmission: 0 for none, 2 for nothing else");
    row("diffuse_reflectance_sampling_rate", &P::diffuse_rate, kSamplingRate,
        "how often diffuse reflection is sampled");
    row("diffuse_transmittance_sampling_rate", &P::diff_trans_rate, kSamplingRate,
        "how often diffuse transmission is sampled");
    row("specular_reflectance_sampling_rate", &P::specular_rate, kSamplingRate,
        "how often reflection by the microfacets is sampled");
    row("specular_transmittance_sampling_rate", &P::spec_trans_rate, kSamplingRate,
        "how often transmission by the microfacets is sampled");
  }
  void complete(Findings& findings) {
    const bool pane = spec_trans.value > 0.0f, scatters = spec_trans.value < 1.0f;
    if (scatters) check_sampling_rate("diffuse_reflectance_sampling_rate", diffuse_rate, findings);
    if (scatters && diff_trans.value > 0.0f)
      check_sampling_rate("diffuse_transmittance_sampling_rate", diff_trans_rate, findings);
    if (pane) check_sampling_rate("specular_reflectance_sampling_rate", specular_rate, findings);
    if (pane) check_sampling_rate("specular_transmittance_sampling_rate", spec_trans_rate, findings);
  }
};

inline Material material_of(const PrincipledThinBsdf& thin) {
  Material m = material_of_family(FAMILY_PRINCIPLEDTHIN);
  PENUMBRA_SET_FIELD(m, diffuse, thin.base_color);
  PENUMBRA_SET_FIELD(m, roughness, thin.roughness);
  PENUMBRA_SET_FIELD(m, anisotropic, thin.anisotropic);
  PENUMBRA_SET_FIELD(m, spec_trans, thin.spec_trans);
  PENUMBRA_SET_FIELD(m, ior, thin.eta);
  PENUMBRA_SET_FIELD(m, spec_tint, thin.spec_tint);
  PENUMBRA_SET_FIELD(m, sheen, thin.sheen);
  PENUMBRA_SET_FIELD(m, sheen_tint, thin.sheen_tint);
  PENUMBRA_SET_FIELD(m, flatness, thin.flatness);
  PENUMBRA_SET_FIELD(m, diff_trans, thin.diff_trans);
  m.diffuse_rate = thin.diffuse_rate;
  m.diff_trans_rate = thin.diff_trans_rate;
  m.specular_rate = thin.specular_rate;
  m.clearcoat_rate = thin.spec_trans_rate;
  return m;
}

}  // namespace penumbra
