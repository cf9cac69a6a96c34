// Phase functions against their definitions in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra {
namespace {

constexpr double kAsymmetries[] = {-0.9999, -0.99, -0.7, -1e-4, 0, 1e-4, 0.3, 0.7, 0.99, 0.9999};

double density(double g, double mu) {
  const double square = (1 - g) * (1 - g) + 2 * g * (1 - mu);
  return (1 - g * g) / (4 * std::numbers::pi * square * std::sqrt(square));
}

/// 1 - mu of the direction that u chooses.
double versine(double g, double u) {
  const double d = 1 - g + 2 * g * u;
  return 2 * (1 - g) * (1 - g) * (1 - u) * (1 + g * u) / (d * d);
}

class PhaseTest : public ::testing::Test {
 protected:
  /// Of the lobes; the others have no weight.
  void use(const std::vector<PhaseLobe>& lobes) {
    tables_.phase_lobes.assign(PHASE_LOBES, PhaseLobe{});
    std::copy(lobes.begin(), lobes.end(), tables_.phase_lobes.begin());
    closure_ = black_closure();
    closure_.family = FAMILY_PHASE;
    scene_ = tables_.scene();
  }
  [[nodiscard]] BsdfSample sample(float u, float v, float choice) const {
    return phase_sample(&scene_, closure_, wo_, u, v, choice);
  }
  [[nodiscard]] double cosine(const BsdfSample& s) const { return -double(dot3(s.wi, wo_)); }

