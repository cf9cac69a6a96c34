// BSDFs: samples against densities, normalisation, reciprocity, energy, and the ends of their ranges.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/kernels/bsdf/bsdf_cases.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

vec3 direction(double theta, double phi) {
  return make_vec3(float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
                   float(std::cos(theta)));
}

/// From the normal to grazing.
const vec3 kViewers[] = {direction(0, 0), direction(0.5, 0.3), direction(1.0, 2.0), direction(1.4, 4.0),
                         direction(kPi / 2 - 1e-3, 5.5)};
const vec3 kNormal = make_vec3(0, 0, 1);
vec3 mirrored(const vec3& v) { return make_vec3(-v.x, -v.y, v.z); }

/// A grid of 10 x 20 cells in (theta, phi) over the hemisphere, and rules inside a cell: two Gauss points on
/// each of 64 steps of theta, 32 midpoints of phi.
constexpr int kRows = 10, kColumns = 20, kThetaSteps = 64, kPhiSteps = 32;

/// Integrals over the hemisphere: of the density in each cell, and of f cos.
struct Integrals {
  std::vector<double> density = std::vector<double>(kRows * kColumns);
  double total_density = 0, reflectance = 0;
};

Integrals integrate(const Closure& closure, const vec3& wo) {
  Integrals result;
  const double d_theta = kPi / 2 / (kRows * kThetaSteps), d_phi = 2 * kPi / (kColumns * kPhiSteps);
  std::vector<std::pair<float, float>> around;
  for (int j = 0; j < kColumns * kPhiSteps; ++j)
    around.emplace_back(float(std::cos((j + 0.5) * d_phi)), float(std::sin((j + 0.5) * d_phi)));
  for (int i = 0; i < kRows * kThetaSteps; ++i)
    for (double node : {0.5 - 0.5 / std::numbers::sqrt3, 0.5 + 0.5 / std::numbers::sqrt3}) {
      const double theta = (i + node) * d_theta, weight = 0.5 * std::sin(theta) * d_theta * d_phi;
      const float sine = float(std::sin(theta)), cosine = float(std::cos(theta));
      for (int j = 0; j < kColumns * kPhiSteps; ++j) {
        const auto& [x, y] = around[std::size_t(j)];
        const BsdfValue value =
            eval_bsdf(nullptr, closure, kNormal, wo, make_vec3(sine * x, sine * y, cosine));
        result.density[std::size_t(i / kThetaSteps * kColumns + j / kPhiSteps)] += double(value.pdf) * weight;
        result.reflectance += double(value.f_cos.x) * weight;
      }
    }
  for (double d : result.density) result.total_density += d;
  return result;
}

// The rules are exact to rounding for lobes wider than a step; what is left is the lobe's cut at the horizon,
// where a step holds 2^-11 of a cell.
constexpr double kQuadratureError = 5e-4;

/// 1% that any of the viewers of any of the cases fails by chance.
const double kViewerSignificance =
    statistics::sidak_significance(0.01, std::size(kViewers) * std::size(kCases));

