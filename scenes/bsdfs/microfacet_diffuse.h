// Nori's microfacet BSDF: the reflection of a rough dielectric boundary and a Lambertian lobe, whose weights
// sum to 1.
#pragma once

#include <algorithm>

#include "kernels/bsdf/microfacet.h"
#include "scenes/bsdfs/material.h"
#include "scenes/plugin_values.h"
#include "scenes/refractive_indices.h"

namespace penumbra {

struct MicrofacetDiffuseBsdf {
  static constexpr const char* kPlugin = "microfacet";
  static constexpr const char* kText = "rough dielectric reflection over a diffuse part (Nori)";
  float alpha = 0.1f;
  float int_ior = 1.5046f;    // BK7
  float ext_ior = 1.000277f;  // air
  TexturedColour diffuse{glm::vec3(0.5f)};

  template <typename Row>
  static void parameters(const Row& row) {
    row("alpha", &MicrofacetDiffuseBsdf::alpha, NumberWithin{LowEnd::kClosed, 0.0f, MOST_ALPHA},
        "roughness of the microfacets (Beckmann's distribution)");
    row("int_ior", &MicrofacetDiffuseBsdf::int_ior, RefractiveIndex{},
        "refractive index beneath the surface");
    row("ext_ior", &MicrofacetDiffuseBsdf::ext_ior, RefractiveIndex{}, "refractive index above it");
    row("kd", &MicrofacetDiffuseBsdf::diffuse, ColourWithin{},
        "albedo of the diffuse part; the lobe's factor is 1 less its largest channel");
  }
};

inline Material material_of(const MicrofacetDiffuseBsdf& microfacet) {
  Material m = material_of_family(FAMILY_MICROFACET_DIFFUSE);
  const glm::vec3& kd = microfacet.diffuse.value;
  PENUMBRA_SET_FIELD(m, diffuse, microfacet.diffuse);
  m.specular = to_vec3(glm::vec3(1.0f - std::max(kd.x, std::max(kd.y, kd.z))));
  m.ior = microfacet.int_ior / microfacet.ext_ior;
  m.alpha_u = m.alpha_v = microfacet.alpha;
  return m;
}

}  // namespace penumbra