  vec3 wo_ = normalize3(make_vec3(0.3f, -0.5f, 0.8f));
  SceneTables tables_;
  Scene scene_{};
  Closure closure_{};
};

// Rounding of the density's operations, each within 2^-24, where none cancels.
TEST_F(PhaseTest, HenyeyGreensteinIsItsFormulaAtEveryAngle) {
  for (const double wanted : kAsymmetries) {
    const float g = float(wanted);
    for (double exponent = -12; exponent <= 0.301; exponent += 0.05) {
      const float away = float(std::min(std::pow(10.0, exponent), 2.0));
      const double mu = g < 0 ? double(away) - 1 : 1 - double(away);
      const double truth = g < 0 ? density(-double(g), -mu) : density(double(g), mu);
      // By 1 - mu where mu itself is not a double's business any more.
      EXPECT_NEAR(henyey_greenstein(g, away) / truth, 1, 12 * 0x1p-24) << g << " at " << mu;
    }
  }
}

TEST_F(PhaseTest, DirectionsOfHenyeyGreensteinAreThoseOfTheirDistribution) {
  RandomNumbers random(1);
  const vec3 forward = make_vec3(0, 0, 1);
  for (const double wanted : kAsymmetries) {
    const float g = float(wanted);
    for (int i = 0; i < 2000; ++i) {
      const float u = float(random.between(0, 1)), v = float(random.between(0, 1));
      const vec3 wi = sample_henyey_greenstein(forward, g, u, v);
      const double away = versine(std::abs(double(g)), u);
      const double sine = std::sqrt(away * (2 - away));
      EXPECT_NEAR(std::hypot(wi.x, wi.y) / sine, 1, 24 * 0x1p-24) << g << ", u = " << u;
      // 14 roundings, each of 2^-24, of 1 - mu, and those of the cosine and of its frame.
      EXPECT_NEAR(wi.z, g < 0 ? away - 1 : 1 - away, 14 * 0x1p-24 * away + 3 * 0x1p-24) << g << ", u = " << u;
    }
  }
}

TEST_F(PhaseTest, HaveTheMomentsOfTheirDefinition) {
  // Means over the midpoints of n intervals of u: off by less than 1 / n for a cosine that grows with u, by
  // less than 2 / n for its square.
  constexpr int kMidpoints = 200'000;
  const auto moments = [&](const std::vector<PhaseLobe>& lobes) {
    use(lobes);
    double first = 0, second = 0;
    for (int i = 0; i < kMidpoints; ++i) {
      // The choice goes through all lobes as u does, many times.
      const float choice = float(std::fmod((i + 0.5) * 0.6180339887498949, 1.0));
      const double mu = cosine(sample(float((i + 0.5) / kMidpoints), 0.3f, choice));
      first += mu / kMidpoints;
      second += (1.5 * mu * mu - 0.5) / kMidpoints;
    }
    return std::pair(first, second);
  };
  for (const double g : kAsymmetries) {
    const auto [first, second] = moments({{PHASE_HG, float(g), 1}});
    EXPECT_NEAR(first, g, 2.0 / kMidpoints + 1e-6) << g;
    EXPECT_NEAR(second, g * g, 3.0 / kMidpoints + 1e-6) << g;
  }
  const auto [first, second] = moments({{PHASE_RAYLEIGH, 0, 1}});
  EXPECT_NEAR(first, 0, 2.0 / kMidpoints + 1e-6);
  EXPECT_NEAR(second, 0.1, 3.0 / kMidpoints + 1e-6);
  // A mixture's: the golden ratio's multiples fill each lobe's share to within 3 log n / n.
  const auto [mean, other] =
      moments({{PHASE_HG, 0.8f, 0.5f}, {PHASE_HG, -0.5f, 0.25f}, {PHASE_RAYLEIGH, 0, 0.25f}});
  EXPECT_NEAR(mean, 0.5 * 0.8 - 0.25 * 0.5, 4e-4);
  EXPECT_NEAR(other, 0.5 * 0.64 + 0.25 * 0.25 + 0.25 * 0.1, 4e-4);
}

TEST_F(PhaseTest, AreDensitiesAndSamplesWeighOne) {
  for (const std::vector<PhaseLobe>& lobes :
       {std::vector<PhaseLobe>{{PHASE_HG, 0, 1}},
        {{PHASE_HG, 0.6f, 1}},
        {{PHASE_RAYLEIGH, 0, 1}},
        {{PHASE_HG, 0.9f, 0.5f}, {PHASE_HG, -0.4f, 0.3f}, {PHASE_RAYLEIGH, 0, 0.2f}}}) {
    use(lobes);
    // Simpson's rule over the cosine, 2 pi around.
    constexpr int kSteps = 4000;
    const vec3 axis = negate(wo_);
    double sum = 0;
    for (int i = 0; i <= kSteps; ++i) {
      const double mu = -1 + 2.0 * i / kSteps, sine = std::sqrt(std::max(0.0, 1 - mu * mu));
      const vec3 wi = from_frame(axis, float(sine), 0, float(mu));
      const double weight = i == 0 || i == kSteps ? 1 : (i % 2 == 1 ? 4 : 2);
      sum += weight * phase_eval(&scene_, closure_, wo_, wi).pdf;
    }
    EXPECT_NEAR(sum * (2.0 / kSteps) / 3 * 2 * std::numbers::pi, 1, 1e-5);
    RandomNumbers random(2);
    for (int i = 0; i < 1000; ++i) {
      const BsdfSample s =
          sample(float(random.between(0, 1)), float(random.between(0, 1)), float(random.between(0, 1)));
      EXPECT_NEAR(length3(s.wi), 1, 4 * 0x1p-23);
      EXPECT_FLOAT_EQ(s.weight.x, 1);
      EXPECT_FLOAT_EQ(s.pdf, phase_eval(&scene_, closure_, wo_, s.wi).pdf);
    }
  }
}

TEST_F(PhaseTest, EndsOfTheNumbersAreFinite) {
  const float last = ONE_MINUS_EPSILON;
  for (const float g : {-0.99999f, 0.0f, 0.99999f})
    for (const float u : {0.0f, last})
      for (const float choice : {0.0f, last}) {
        use({{PHASE_HG, g, 0.5f}, {PHASE_RAYLEIGH, 0, 0.5f}});
        const BsdfSample s = sample(u, 0.25f, choice);
        EXPECT_TRUE(std::isfinite(s.pdf) && s.pdf > 0) << g << " " << u << " " << choice;
        EXPECT_NEAR(length3(s.wi), 1, 4 * 0x1p-23);
      }
}

}  // namespace
}  // namespace penumbra
