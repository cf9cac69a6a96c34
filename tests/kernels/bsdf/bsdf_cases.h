// The BSDFs that are tested.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/kernels/bsdf/disney_cases.h"
#include "tests/kernels/bsdf/hair_cases.h"

namespace penumbra {

/// Diffuse where there is no lobe.
inline BsdfCase phong_case(const std::string& name, double diffuse, double specular, double exponent) {
  Material m = empty_material(specular > 0 ? FAMILY_PHONG : FAMILY_DIFFUSE);
  m.diffuse = grey(diffuse);
  m.specular = grey(specular);
  m.exponent = float(exponent);
  // sqrt(n) where the lobe has any value.
  return {name,
          m,
          (diffuse + specular) * (exponent + 2) / (exponent + 1),
          10 * std::sqrt(exponent),
          diffuse + specular,
          true,
          true};
}

inline BsdfCase sheet_case(const std::string& name, double reflectance, double transmittance) {
  Material m = empty_material(FAMILY_DIFFTRANS);
  m.diffuse = grey(reflectance);
  m.transmitted = grey(transmittance);
  const double both = reflectance + transmittance;
  return {name, m, both, 0, both, true, true};
}

/// Indices at 630, 532 and 465 nm or so: gold.
inline Material gold(int family, double alpha_u, double alpha_v) {
  Material m = empty_material(family);
  m.eta = make_vec3(0.143f, 0.375f, 1.442f);
  m.k = make_vec3(3.983f, 2.386f, 1.603f);
  m.specular = grey(1);
  m.alpha_u = float(alpha_u);
  m.alpha_v = float(alpha_v);
  return m;
}

// Walter's approximation of Beckmann's masking is off by 0.35%.
constexpr double kMostMaskingRatio = 1.0035;
inline BsdfCase conductor_case(const std::string& name, bool ggx, double alpha_u, double alpha_v) {
  const double least = std::min(alpha_u, alpha_v);
  return {name + (ggx ? "Ggx" : "Beckmann"),
          gold(ggx ? FAMILY_ROUGHCONDUCTOR_GGX : FAMILY_ROUGHCONDUCTOR_BECKMANN, alpha_u, alpha_v),
          ggx ? 1.0 : kMostMaskingRatio,
          0,
          ggx ? 1.0 : kMostMaskingRatio * kMostMaskingRatio,
          least > 0.05,
          false};
}

/// `ior`: of the side that is not seen, over that of the other.
inline BsdfCase dielectric_case(const std::string& name, bool ggx, double alpha_u, double alpha_v,
                                double ior) {
  BsdfCase result = conductor_case(name, ggx, alpha_u, alpha_v);
  Material& m = result.made;
  m.family = ggx ? FAMILY_ROUGHDIELECTRIC_GGX : FAMILY_ROUGHDIELECTRIC_BECKMANN;
  m.eta = m.k = grey(0);
  m.specular = m.transmitted = grey(1);
  m.ior = float(ior);
  result.most_weight *= std::max(1.0, 1 / (ior * ior));
  return result;
}

inline BsdfCase smooth_case(const std::string& name, int family, double ior) {
  Material m = gold(family, 0, 0);
  m.transmitted = grey(1);
  m.ior = float(ior);
  return {name, m, std::max(1.0, 1 / (ior * ior)), 0, 1, false, true};
}

inline std::vector<BsdfCase> all_bsdf_cases() {
  std::vector<BsdfCase> cases = {
      phong_case("Diffuse", 0.5, 0, 0),
      phong_case("Phong0", 0, 0.8, 0),
      phong_case("Phong1", 0, 0.8, 1),
      phong_case("Phong10", 0, 0.8, 10),
      phong_case("Phong100", 0, 0.8, 100),
      phong_case("HalfPhong1", 0.4, 0.4, 1),
      phong_case("HalfPhong30", 0.4, 0.4, 30),
      phong_case("MostlyDiffuse100", 0.6, 0.2, 100),
      phong_case("MostlyPhong10000", 0.1, 0.8, 1e4),
      sheet_case("SheetOfBoth", 0.2, 0.7),
      sheet_case("SheetThatTransmits", 0, 0.5),
      sheet_case("SheetThatReflects", 0.5, 0),
      smooth_case("Conductor", FAMILY_CONDUCTOR, 1.5),
      smooth_case("Dielectric", FAMILY_DIELECTRIC, 1.5),
      smooth_case("DielectricInside", FAMILY_DIELECTRIC, 1 / 1.5),
      smooth_case("ThinDielectric", FAMILY_THINDIELECTRIC, 1.5),
  };
  for (const bool ggx : {true, false}) {
    cases.push_back(conductor_case("Conductor1", ggx, 1, 1));
    cases.push_back(conductor_case("Conductor05", ggx, 0.5, 0.5));
    cases.push_back(conductor_case("Conductor01", ggx, 0.1, 0.1));
    cases.push_back(conductor_case("ConductorAcross", ggx, 0.15, 0.6));
    cases.push_back(conductor_case("ConductorAlong", ggx, 0.9, 0.1));
    cases.push_back(conductor_case("ConductorSmooth", ggx, 1e-3, 1e-3));
    cases.push_back(conductor_case("ConductorSmoothest", ggx, 1e-4, 1e-4));
    cases.push_back(dielectric_case("Glass1", ggx, 1, 1, 1.5));
    cases.push_back(dielectric_case("Glass03", ggx, 0.3, 0.3, 1.5));
    cases.push_back(dielectric_case("GlassInside03", ggx, 0.3, 0.3, 1 / 1.5));
    cases.push_back(dielectric_case("DiamondAcross", ggx, 0.15, 0.5, 2.4));
    cases.push_back(dielectric_case("DiamondInside", ggx, 0.2, 0.2, 1 / 2.4));
    cases.push_back(dielectric_case("Thin", ggx, 0.5, 0.5, 1.1));
    cases.push_back(dielectric_case("GlassSmooth", ggx, 1e-3, 1e-3, 1.5));
    cases.push_back(dielectric_case("GlassSmoothestInside", ggx, 1e-4, 1e-4, 1 / 1.5));
  }
  for (const BsdfCase& each : disney_cases()) cases.push_back(each);
  for (const BsdfCase& each : hair_cases()) cases.push_back(each);
  return cases;
}

inline const std::vector<BsdfCase> kCases = all_bsdf_cases();

/// The cases with, or without, properties.
inline std::vector<BsdfCase> bsdf_cases_of(bool (*wanted)(const BsdfCase&)) {
  std::vector<BsdfCase> cases;
  for (const BsdfCase& each : kCases)
    if (wanted(each)) cases.push_back(each);
  return cases;
}

}  // namespace penumbra
