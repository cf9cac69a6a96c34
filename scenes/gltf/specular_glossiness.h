// Converts materials of KHR_materials_pbrSpecularGlossiness to metallic-roughness.
#pragma once

#include <glm/glm.hpp>

namespace penumbra::gltf {

struct MetalRoughness {
  glm::dvec3 base_colour{0.0};
  double metallic = 0.0, roughness = 1.0;
};

/// The material with the same total reflectance at normal incidence in each channel, and with the same
/// luminance of its specular part. It is exact for metals and for dielectrics of refractive index 1.5. Other
/// materials are interpolated between these.
MetalRoughness metal_roughness_of(const glm::dvec3& diffuse, const glm::dvec3& specular, double glossiness);

}  // namespace penumbra::gltf
