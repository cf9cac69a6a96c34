// Disney's BRDF of 2012 with the parameter names of its authors. Readers spell them in snake_case: base_color
// for baseColor. See kernels/bsdf/disney.h.
#pragma once

#include "scenes/bsdfs/material.h"
#include "scenes/plugin_values.h"

namespace penumbra {

struct DisneyBsdf {
  static constexpr const char* kPlugin = "disney";
  static constexpr const char* kText = "Disney BRDF (Burley 2012)";
  TexturedColour base_color{glm::vec3(0.5f)};
  TexturedNumber subsurface{}, metallic{};
  TexturedNumber specular{0.5f};
  TexturedNumber specular_tint{};
  TexturedNumber roughness{0.5f};
  TexturedNumber anisotropic{}, sheen{};
  TexturedNumber sheen_tint{0.5f};
  TexturedNumber clearcoat{};
  TexturedNumber clearcoat_gloss{1.0f};
  // Of models that are put together from its lobes, see lajolla.h.
  float diffuse_weight = 1.0f;
  bool microfacets = true, luminance_tint = false;

  template <typename Row>
  static void parameters(const Row& row) {
    using P = DisneyBsdf;
    row("base_color", &P::base_color, ColourWithin{}, "colour of the material");
    row("subsurface", &P::subsurface, NumberWithin{}, "from diffuse to like scattering beneath the surface");
    row("metallic", &P::metallic, NumberWithin{}, "from a dielectric to a metal");
    // Above 1 are models that are put together from its lobes; at most all light is reflected along the
    // normal.
    row("specular", &P::specular, NumberWithin{LowEnd::kClosed, 0.0f, 12.5f},
        "of a dielectric: 0.08 of it is reflected along the normal; usually in [0, 1]");
    const NumberWithin factor{LowEnd::kClosed, 0.0f, 64.0f};
    row("specular_tint", &P::specular_tint, NumberWithin{}, "how much that reflection has the base colour");
    row("roughness", &P::roughness, NumberWithin{}, "of the microfacets: their alpha is its square");
    row("anisotropic", &P::anisotropic, NumberWithin{}, "how much longer highlights are along the tangent");
    row("sheen", &P::sheen, factor, "of cloth, at grazing angles; usually in [0, 1]");
    row("sheen_tint", &P::sheen_tint, NumberWithin{}, "how much the sheen has the base colour");
    row("clearcoat", &P::clearcoat, factor,
        "of a second, colourless reflection, a quarter of it; usually in [0, 1]");
    row("clearcoat_gloss", &P::clearcoat_gloss, NumberWithin{}, "from a satin to a glossy clearcoat");
    row("diffuse_weight", &P::diffuse_weight, NumberWithin{}, "factor of the diffuse lobe");
    row("microfacets", &P::microfacets, TrueOrFalse{}, "false: without their reflection");
    row("luminance_tint", &P::luminance_tint, TrueOrFalse{},
        "tints have luminance 1; false: 1 by Disney's weights of the channels");
  }
};

inline Material material_of(const DisneyBsdf& disney) {
  Material m = material_of_family(FAMILY_DISNEY);
  PENUMBRA_SET_FIELD(m, diffuse, disney.base_color);
  PENUMBRA_SET_FIELD(m, flatness, disney.subsurface);
  PENUMBRA_SET_FIELD(m, metallic, disney.metallic);
  PENUMBRA_SET_FIELD(m, specular_level, disney.specular);
  PENUMBRA_SET_FIELD(m, spec_tint, disney.specular_tint);
  PENUMBRA_SET_FIELD(m, roughness, disney.roughness);
  PENUMBRA_SET_FIELD(m, anisotropic, disney.anisotropic);
  PENUMBRA_SET_FIELD(m, sheen, disney.sheen);
  PENUMBRA_SET_FIELD(m, sheen_tint, disney.sheen_tint);
  PENUMBRA_SET_FIELD(m, clearcoat, disney.clearcoat);
  PENUMBRA_SET_FIELD(m, clearcoat_gloss, disney.clearcoat_gloss);
  m.spec_trans = 1.0f - disney.diffuse_weight;
  m.variant = (disney.microfacets ? 0 : DISNEY_WITHOUT_MICROFACETS) |
              (disney.luminance_tint ? DISNEY_LUMINANCE_TINT : 0);
  return m;
}

}  // namespace penumbra
