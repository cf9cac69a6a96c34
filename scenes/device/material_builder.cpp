#include "scenes/device/material_builder.h"

#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

double mean(const glm::vec3& c) { return (double(c.x) + c.y + c.z) / 3; }

// One for each struct of BsdfModel.

Material build(const DiffuseBsdf& diffuse) {
  Material m{};
  m.family = FAMILY_DIFFUSE;
  m.diffuse = to_vec3(diffuse.reflectance);
  return m;
}

Material build(const PhongBsdf& phong) {
  Material m{};
  m.diffuse = to_vec3(phong.diffuse);
  m.specular = to_vec3(phong.specular);
  m.exponent = phong.exponent;
  const double sum = mean(phong.diffuse) + mean(phong.specular);
  m.lobe = sum > 0 ? float(mean(phong.specular) / sum) : 0.0f;
  m.family = m.lobe > 0 ? FAMILY_PHONG : FAMILY_DIFFUSE;
  return m;
}

}  // namespace

Material build_material(const Bsdf& bsdf) {
  return std::visit([](const auto& model) { return build(model); }, bsdf.model);
}

}  // namespace penumbra
