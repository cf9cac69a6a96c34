// Diffuse BSDFs: Lambert, of rough surfaces, and of sheets that transmit.
#pragma once

#include "scenes/bsdfs/material.h"
#include "scenes/plugin_values.h"

namespace penumbra {

struct DiffuseBsdf {
  static constexpr const char* kPlugin = "diffuse";
  static constexpr const char* kText = "ideal diffuse reflection (Lambert)";
  TexturedColour reflectance{glm::vec3(0.5f)};

  template <typename Row>
  static void parameters(const Row& row) {
    row("reflectance", &DiffuseBsdf::reflectance, ColourWithin{}, "albedo");
  }
};

inline Material material_of(const DiffuseBsdf& diffuse) {
  Material m = material_of_family(FAMILY_DIFFUSE);
  PENUMBRA_SET_FIELD(m, diffuse, diffuse.reflectance);
  return m;
}

/// Rough surfaces (Oren and Nayar), see kernels/bsdf/diffuse.h.
struct RoughDiffuseBsdf {
  static constexpr const char* kPlugin = "roughdiffuse";
  static constexpr const char* kText =
      "diffuse reflection of a rough surface (Oren and Nayar), of Mitsuba 0.6";
  TexturedColour reflectance{glm::vec3(0.5f)};
  TexturedNumber alpha{0.2f};
  bool use_fast_approx = false;

  template <typename Row>
  static void parameters(const Row& row) {
    row("reflectance", &RoughDiffuseBsdf::reflectance, ColourWithin{}, "albedo of the facets");
    row("alpha", &RoughDiffuseBsdf::alpha, NumberWithin{LowEnd::kClosed, 0.0f, kAnyNumber},
        "root mean square of their slopes");
    row("use_fast_approx", &RoughDiffuseBsdf::use_fast_approx, TrueOrFalse{},
        "leaves out light that is reflected twice among facets");
  }
};

inline Material material_of(const RoughDiffuseBsdf& rough) {
  Material m = material_of_family(FAMILY_ROUGHDIFFUSE);
  PENUMBRA_SET_FIELD(m, diffuse, rough.reflectance);
  PENUMBRA_SET_FIELD(m, alpha_u, rough.alpha);
  m.variant = rough.use_fast_approx ? ROUGHDIFFUSE_FAST : ROUGHDIFFUSE_FULL;
  return m;
}

/// A sheet, see kernels/bsdf/diffuse.h.
struct DiffuseTransmitterBsdf {
  static constexpr const char* kPlugin = "difftrans";
  static constexpr const char* kText = "sheet that scatters light evenly, of Mitsuba 0.6";
  static constexpr bool kSidesAreAlike = true;
  TexturedColour transmittance{glm::vec3(0.5f)};
  TexturedColour reflectance{glm::vec3(0.0f)};

  template <typename Row>
  static void parameters(const Row& row) {
    row("transmittance", &DiffuseTransmitterBsdf::transmittance, ColourWithin{}, "part that is transmitted");
    row("reflectance", &DiffuseTransmitterBsdf::reflectance, ColourWithin{},
        "part that is reflected; not in Mitsuba");
  }
};

inline Material material_of(const DiffuseTransmitterBsdf& sheet) {
  Material m = material_of_family(FAMILY_DIFFTRANS);
  PENUMBRA_SET_FIELD(m, transmitted, sheet.transmittance);
  PENUMBRA_SET_FIELD(m, diffuse, sheet.reflectance);
  return m;
}

}  // namespace penumbra
