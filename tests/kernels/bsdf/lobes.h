// BSDFs from scene text, with their tables, and their integrals over the hemisphere.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scenes/bsdfs/material_tables.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra::lobes {

inline vec3 direction(double theta, double phi) {
  return make_vec3(float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
                   float(std::cos(theta)));
}

/// A grid of cells in (theta, phi) over the hemisphere, and rules inside a cell: two Gauss points on each of
/// the steps of theta, midpoints of phi.
constexpr int kRows = 10, kColumns = 20, kThetaSteps = 32, kPhiSteps = 96;

struct Integrals {
  std::vector<double> density = std::vector<double>(kRows * kColumns);  ///< of each cell
  double total_density = 0;
  glm::dvec3 reflectance{0};
};

inline std::size_t cell_of(const vec3& wi) {
  const double theta = std::acos(std::min(1.0, double(wi.z))), phi = std::atan2(double(wi.y), double(wi.x));
  const double turn = (phi < 0 ? phi + 2 * std::numbers::pi : phi) / (2 * std::numbers::pi);
  const int row = std::min(kRows - 1, int(theta / (std::numbers::pi / 2) * kRows));
  return std::size_t(row * kColumns + std::min(kColumns - 1, int(turn * kColumns)));
}

class Lobe {
 public:
  template <typename Bsdf>
  explicit Lobe(const Bsdf& bsdf) {
    MaterialTables shared(tables_.curves);
    if constexpr (requires { material_of(bsdf, shared); })
      tables_.materials.push_back(material_of(bsdf, shared));
    else
      tables_.materials.push_back(material_of(bsdf));
    shared.compute();
    closure_ = closure_of(tables_.materials[0]);
    scene_ = tables_.scene();
  }

  [[nodiscard]] const Closure& closure() const { return closure_; }
  [[nodiscard]] BsdfValue eval(const vec3& wo, const vec3& wi) const {
    return eval_bsdf(&scene_, closure_, make_vec3(0, 0, 1), wo, wi);
  }
  [[nodiscard]] BsdfSample sample(const vec3& wo, float u, float v, float choice) const {
    return sample_bsdf(&scene_, closure_, make_vec3(0, 0, 1), wo, u, v, choice);
  }

  /// Of what eval finds.
  [[nodiscard]] Integrals integrals(const vec3& wo) const {
    Integrals result;
    const double pi = std::numbers::pi;
    const double d_theta = pi / 2 / (kRows * kThetaSteps), d_phi = 2 * pi / (kColumns * kPhiSteps);
    for (int i = 0; i < kRows * kThetaSteps; ++i)
      for (const double node : {0.5 - 0.5 / std::numbers::sqrt3, 0.5 + 0.5 / std::numbers::sqrt3}) {
        const double theta = (i + node) * d_theta, weight = 0.5 * std::sin(theta) * d_theta * d_phi;
        for (int j = 0; j < kColumns * kPhiSteps; ++j) {
          const BsdfValue value = eval(wo, direction(theta, (j + 0.5) * d_phi));
          result.density[std::size_t(i / kThetaSteps * kColumns + j / kPhiSteps)] +=
              double(value.pdf) * weight;
          result.reflectance +=
              weight * glm::dvec3(double(value.f_cos.x), double(value.f_cos.y), double(value.f_cos.z));
        }
      }
    for (const double d : result.density) result.total_density += d;
    return result;
  }
  [[nodiscard]] glm::dvec3 reflectance(const vec3& wo) const { return integrals(wo).reflectance; }

 private:
  SceneTables tables_;
  Scene scene_{};
  Closure closure_{};
};

}  // namespace penumbra::lobes
