// Phong and Blinn-Phong. Normalised Phong: f = diffuse / pi + specular (n + 2) / (2 pi) max(0, cos(alpha))^n,
// alpha being the angle between `wi` and the mirror direction of `wo`.
#pragma once

#include <algorithm>

#include "scenes/bsdfs/material.h"
#include "scenes/plugin_values.h"

namespace penumbra {

struct PhongBsdf {
  static constexpr const char* kPlugin = "phong";
  static constexpr const char* kText =
      "modified Phong model: a diffuse part and a lobe about the mirror direction";
  TexturedColour diffuse{glm::vec3(0.5f)};
  TexturedColour specular{glm::vec3(0.2f)};
  TexturedNumber exponent{30.0f};  ///< n

  template <typename Row>
  static void parameters(const Row& row) {
    row("diffuse_reflectance", &PhongBsdf::diffuse, ColourWithin{}, "albedo of the diffuse part");
    row("specular_reflectance", &PhongBsdf::specular, ColourWithin{}, "reflectance of the lobe");
    row("exponent", &PhongBsdf::exponent, NumberWithin{LowEnd::kClosed, 0.0f, kAnyNumber},
        "exponent n of the lobe");
  }
  void complete(Findings& findings) {
    const glm::vec3 sum = diffuse.value + specular.value;
    if (std::max(sum.x, std::max(sum.y, sum.z)) > 1.0f)
      findings.push_back({"",
                          "diffuse and specular reflectance are more than 1 together: it gives off more "
                          "light than it receives",
                          true});
  }
};

inline Material material_of(const PhongBsdf& phong) {
  Material m = material_of_family(phong.specular.is_lit() ? FAMILY_PHONG : FAMILY_DIFFUSE);
  PENUMBRA_SET_FIELD(m, diffuse, phong.diffuse);
  PENUMBRA_SET_FIELD(m, specular, phong.specular);
  PENUMBRA_SET_FIELD(m, exponent, phong.exponent);
  return m;
}

/// A Lambertian and a normalised Blinn-Phong lobe: see kernels/bsdf/phong.h.
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
