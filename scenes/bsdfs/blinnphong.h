// A Lambertian and a normalised Blinn-Phong lobe: see kernels/bsdf/blinnphong.h.
#pragma once

#include "scenes/bsdfs/material.h"
#include "scenes/plugin_values.h"

namespace penumbra {

struct BlinnPhongBsdf {
  static constexpr const char* kPlugin = "blinnphong";
  static constexpr const char* kText = "Blinn-Phong model: a diffuse part and a lobe about the half vector";
  TexturedColour diffuse{glm::vec3(0.5f)};
  TexturedColour specular{glm::vec3(0.2f)};
  TexturedNumber exponent{30.0f};

  template <typename Row>
  static void parameters(const Row& row) {
    row("diffuse_reflectance", &BlinnPhongBsdf::diffuse, ColourWithin{}, "albedo of the diffuse part");
    row("specular_reflectance", &BlinnPhongBsdf::specular, ColourWithin{},
        "reflectance of the lobe, seen along the normal");
    row("exponent", &BlinnPhongBsdf::exponent, NumberWithin{LowEnd::kClosed, 0.0f, kAnyNumber},
        "exponent of the cosine between normal and half vector");
  }
};

inline Material material_of(const BlinnPhongBsdf& lobe) {
  Material m = material_of_family(FAMILY_BLINNPHONG);
  PENUMBRA_SET_FIELD(m, diffuse, lobe.diffuse);
  PENUMBRA_SET_FIELD(m, specular, lobe.specular);
  PENUMBRA_SET_FIELD(m, exponent, lobe.exponent);
  return m;
}

}  // namespace penumbra
