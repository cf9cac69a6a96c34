// glTF 2.0's metallic-roughness material (appendix B) with KHR_materials_ior, _specular and _clearcoat, as
// parameters of an OpenPBR surface.
#pragma once

#include <algorithm>
#include <cmath>

#include "scenes/bsdfs/openpbr.h"
#include "scenes/plugin_values.h"

namespace penumbra {

struct MetalRoughParameters {
  static constexpr const char* kPlugin = "metalrough";
  static constexpr const char* kText = "metallic-roughness material (glTF 2.0), as an openpbr";
  TexturedColour base_color{glm::vec3(1.0f)};
  TexturedNumber metallic{};
  TexturedNumber roughness{1.0f};
  float ior = 1.5f;  ///< inside over outside; 0: reflects all light along the normal
  TexturedNumber specular{1.0f};
  TexturedColour specular_color{glm::vec3(1.0f)};
  TexturedNumber clearcoat{}, clearcoat_roughness{};

  /// Factor of `specular_color` without an index; textures must have it already.
  static constexpr float kWithoutIndex = 25.0f;

  template <typename Row>
  static void parameters(const Row& row) {
    using M = MetalRoughParameters;
    row("base_color", &M::base_color, ColourWithin{}, "colour of the base and of the metal");
    row("metallic", &M::metallic, NumberWithin{}, "from a dielectric to a metal");
    row("roughness", &M::roughness, NumberWithin{}, "of the microfacets: their alpha is its square");
    row("ior", &M::ior, NumberWithin{LowEnd::kClosed, 0.0f, kAnyNumber},
        "refractive index of the dielectric; 0: it reflects all light along the normal");
    row("specular", &M::specular, NumberWithin{}, "factor of what the dielectric's microfacets reflect");
    row("specular_color", &M::specular_color, ColourWithin{0.0f, kAnyNumber},
        "factor of that along the normal");
    row("clearcoat", &M::clearcoat, NumberWithin{}, "how much of the surface has a clear coat");
    row("clearcoat_roughness", &M::clearcoat_roughness, NumberWithin{}, "of the clear coat");
  }

  /// `transmits`: whether the surface is to transmit, which it does as if it had no coat.
  [[nodiscard]] OpenPbrBsdf as_openpbr(bool transmits = false) const {
    OpenPbrBsdf surface;
    surface.gltf = true;
    surface.base_color = base_color;
    surface.base_metalness = metallic;
    surface.specular_roughness = roughness;
    // Without an index all light is reflected along the normal. It is that of the usual one, times a colour.
    surface.specular_ior = ior == 0.0f ? 1.5f : ior;  // which reflects 1 / kWithoutIndex there
    surface.specular_color = specular_color;
    if (ior == 0.0f) surface.specular_color.value *= kWithoutIndex;
    surface.specular_color_fades = surface.specular_color != TexturedColour(glm::vec3(1.0f));
    surface.specular_weight = specular;

    // glTF's coat changes nothing of what is below it.
    surface.coat_weight = clearcoat;
    surface.coat_roughness = clearcoat_roughness;
    surface.coat_ior = 1.5f;
    surface.coat_darkening = 0.0f;
    surface.coat_roughens = false;
    if (!surface.coated() || transmits) return surface;
    const float weight = clearcoat.texture == kNoTexture ? clearcoat.value : 1.0f;
    surface.specular_ior /= 1.0f - weight + weight / surface.coat_ior;
    return surface;
  }
};

}  // namespace penumbra
