// Materials of KHR_materials_pbrSpecularGlossiness as ones of metal and roughness.
#pragma once

#include <glm/glm.hpp>

namespace penumbra::gltf {

struct MetalRoughness {
  glm::dvec3 base_colour{0.0};
  double metallic = 0.0, roughness = 1.0;
};

/// The material that reflects as much along the normal, in each channel, and of that as much specularly in
/// luminance: exact for metals, and for dielectrics of a refractive index of 1.5; others are in between.
MetalRoughness metal_roughness_of(const glm::dvec3& diffuse, const glm::dvec3& specular, double glossiness);

}  // namespace penumbra::gltf
