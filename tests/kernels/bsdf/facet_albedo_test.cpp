// The directional albedos of OpenPBR's microfacets.
#include "scenes/bsdfs/facet_albedo.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <string>
#include <utility>

#include "tests/kernels/bsdf/openpbr_surface.h"

namespace penumbra::openpbr_test {
namespace {

/// Appendix B.3 of glTF: V D of the trowbridge-reitz distribution, with the correlation of masking left out.
double specular_brdf(double alpha, const Exact3& wo, const Exact3& wi) {
  const Exact3 h = normalize(wo + wi);
  const double a2 = alpha * alpha, n_h = double(h.z), n_l = double(wi.z), n_v = double(wo.z);
  const double d = a2 / (kPi * std::pow(n_h * n_h * (a2 - 1) + 1, 2));
  const auto v = [&](double n) { return 1 / (n + std::sqrt(a2 + (1 - a2) * n * n)); };
  return v(n_l) * v(n_v) * d;
}

TEST(FacetAlbedos, AreTheIntegralOfTheLobe) {
  for (const double alpha : {0.3, 0.6, 1.0})
    for (const double cosine : {1.0, 0.6, 0.2}) {
      const Exact3 wo{std::sqrt(1 - cosine * cosine), 0, cosine};
      constexpr int kSteps = 500;
      double plain = 0, reflected = 0;
      for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
          const double z = (i + 0.5) / kSteps, angle = kPi * (j + 0.5) / kSteps, r = std::sqrt(1 - z * z);
          const Exact3 wi{r * std::cos(angle), r * std::sin(angle), z};
          const double value = specular_brdf(alpha, wo, wi) * z * 2 * kPi / (double(kSteps) * kSteps);
          plain += value;
          reflected += value * fresnel(double(dot(wo, normalize(wo + wi))), 1.5);
        }
      const FacetAlbedo albedo = facet_albedo(alpha, alpha, 1.5, cosine, 0);
      EXPECT_NEAR(albedo.plain, plain, 1e-3) << alpha << ' ' << cosine;
      EXPECT_NEAR(albedo.reflected, reflected, 1e-3) << alpha << ' ' << cosine;
    }
}

/// facet_albedo by 1500 x 128 midpoints over the half vectors of wo and wi, in the quantile of GGX's density
/// of normals and in azimuth: each has the visible share dot(wo, h) / cos(wo), Smith's masking of wo and that
/// of the direction it sends light to.
FacetAlbedo albedo_by_half_vectors(double alpha_u, double alpha_v, double ior, const glm::dvec3& wo) {
  constexpr int kQuantiles = 1500, kAzimuths = 128;
  const auto seen = [&](const glm::dvec3& w) {
    const double x = alpha_u * w.x, y = alpha_v * w.y, z = w.z;
    return z > 0 ? 2 * z / (z + std::sqrt(z * z + x * x + y * y)) : 0;
  };
  FacetAlbedo sum{0, 0, 0, 0};
  for (int j = 0; j < kAzimuths; ++j)
    for (int i = 0; i < kQuantiles; ++i) {
      const double root = (i + 0.5) / kQuantiles, tail = std::pow(root, 4);  // of the quantile, from its end
      const double slope = std::sqrt((1 - tail) / tail), angle = 2 * kPi * (j + 0.5) / kAzimuths;
      const glm::dvec3 h = glm::normalize(
          glm::dvec3{alpha_u * slope * std::cos(angle), alpha_v * slope * std::sin(angle), 1.0});
      const double cosine = glm::dot(wo, h);
      if (cosine <= 0) continue;
      const double weight =
          4 * std::pow(root, 3) / (double(kQuantiles) * kAzimuths) * cosine / h.z / wo.z * seen(wo);
      const double sine2 = (1 - cosine * cosine) / (ior * ior);
      const double reflectance = sine2 < 1 ? fresnel(cosine, ior) : 1;
      const double reflection = weight * seen(2.0 * cosine * h - wo);
      const double along = cosine / ior - std::sqrt(std::max(0.0, 1 - sine2));
      const double refraction = sine2 < 1 ? weight * seen(wo / ior - along * h) : 0;
      sum.plain += reflection;
      sum.reflected += reflection * reflectance;
      sum.scattered += reflection * reflectance + refraction * (1 - reflectance);
      sum.refracted += refraction;
    }
  return sum;
}

TEST(FacetAlbedos, AreThoseOfHalfVectorsOfAllRoughnesses) {
  const std::pair<double, double> roughnesses[] = {{1e-3, 1e-3}, {0.02, 0.02}, {0.05, 0.05}, {0.09, 0.09},
                                                   {0.16, 0.16}, {0.4, 0.4},   {1, 1},       {0.3, 0.04}};
  for (const auto& [u, v] : roughnesses)
    for (const double ior : {1.05, 1.5, 2.4, 1 / 1.5})
      for (const double cosine : {1.0, 0.6, 0.2, 0.05, 0.005})
        for (const double across : {0.0, 0.5}) {
          if (u == v && across > 0) continue;
          const double sine = std::sqrt(1 - cosine * cosine);
          const glm::dvec3 wo{sine * std::sqrt(1 - across), sine * std::sqrt(across), cosine};
          const FacetAlbedo expected = albedo_by_half_vectors(u, v, ior, wo),
                            albedo = facet_albedo(u, v, ior, cosine, across);
          const std::string what = fmt::format("{} {} {} {} {}", u, v, ior, cosine, across);
          // As facet_albedo promises.
          EXPECT_NEAR(albedo.plain, expected.plain, 6e-4) << what;
          EXPECT_NEAR(albedo.reflected, expected.reflected, ior < 1 ? 1.4e-3 : 6e-4) << what;
          EXPECT_NEAR(albedo.scattered, expected.scattered, ior < 1 ? 1.4e-3 : 6e-4) << what;
          EXPECT_NEAR(albedo.refracted, expected.refracted, ior < 1 ? 3.1e-3 : 6e-4) << what;
        }
}

TEST(FacetAlbedos, DoNotDependOnWhichAxisIsWhich) {
  for (const double across : {0.0, 0.3, 1.0}) {
    const FacetAlbedo a = facet_albedo(0.7, 0.2, 1.5, 0.4, across),
                      b = facet_albedo(0.2, 0.7, 1.5, 0.4, 1 - across);
    EXPECT_NEAR(a.plain, b.plain, 1e-3);
    EXPECT_NEAR(a.scattered, b.scattered, 1e-3);
  }
}

}  // namespace
}  // namespace penumbra::openpbr_test
