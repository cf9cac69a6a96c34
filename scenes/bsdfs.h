// The BSDFs, each with its parameters and, beside them, the material of the kernels that it becomes.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <variant>

#include "kernels/scene_types.h"
#include "scenes/device/to_vec3.h"

namespace penumbra {

/// Lambertian reflection, f = reflectance / pi.
struct DiffuseBsdf {
  glm::vec3 reflectance{0.5f};
};

inline Material material_of(const DiffuseBsdf& diffuse) {
  Material m{};
  m.family = FAMILY_DIFFUSE;
  m.diffuse = to_vec3(diffuse.reflectance);
  return m;
}

/// Normalised Phong, f = diffuse / pi + specular (n + 2) / (2 pi) max(0, cos(alpha))^n, alpha being the angle
/// between `wi` and the mirror direction of `wo`.
struct PhongBsdf {
  glm::vec3 diffuse{0.5f};
  glm::vec3 specular{0.2f};
  float exponent = 30.0f;  ///< n >= 0
};

inline Material material_of(const PhongBsdf& phong) {
  const auto mean = [](const glm::vec3& c) { return (double(c.x) + c.y + c.z) / 3; };
  Material m{};
  m.diffuse = to_vec3(phong.diffuse);
  m.specular = to_vec3(phong.specular);
  m.exponent = phong.exponent;
  const double sum = mean(phong.diffuse) + mean(phong.specular);
  m.lobe = sum > 0 ? float(mean(phong.specular) / sum) : 0.0f;
  m.family = m.lobe > 0 ? FAMILY_PHONG : FAMILY_DIFFUSE;
  return m;
}

using BsdfModel = std::variant<DiffuseBsdf, PhongBsdf>;

struct Bsdf {
  std::string name;  ///< the file's id, or a description of the place, for messages
  BsdfModel model;
};

inline Material material_of(const Bsdf& bsdf) {
  return std::visit([](const auto& model) { return material_of(model); }, bsdf.model);
}

}  // namespace penumbra
