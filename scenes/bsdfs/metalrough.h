// glTF's metallic-roughness BSDF, see kernels/bsdf/metalrough.h.
#pragma once

#include "scenes/bsdfs/material.h"
#include "scenes/bsdfs/material_tables.h"
#include "scenes/plugin_values.h"

namespace penumbra {

struct MetalRoughBsdf {
  static constexpr const char* kPlugin = "metalrough";
  static constexpr const char* kText = "metallic-roughness BSDF (glTF 2.0)";
  TexturedColour base_color{glm::vec3(1.0f)};
  TexturedNumber metallic{};
  TexturedNumber roughness{1.0f};
  float ior = 1.5f;  ///< inside over outside; 0: reflects all light along the normal
  TexturedNumber specular{1.0f};
  TexturedColour specular_color{glm::vec3(1.0f)};
  TexturedNumber clearcoat{}, clearcoat_roughness{};

  template <typename Row>
  static void parameters(const Row& row) {
    using M = MetalRoughBsdf;
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
};

inline Material material_of(const MetalRoughBsdf& surface, MaterialTables& tables) {
  Material m = material_of_family(FAMILY_METALROUGH);
  PENUMBRA_SET_FIELD(m, diffuse, surface.base_color);
  PENUMBRA_SET_FIELD(m, metallic, surface.metallic);
  PENUMBRA_SET_FIELD(m, roughness, surface.roughness);
  m.ior = surface.ior;
  PENUMBRA_SET_FIELD(m, specular_level, surface.specular);
  PENUMBRA_SET_FIELD(m, specular, surface.specular_color);
  PENUMBRA_SET_FIELD(m, clearcoat, surface.clearcoat);
  PENUMBRA_SET_FIELD(m, clearcoat_gloss, surface.clearcoat_roughness);
  m.curve = tables.reflection();
  m.curve_rows = 2 * REFLECTION_ROWS;
  return m;
}

}  // namespace penumbra
