// Lambertian reflection, f = reflectance / pi.
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

}  // namespace penumbra