class Bsdfs : public testing::TestWithParam<BsdfCase> {
 protected:
  Closure closure_ = GetParam().closure();
};
INSTANTIATE_TEST_SUITE_P(All, Bsdfs, testing::ValuesIn(kCases),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(Bsdfs, SamplesFollowTheDensity) {
  constexpr int kSamples = 5000 * kRows * kColumns;
  RandomNumbers random(7);
  for (const vec3& wo : kViewers) {
    const Integrals integrals = integrate(closure_, wo);
    std::vector<double> observed(integrals.density.size());
    double lost = 0;
    for (int k = 0; k < kSamples; ++k) {
      const BsdfSample s = sample_bsdf(nullptr, closure_, kNormal, wo, random.unit_float(),
                                       random.unit_float(), random.unit_float());
      if (!(s.pdf > 0)) {
        ++lost;
        continue;
      }
      const double theta = std::acos(std::min(1.0f, s.wi.z));
      double phi = std::atan2(s.wi.y, s.wi.x);
      if (phi < 0) phi += 2 * kPi;
      const int row = std::min(kRows - 1, int(theta / (kPi / 2) * kRows));
      const int column = std::min(kColumns - 1, int(phi / (2 * kPi) * kColumns));
      ++observed[std::size_t(row * kColumns + column)];
    }
    // What falls below the horizon is lost, as much as the density lacks of 1.
    EXPECT_NEAR(lost / kSamples, 1 - integrals.total_density,
                kQuadratureError + 5 * std::sqrt(lost) / kSamples);
    std::vector<double> expected = integrals.density;
    // A cell that a lobe's rim only touches may get a sample by rounding.
    for (double& e : expected) e = std::max(e * (kSamples - lost) / integrals.total_density, 1e-3);
    const statistics::TestResult result = statistics::chi_square_test(observed, expected, 5);
    EXPECT_GT(result.p, kViewerSignificance)
        << "viewer at cosine " << wo.z << ": chi^2 " << result.statistic << " with " << result.dof;
  }
}

TEST_P(Bsdfs, DensityAndReflectanceHaveTheRightIntegrals) {
  const double albedo = GetParam().diffuse + GetParam().specular;
  RandomNumbers random(8);
  for (const vec3& wo : kViewers) {
    const Integrals integrals = integrate(closure_, wo);
    const bool from_above = wo.z > 0.999f;
    // 1 but for what a lobe has below the horizon, at most half of it.
    EXPECT_LE(integrals.total_density, 1 + kQuadratureError);
    EXPECT_GE(integrals.total_density,
              (from_above || phong_lobe_share(closure_) == 0 ? 1 : 0.5) - kQuadratureError);
    // No more than arrives; from above, where (n + 2) / (2 pi) int cos^(n+1) = 1, just the material's
    // reflectances.
    EXPECT_LE(integrals.reflectance, albedo * (1 + kQuadratureError));
    if (from_above || phong_lobe_share(closure_) == 0) {
      EXPECT_NEAR(integrals.reflectance, albedo, albedo * kQuadratureError);
    }
    statistics::Sample weights;
    for (int k = 0; k < 100'000; ++k) {
      const BsdfSample s = sample_bsdf(nullptr, closure_, kNormal, wo, random.unit_float(),
                                       random.unit_float(), random.unit_float());
      weights.add(s.pdf > 0 ? s.weight.x : 0);
    }
    EXPECT_GT(statistics::t_test(weights, integrals.reflectance, kQuadratureError * albedo).p,
              kViewerSignificance);
  }
}

TEST_P(Bsdfs, AreReciprocal) {
  RandomNumbers random(9);
  for (int k = 0; k < 20'000; ++k) {
    const vec3 wo = sample_cosine_hemisphere(kNormal, random.unit_float(), random.unit_float());
    if (wo.z < 1e-3f) continue;
    const BsdfSample s = sample_bsdf(nullptr, closure_, kNormal, wo, random.unit_float(), random.unit_float(),
                                     random.unit_float());
    if (!(s.pdf > 0) || s.wi.z < 1e-3f) continue;
    const double there = eval_bsdf(nullptr, closure_, kNormal, wo, s.wi).f_cos.x / double(s.wi.z);
    const double back = eval_bsdf(nullptr, closure_, kNormal, s.wi, wo).f_cos.x / double(wo.z);
    // Rounding of the mirror direction, 2^-23, moves the lobe; that counts times its steepness, at most
    // sqrt(n) where the lobe has any value, and a few roundings more, which 1 / cosine stretches.
    const double tolerance =
        16 * 0x1p-23 * (1 + 10 * std::sqrt(double(closure_.exponent))) + 4 * 0x1p-24 / std::min(wo.z, s.wi.z);
    ASSERT_NEAR(there / back, 1, tolerance);
  }
}

TEST_P(Bsdfs, ValuesAreNeverNegativeAndZeroBelowTheHorizon) {
  RandomNumbers random(10);
  for (int k = 0; k < 50'000; ++k) {
    const vec3 n = rounded(random.direction()), wo = rounded(random.direction()),
               wi = rounded(random.direction());
    const BsdfValue value = eval_bsdf(nullptr, closure_, n, wo, wi);
    const bool reflects = dot3(n, wo) > 0 && dot3(n, wi) > 0;
    if (!reflects) {
      ASSERT_EQ(value.f_cos.x, 0);
      ASSERT_EQ(value.pdf, 0);
    } else {
      ASSERT_GE(value.f_cos.x, 0);
      ASSERT_GE(value.pdf, 0);
    }
  }
}

TEST_P(Bsdfs, SampleAgreesWithItsOwnEvaluation) {
  RandomNumbers random(11);
  for (int k = 0; k < 50'000; ++k) {
    // In the frame of the normal exactly.
    const vec3 wo = sample_cosine_hemisphere(kNormal, random.unit_float(), random.unit_float());
    const float u = random.unit_float(), v = random.unit_float(), choice = random.unit_float();
    const BsdfSample s = sample_bsdf(nullptr, closure_, kNormal, wo, u, v, choice);
    const BsdfValue value = eval_bsdf(nullptr, closure_, kNormal, wo, s.wi);
    ASSERT_EQ(s.pdf, value.pdf);
    if (s.pdf > 0) {
      ASSERT_NEAR(s.weight.x * s.pdf, value.f_cos.x, 4e-7 * value.f_cos.x);
    }
    ASSERT_NEAR(double(length(exact(s.wi))), 1, 1e-6);
    // In the world to the rounding of the directions, see AreReciprocal.
    const vec3 n = rounded(random.direction()), viewer = from_frame(n, wo.x, wo.y, wo.z);
    const BsdfSample turned = sample_bsdf(nullptr, closure_, n, viewer, u, v, choice);
    ASSERT_NEAR(double(length(exact(turned.wi))), 1, 1e-6);
    const float cosine = dot3(n, turned.wi);
    if (!(turned.pdf > 0) || cosine < 1e-3f || wo.z < 1e-3f) continue;
    const double tolerance =
        16 * 0x1p-23 * (1 + 10 * std::sqrt(double(closure_.exponent))) + 8 * 0x1p-24 / std::min(wo.z, cosine);
    const BsdfValue again = eval_bsdf(nullptr, closure_, n, viewer, turned.wi);
    ASSERT_NEAR(turned.pdf / again.pdf, 1, tolerance);
    ASSERT_NEAR(turned.weight.x * turned.pdf / again.f_cos.x, 1, tolerance);
  }
}

TEST_P(Bsdfs, WeightsAreBoundedAtAnyAngleAndAnyNumbers) {
  // f cos / pdf is a mean of the lobes' quotients: the reflectances' sum, times (n + 2) / (n + 1) for the
  // Phong lobe.
  const float bound = (GetParam().diffuse + GetParam().specular) * (closure_.exponent + 2) /
                      (closure_.exponent + 1) * 1.00001f;
  RandomNumbers random(12);
  for (double cosine : {1.0, 0.1, 1e-3, 1e-6, 1e-7})
    for (float u : {0.0f, 0x1p-24f, 0.3f, 0.99f, ONE_MINUS_EPSILON})
      for (float v : {0.0f, 0.125f, 0.5f, ONE_MINUS_EPSILON})
        for (float choice : {0.0f, 0.3f, 0.7f, ONE_MINUS_EPSILON})
          for (int k = 0; k < 10; ++k) {
            const vec3 wo = direction(std::acos(cosine), random.between(0, 2 * kPi));
            const BsdfSample s = sample_bsdf(nullptr, closure_, kNormal, wo, u, v, choice);
            ASSERT_TRUE(std::isfinite(s.pdf));
            ASSERT_TRUE(s.weight.x >= 0 && s.weight.x <= bound) << s.weight.x << " at " << cosine;
            ASSERT_TRUE(std::isfinite(s.wi.x) && std::isfinite(s.wi.y) && std::isfinite(s.wi.z));
          }
}

TEST(DiffuseBsdf, WeightIsTheReflectanceExactly) {
  const BsdfSample s = sample_bsdf(nullptr, kCases[0].closure(), kNormal, kViewers[1], 0.3f, 0.7f, 0.5f);
  EXPECT_EQ(s.weight.x, 0.5f);
}

TEST(PhongLobe, SamplesFollowTheDensityHoweverNarrow) {
  // In the lobe's own frame: cos^(n+1) of the angle to the mirror direction and the angle about it are
  // uniform, while the whole lobe is above the horizon.
  constexpr int kSide = 20, kSamples = 400'000;
  RandomNumbers random(15);
  std::vector<double> ps;
  for (double exponent : {100.0, 1e3, 1e4, 1e5})
    for (double theta : {0.0, 0.4, 0.8}) {
      const Closure c = BsdfCase{"", 0, 1, float(exponent)}.closure();
      const vec3 wo = direction(theta, 1.0);
      const Exact3 mirror = exact(mirrored(wo));
      const Exact3 s = normalize(cross(mirror, {0.3L, -0.8L, 0.1L})), t = cross(mirror, s);
      std::vector<double> counts(kSide * kSide);
      int lost = 0;
      for (int k = 0; k < kSamples; ++k) {
        const BsdfSample sample =
            sample_bsdf(nullptr, c, kNormal, wo, random.unit_float(), random.unit_float(), 0.5f);
        lost += sample.pdf > 0 ? 0 : 1;
        const Exact3 wi = exact(sample.wi), difference = wi - mirror;
        const double power =
            std::exp((exponent + 1) * std::log1p(-0.5 * double(dot(difference, difference))));
        double turns = double(std::atan2(dot(wi, t), dot(wi, s))) / (2 * kPi);
        if (turns < 0) turns += 1;
        const auto cell = [](double x) { return std::size_t(std::min(x, 1 - 1e-12) * kSide); };
        ++counts[cell(power) * kSide + cell(turns)];
      }
      EXPECT_EQ(lost, 0);
      ps.push_back(statistics::chi_square_test(
                       counts, std::vector<double>(counts.size(), double(kSamples) / (kSide * kSide)))
                       .p);
    }
  for (double p : ps) EXPECT_GT(p, statistics::sidak_significance(0.01, ps.size()));
}

TEST(PhongLobe, DensityInItsOwnFrame) {
  // (n + 1) / (2 pi) cos^n, and f = (n + 2) / (2 pi) cos^n.
  RandomNumbers random(16);
  for (double exponent : {0.0, 1.0, 30.0, 1e3, 1e4}) {
    const Closure c = BsdfCase{"", 0, 1, float(exponent)}.closure();
    for (int k = 0; k < 2000; ++k) {
      const vec3 wo = direction(random.between(0, 1.2), random.between(0, 6));
      const BsdfSample s =
          sample_bsdf(nullptr, c, kNormal, wo, random.unit_float(), random.unit_float(), 0.5f);
      if (!(s.pdf > 0)) continue;
      const double lobe = cosine_power(mirrored(wo), s.wi, float(exponent));
      ASSERT_NEAR(s.pdf, (exponent + 1) / (2 * kPi) * lobe, 1e-6 * s.pdf);
      ASSERT_NEAR(eval_bsdf(nullptr, c, kNormal, wo, s.wi).f_cos.x,
                  (exponent + 2) / (2 * kPi) * lobe * s.wi.z, 2e-6 * s.pdf);
    }
  }
}

TEST(CosinePower, AgreesWithExtendedPrecision) {
  RandomNumbers random(13);
  for (double exponent : {0.0, 0.5, 1.0, 2.0, 10.0, 100.0, 1e3, 1e4, 1e5}) {
    double worst = 0;
    for (int k = 0; k < 50'000; ++k) {
      // Angles at which the power is between 1 and e^-60.
      const Exact3 a = random.direction(), side = normalize(cross(a, random.direction()));
      const double widest = exponent > 50 ? std::sqrt(120 / exponent) : 1.5;
      const long double angle = std::min(1.5, widest) * random.uniform();
      const vec3 ra = rounded(a), rb = rounded(std::cos(angle) * a + std::sin(angle) * side);
      const long double cosine = dot(normalize(exact(ra)), normalize(exact(rb)));
      const long double truth = std::pow(cosine, (long double)exponent);
      if (truth < 1e-35L) continue;
      const long double versine = 1 - cosine;
      // The versine is off by 8 roundings of itself: the logarithm by that over the cosine and by its own
      // error; the exponential by its own.
      const long double tolerance =
          exponent * (8 * 0x1p-24L * versine / cosine - 4e-7L * std::log(cosine)) + 4e-7L;
      worst = std::max(worst,
                       double(std::abs(cosine_power(ra, rb, float(exponent)) - truth) / truth / tolerance));
    }
    EXPECT_LT(worst, 1) << "error over its bound, exponent " << exponent;
  }
}

TEST(CosinePower, IsZeroBehindAndOneAhead) {
  const vec3 x = make_vec3(1, 0, 0), y = make_vec3(0, 1, 0);
  for (float exponent : {0.0f, 1.0f, 1e4f, 1e5f}) {
    EXPECT_EQ(cosine_power(x, x, exponent), 1);
    EXPECT_EQ(cosine_power(x, y, exponent), 0);
    EXPECT_EQ(cosine_power(x, negate(x), exponent), 0);
  }
}

TEST(PhongLobe, IsAboutTheMirrorDirectionWhateverTheNormal) {
  RandomNumbers random(14);
  const Closure c = BsdfCase{"", 0, 1, 1e4f}.closure();
  for (int k = 0; k < 10'000; ++k) {
    const vec3 n = rounded(random.direction()), wo = rounded(random.direction());
    if (dot3(n, wo) < 1e-3f) continue;
    const Exact3 mirror = (2 * dot(exact(n), exact(wo))) * exact(n) - exact(wo);
    const BsdfSample s = sample_bsdf(nullptr, c, n, wo, 0, random.unit_float(), 0);
    ASSERT_LE(double(length(exact(s.wi) - mirror)), 24 * 0x1p-24);
    // At its peak, f cos is (n + 2) / (2 pi) cos.
    const double peak = (1e4 + 2) / (2 * kPi) * double(dot(exact(n), mirror));
    ASSERT_NEAR(eval_bsdf(nullptr, c, n, wo, rounded(mirror)).f_cos.x / peak, 1,
                1e-6 / double(dot3(n, wo)) + 1e-5);
  }
}

TEST(BlackBsdf, ReflectsNothing) {
  Closure c = kCases[4].closure();
  c.family = FAMILY_BLACK;
  const BsdfValue value = eval_bsdf(nullptr, c, kNormal, kViewers[1], kViewers[2]);
  EXPECT_EQ(value.f_cos.x, 0);
  EXPECT_EQ(value.pdf, 0);
  EXPECT_EQ(sample_bsdf(nullptr, c, kNormal, kViewers[1], 0.5f, 0.5f, 0.5f).pdf, 0);
}

}  // namespace
}  // namespace penumbra
