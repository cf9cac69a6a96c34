// The BSDFs that tests look at.
#pragma once

#include <ostream>
#include <string>

#include "kernels/host/material_closure.h"
#include "tests/kernels/kernels_under_test.h"

namespace penumbra {

struct BsdfCase {
  std::string name;
  float diffuse, specular, exponent;

  /// As the scene builder makes it.
  [[nodiscard]] Material material() const {
    Material m{};
    m.family = specular > 0 ? FAMILY_PHONG : FAMILY_DIFFUSE;
    m.diffuse = make_vec3(diffuse, diffuse, diffuse);
    m.specular = make_vec3(specular, specular, specular);
    m.exponent = exponent;
    return m;
  }
  [[nodiscard]] Closure closure() const { return closure_of(material()); }
};

inline void PrintTo(const BsdfCase& bsdf_case, std::ostream* out) { *out << bsdf_case.name; }

inline const BsdfCase kCases[] = {
    {"Diffuse", 0.5f, 0, 0},
    {"Phong0", 0, 0.8f, 0},
    {"Phong1", 0, 0.8f, 1},
    {"Phong10", 0, 0.8f, 10},
    {"Phong100", 0, 0.8f, 100},
    {"HalfPhong1", 0.4f, 0.4f, 1},
    {"HalfPhong30", 0.4f, 0.4f, 30},
    {"MostlyDiffuse100", 0.6f, 0.2f, 100},
    {"MostlyPhong10000", 0.1f, 0.8f, 1e4f},
};

}  // namespace penumbra
