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
    surface.base_color = base_color;
    surface.base_metalness = metallic;
    surface.specular_roughness = roughness;
    // The factors of the reflectance along the normal are in the index, and the rest in the colour.
    const float step = (ior - 1.0f) / (ior + 1.0f), plain = ior == 0.0f ? 1.0f : step * step;
    const glm::vec3 given = specular_color.value;
    const bool coloured = specular_color.texture != kNoTexture;
    const float most = coloured ? 1.0f : std::max({given.x, given.y, given.z});
    const float factor = specular.texture == kNoTexture ? specular.value : 1.0f;
    surface.specular_color = specular_color;
    const float along_normal = std::min(plain * most, 1.0f);
    if (!coloured)
      surface.specular_color.value =
          most > 0.0f ? glm::min(given * plain, glm::vec3(1.0f)) / std::max(along_normal, 1e-20f)
                      : glm::vec3(1.0f);
    const bool all_metal = metallic.value == 1.0f && metallic.texture == kNoTexture;
    if (all_metal) surface.specular_color = glm::vec3(1.0f);
    surface.specular_color_fades = surface.specular_color != TexturedColour(glm::vec3(1.0f));
    if (specular.texture != kNoTexture && !all_metal) surface.specular_weight = specular;
    const float root = std::min(std::sqrt(along_normal * factor), 0.999f);
    surface.specular_ior = (1.0f + root) / (1.0f - root);

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
