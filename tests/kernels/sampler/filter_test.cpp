// Filter importance sampling against quadrature of the filters themselves.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <ostream>
#include <string>
#include <vector>
#include "scenes/device/filter_table.h"
#include "tests/kernels/kernels_under_test.h"

namespace penumbra {
namespace {

struct FilterCase {
  std::string name;
  FilterKind kind;
  float radius;
  float stddev = 0.5f, b = 1.0f / 3, c = 1.0f / 3;
};

void PrintTo(const FilterCase& filter_case, std::ostream* out) { *out << filter_case.name; }

Film film_of(const FilterCase& filter_case) {
  Film film;
  film.filter = filter_case.kind;
  film.filter_radius = filter_case.radius;
  film.filter_stddev = filter_case.stddev;
  film.filter_b = filter_case.b;
  film.filter_c = filter_case.c;
  return film;
}

int kernel_filter(FilterKind kind) {
  return kind == FilterKind::kBox ? FILTER_BOX : kind == FilterKind::kTent ? FILTER_TENT : FILTER_TABULATED;
}

/// Midpoint rule on [low, high]; enough steps that its error, (high - low)^3 max|f''| / (24 n^2), stays below
/// 1e-7 for the filters here.
double integrate(double low, double high, const std::function<double(double)>& f) {
  constexpr int kSteps = 20'000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) sum += f(low + (high - low) * (i + 0.5) / kSteps);
  return sum * (high - low) / kSteps;
}

class Filters : public testing::TestWithParam<FilterCase> {
 protected:
  Film film_ = film_of(GetParam());
  std::vector<float> table_ = filter_table(film_);
  int kernel_filter_ = kernel_filter(GetParam().kind);

