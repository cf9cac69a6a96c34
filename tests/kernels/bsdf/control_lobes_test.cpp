// Control lobes of glossy closures against the fit's own formulas in double, and against the closures: the
// table is accurate between its knots, too.
#include "kernels/bsdf/control_lanes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes/device/ltc/ltc_fit.h"
#include "scenes/device/ltc/ltc_table.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra {
namespace {

struct TableScene {
  std::vector<LtcCell> cells = ltc_table();
  Scene scene{};
  TableScene() {
    scene.ltc_cells = cells.data();
    scene.header.features = FEATURE_ALL;
  }
};

const struct {
  ltc::Distribution fitted;
  int kernels;
  double mean_discrimination, worst_discrimination, worst_albedo;
} kDistributions[] = {
    // Mean and worst that the fit reports between knots (scenes/device/ltc/README.md). Angles and roughness
    // here
    // are spread otherwise, more of them where the lobe is narrow and the fit is better.
    {ltc::Distribution::kGgx, DISTRIBUTION_GGX, 0.032, 0.215, 2e-3},
    {ltc::Distribution::kBeckmann, DISTRIBUTION_BECKMANN, 0.097, 0.16, 3e-3}};

TEST(ControlLobes, TheTableIsNearTheReflections) {
  const TableScene table;
  RandomNumbers random(1);
  for (const auto& d : kDistributions) {
    double sum = 0;
    constexpr int kPoints = 150;
    for (int i = 0; i < kPoints; ++i) {
      const double alpha = std::pow(10.0, random.between(-3, 0)), cosine = random.between(0.005, 1);
      const MicrofacetLobe lobe = microfacet_lobe(&table.scene, d.kernels, float(alpha), float(cosine));
      const ltc::Lobe truth(d.fitted, alpha, cosine);
      double discrimination = 0;
      constexpr int kSide = 64;
      double albedo = 0;
      const ltc::Transform transform{double(lobe.ltc.width_x), double(lobe.ltc.width_y),
                                     double(lobe.ltc.shift)};
      const auto add = [&](const glm::dvec3& wi) {
        const double f = truth(wi), g = double(lobe.albedo) * transform(wi);
        const double weight = 1 / (truth.pdf(wi) + transform(wi));
        if (f + g > 0) discrimination += (f - g) * (f - g) / (f + g) * weight / 2;
        albedo += f * weight;
      };
      for (int u = 0; u < kSide; ++u)
        for (int v = 0; v < kSide; ++v) {
          add(truth.sample((u + .5) / kSide, (v + .5) / kSide));
          add(transform.sample((u + .5) / kSide, (v + .5) / kSide));
        }
      albedo /= kSide * kSide;
      discrimination /= kSide * kSide * albedo;
      EXPECT_LT(discrimination, d.worst_discrimination) << "alpha " << alpha << " cosine " << cosine;
      EXPECT_NEAR(double(lobe.albedo), albedo, d.worst_albedo + 4e-3)
          << "alpha " << alpha << " cosine " << cosine;
      sum += discrimination;
    }
    EXPECT_LT(sum / kPoints, d.mean_discrimination);
  }
}

TEST(ControlLobes, ValuesAreThoseOfTheTransform) {
  const TableScene table;
  RandomNumbers random(2);
  for (int i = 0; i < 20'000; ++i) {
    const double alpha = std::pow(10.0, random.between(-3, 0));
    const auto cosine =
        float(random.below(4) == 0 ? std::pow(10.0, random.between(-6, 0)) : random.uniform());
    const MicrofacetLobe lobe = microfacet_lobe(&table.scene, DISTRIBUTION_GGX, float(alpha), cosine);
    const ControlLobes c = make_control_lobes(make_vec3(0.3f, 0, 0), lobe, make_vec3(0, 1, 0));
    ASSERT_TRUE(std::isfinite(c.width_x) && c.width_x > 0 && std::isfinite(c.shift));
    const ltc::Transform transform{double(c.width_x), double(c.width_y), double(c.shift)};
    const glm::dvec3 w = transform.sample(random.uniform(), random.uniform());
    const double phi = random.between(0, 6.28), sine = std::sqrt(1 - double(cosine) * double(cosine));
    const vec3 wo = make_vec3(float(-sine * std::cos(phi)), float(-sine * std::sin(phi)), cosine);
    const vec3 wi = make_vec3(float(w.x * std::cos(phi) - w.y * std::sin(phi)),
                              float(w.x * std::sin(phi) + w.y * std::cos(phi)), float(w.z));
    const vec3 value = control_value(c, wo, wi);
    // Rounded directions are off by some 1e-7 along the plane z = 1 times its slope there, over the width;
    // the density's slope is at most 4 of its value a width.
    const double z = std::max(w.z, 1e-9);
    const double off = 4e-7 * (1 + std::abs(w.x / z)) / z / double(std::min(c.width_x, c.width_y));
    const double truth = double(lobe.albedo) * transform(w);
    EXPECT_NEAR(double(value.y), truth, truth * (1e-5 + 4 * off)) << alpha << " " << cosine;
    EXPECT_NEAR(double(value.x), 0.3 * w.z / M_PI, 1e-6);
    EXPECT_EQ(control_value(c, wo, make_vec3(wi.x, wi.y, -wi.z)).y, 0);
  }
}

// Extremes: all finite, and the effective angle of Fresnel's term is one.
TEST(ControlLobes, ExtremesAreFinite) {
  const TableScene table;
  for (const int distribution : {DISTRIBUTION_GGX, DISTRIBUTION_BECKMANN})
    for (const float alpha : {0.0f, 1e-30f, 1e-4f, 1e-3f, 0.5f, 1.0f, 3.0f, 1e30f})
      for (const float cosine : {0.0f, 1e-30f, 1e-6f, 1e-3f, 0.5f, 0.999999f, 1.0f, 1.0000001f}) {
        const MicrofacetLobe lobe = microfacet_lobe(&table.scene, distribution, alpha, cosine);
        const ControlLobes c = make_control_lobes(make_vec3(0, 0, 0), lobe, make_vec3(1, 1, 1));
        for (const float x : {c.width_x, c.width_y, c.shift, c.specular.x, fresnel_cosine(lobe)})
          EXPECT_TRUE(std::isfinite(x)) << alpha << " " << cosine;
        EXPECT_GT(c.width_x, 0);
        EXPECT_GT(c.width_y, 0);
        EXPECT_GE(fresnel_cosine(lobe), 0);
        EXPECT_LE(fresnel_cosine(lobe), 1);
        EXPECT_GT(lobe.albedo, 0);
        EXPECT_LE(lobe.albedo, 1.0001f);
      }
}

}  // namespace
}  // namespace penumbra
