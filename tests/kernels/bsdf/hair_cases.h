// Fibres of hair to test.
#pragma once

#include <string>
#include <vector>

#include "tests/kernels/bsdf/bsdf_case.h"

namespace penumbra {

/// `variant`: bits HAIR_*. Seen by its texture coordinate, it is seen at an offset of 0.4 radii.
inline BsdfCase hair_case(const std::string& name, double beta_m, double beta_n, double sigma_a,
                          int variant) {
  Material m = empty_material(FAMILY_HAIR);
  m.variant = variant;
  m.alpha_u = float(beta_m);
  m.alpha_v = float(beta_n);
  m.transmitted = grey(sigma_a);
  m.ior = 1.55f;
  m.tilt = float(2.0 / 360);
  m.offset = 0.4f;
  // Far outside the narrowest lobe d ln M = 2 / v, and d ln N = 1 / s, of roughness 0.3. The quadrature takes
  // seconds, so one case is enough.
  return {name, m, 1, 100, 1, (variant & HAIR_ALONG_V) != 0, true};
}

inline std::vector<BsdfCase> hair_cases() {
  return {hair_case("Hair", 0.3, 0.3, 0.2, HAIR_ALONG_V),
          hair_case("HairByV", 0.5, 0.6, 0, HAIR_OFFSET_BY_V)};
}

}  // namespace penumbra