  FilterSample sample(float u) const { return sample_filter(kernel_filter_, table_.data(), u); }
  /// Weighted mean of g over samples at equally spaced u.
  double sampled_mean(const std::function<double(double)>& g) const {
    constexpr int kSamples = 1 << 18;
    double sum = 0;
    for (int i = 0; i < kSamples; ++i) {
      const FilterSample s = sample((float(i) + 0.5f) / kSamples);
      sum += double(s.weight) * g(s.x);
    }
    return sum / kSamples;
  }
  double filter_mean(const std::function<double(double)>& g) const {
    const auto f = [&](double x) { return filter_value(film_, x); };
    return integrate(-1, 1, [&](double x) { return f(x) * g(x); }) / integrate(-1, 1, f);
  }
};

INSTANTIATE_TEST_SUITE_P(
    All, Filters,
    testing::Values(FilterCase{"Box", FilterKind::kBox, 0.5f}, FilterCase{"Tent", FilterKind::kTent, 1.0f},
                    FilterCase{"Gaussian", FilterKind::kGaussian, 2.0f},
                    FilterCase{"NarrowGaussian", FilterKind::kGaussian, 2.0f, 0.15f},
                    FilterCase{"Mitchell", FilterKind::kMitchell, 2.0f},
                    FilterCase{"CatmullRom", FilterKind::kMitchell, 2.0f, 0.5f, 0.0f, 0.5f},
                    FilterCase{"BSpline", FilterKind::kMitchell, 3.0f, 0.5f, 1.0f, 0.0f},
                    FilterCase{"Lanczos", FilterKind::kLanczos, 3.0f},
                    FilterCase{"LanczosOfTwoLobes", FilterKind::kLanczos, 2.0f}),
    [](const auto& tested) { return tested.param.name; });

// Between knots the inverse distribution is interpolated: its error is second order in the cell's width,
// 2^-8, times its curvature, which is largest in the last cell; that holds 2^-16 of the mass.
constexpr double kMomentTolerance = 5e-5;
// A knot of the distribution function is exact; between knots it is off by less than the cell's mass, at most
// 2^-7.
constexpr double kCellMass = 0x1p-7;

TEST_P(Filters, WeightsAverageToOne) {
  EXPECT_NEAR(sampled_mean([](double) { return 1; }), 1, 1e-5);
  double sum = 0;  // each cell's weight by its probability
  for (int i = 0; i < FILTER_CELLS; ++i)
    sum += table_[std::size_t(FILTER_CELLS + 1 + i)] * (2 * (FILTER_CELLS - i) - 1.0) /
           (FILTER_CELLS * FILTER_CELLS);
  EXPECT_NEAR(sum, 1, 1e-6);
}

TEST_P(Filters, MomentsAreTheFilters) {
  for (int order = 1; order <= 4; ++order) {
    const auto power = [order](double x) { return std::pow(x, order); };
    EXPECT_NEAR(sampled_mean(power), filter_mean(power), kMomentTolerance) << "order " << order;
  }
}

TEST_P(Filters, DistributionIsTheFilters) {
  const auto magnitude = [this](double x) { return std::abs(filter_value(film_, x)); };
  const double absolute = integrate(-1, 1, magnitude),
               signed_mass = integrate(-1, 1, [this](double x) { return filter_value(film_, x); });
  for (double end : {-0.75, -0.5, -0.2, 0.0, 0.1, 0.3, 0.6, 0.9}) {
    const double expected =
        integrate(-1, end, [this](double x) { return filter_value(film_, x); }) / signed_mass;
    EXPECT_NEAR(sampled_mean([end](double x) { return x < end ? 1 : 0; }), expected,
                kCellMass * absolute / signed_mass)
        << "up to " << end;
  }
}

TEST_P(Filters, MassIsThatOfSamples) {
  // Of 2^18 samples at most one is on the wrong side, with a weight below 2; and floats' rounding.
  const FilterMass mass(kernel_filter_, table_);
  EXPECT_NEAR(mass.up_to(-1), 0, 1e-6);
  EXPECT_NEAR(mass.up_to(1), 1, 1e-6);
  for (double end : {-0.97, -0.75, -0.41, -0.2, 0.0, 0.003, 0.1, 0.3, 0.6, 0.9}) {
    EXPECT_NEAR(mass.up_to(end), sampled_mean([end](double x) { return x < end ? 1 : 0; }), 1.5e-5) << end;
  }
}

TEST_P(Filters, WeightHasTheSignOfTheFilter) {
  for (int i = 0; i < 10'000; ++i) {
    const FilterSample s = sample((float(i) + 0.5f) / 10'000);
    // In a cell that spans a change of sign the weight is the mean of both; no cell there is wider than this.
    constexpr double kWidest = 0.03;
    const double before = filter_value(film_, s.x - kWidest), after = filter_value(film_, s.x + kWidest);
    if (before * after <= 0) continue;
    EXPECT_GT(filter_value(film_, s.x) * s.weight, 0) << s.x;
  }
}

TEST_P(Filters, SamplesStayInsideTheRadiusAndGrowWithU) {
  float before = -1;
  for (int i = 0; i < (1 << 20); ++i) {
    const FilterSample s = sample(float(i) * 0x1p-20f);
    ASSERT_GE(s.x, before);
    ASSERT_TRUE(std::isfinite(s.weight));
    before = s.x;
  }
  EXPECT_LE(sample(ONE_MINUS_EPSILON).x, 1.0f);
  EXPECT_GE(sample(0.0f).x, -1.0f);
}

TEST_P(Filters, KnotsSpanTheSupportAndIncrease) {
  ASSERT_EQ(table_.size(), std::size_t(2 * FILTER_CELLS + 1));
  EXPECT_EQ(table_[0], 0.0f);
  EXPECT_EQ(table_[FILTER_CELLS], 1.0f);
  for (std::size_t i = 0; i < FILTER_CELLS; ++i) ASSERT_LE(table_[i], table_[i + 1]) << i;
}

TEST(FilterValues, ClosedForms) {
  const Film mitchell = film_of({"", FilterKind::kMitchell, 2.0f});
  EXPECT_NEAR(filter_value(mitchell, 0), 8.0 / 9, 1e-7);     // (6 - 2 B) / 6
  EXPECT_NEAR(filter_value(mitchell, 0.5), 1.0 / 18, 1e-7);  // B / 6 at one pixel
  EXPECT_NEAR(filter_value(mitchell, 1), 0, 1e-7);
  EXPECT_LT(filter_value(mitchell, 0.75), 0);                      // the negative lobe
  const Film lanczos = film_of({"", FilterKind::kLanczos, 3.0f});  // sinc(x) sinc(x / 3), x in pixels
  EXPECT_EQ(filter_value(lanczos, 0), 1);
  for (const double pixels : {1.0, 2.0, 3.0}) EXPECT_NEAR(filter_value(lanczos, pixels / 3), 0, 1e-12);
  EXPECT_NEAR(filter_value(lanczos, 0.5), -4 / (3 * std::numbers::pi * std::numbers::pi), 1e-12);  // at 1.5
  const Film gaussian = film_of({"", FilterKind::kGaussian, 2.0f});
  EXPECT_EQ(filter_value(gaussian, 1), 0);
  EXPECT_NEAR(filter_value(gaussian, 0), 1 - std::exp(-8.0), 1e-12);
  EXPECT_NEAR(filter_value(gaussian, 0.5), std::exp(-2.0) - std::exp(-8.0), 1e-12);
}

TEST(FilterValues, MitchellHasNegativeWeights) {
  const std::vector<float> table = filter_table(film_of({"", FilterKind::kMitchell, 2.0f}));
  int negative = 0;
  for (std::size_t i = FILTER_CELLS + 1; i < table.size(); ++i) negative += table[i] < 0 ? 1 : 0;
  EXPECT_GT(negative, 2);
  EXPECT_LT(negative, FILTER_CELLS / 4);
}

}  // namespace
}  // namespace penumbra
