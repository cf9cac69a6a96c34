// Samplers as estimators: independence of pixels, pairs and seeds, and how fast integrals converge.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/kernels/sampler_points.h"
#include "tests/support/statistics.h"

namespace penumbra::sampler_statistics_test {
namespace {

constexpr double kSignificance = 0.01;

/// Counts of pairs of numbers on a square grid.
class Grid {
 public:
  void add(float a, float b) { ++counts_[std::size_t(a * kSide) * kSide + std::size_t(b * kSide)]; }
  [[nodiscard]] double p() const {
    double total = 0;
    for (double c : counts_) total += c;
    const std::vector<double> expected(counts_.size(), total / double(counts_.size()));
    return statistics::chi_square_test(counts_, expected).p;
  }

 private:
  static constexpr int kSide = 16;
  std::vector<double> counts_ = std::vector<double>(kSide * kSide);
};

class SamplerIndependence : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(All, SamplerIndependence, testing::ValuesIn(kSamplers),
                         [](const auto& tested) { return sampler_name(tested.param); });

TEST_P(SamplerIndependence, OfPixelsPairsSeedsAndAxes) {
  // Over all pixels of an image each of these couples is uniform on the square, for any one sample index.
  struct Couple {
    std::string name;
    std::function<SampleAddress(SampleAddress)> other;
  };
  const std::vector<Couple> couples{
      {"next column", [](SampleAddress at) { return ++at.x, at; }},
      {"next row", [](SampleAddress at) { return ++at.y, at; }},
      {"across the diagonal", [](SampleAddress at) { return std::swap(at.x, at.y), ++at.x, at; }},
      {"next tile", [](SampleAddress at) { return at.x += 16, at; }},
      {"tile below", [](SampleAddress at) { return at.y += 16, at; }},
      {"next column and pair", [](SampleAddress at) { return ++at.x, ++at.pair, at; }},
      {"next pair", [](SampleAddress at) { return ++at.pair, at; }},
      {"next step's pair", [](SampleAddress at) { return at.pair += STEP_PAIRS, at; }},
      {"next seed", [](SampleAddress at) { return ++at.seed, at; }},
  };
  const int sampler = GetParam();
  constexpr std::uint32_t kSize = 200;
  std::vector<std::pair<std::string, double>> results;
  for (std::uint32_t seed : {0u, 0xffffffffu})
    for (std::uint32_t index : {0u, 7u}) {
      for (const Couple& couple : couples) {
        Grid first, second;
        for (std::uint32_t y = 0; y < kSize; ++y)
          for (std::uint32_t x = 0; x < kSize; ++x) {
            const SampleAddress at{seed, x, y, index, 1, 16};
            const Point2 p = draw_alone(sampler, at), q = draw_alone(sampler, couple.other(at));
            first.add(p.u, q.u);
            second.add(p.v, q.v);
          }
        results.emplace_back(couple.name + ", u", first.p());
        results.emplace_back(couple.name + ", v", second.p());
      }
      Grid axes, crossed;
      for (std::uint32_t y = 0; y < kSize; ++y)
        for (std::uint32_t x = 0; x < kSize; ++x) {
          const Point2 p = draw_alone(sampler, {seed, x, y, index, 1, 16});
          const Point2 q = draw_alone(sampler, {seed, x, y, index, 2, 16});
          axes.add(p.u, p.v);
          crossed.add(p.u, q.v);
        }
      results.emplace_back("both axes", axes.p());
      results.emplace_back("axes of neighbouring pairs", crossed.p());
    }
  const double limit = statistics::sidak_significance(kSignificance, results.size());
  for (const auto& [name, p] : results) EXPECT_GT(p, limit) << name;
}

TEST(SamplerPadding, PairsInsideAPixelAreUncorrelated) {
  // Whatever the sequence inside each pair. Not for Halton points: those of different bases are one sequence.
  std::vector<double> ps;
  for (int sampler : {SAMPLER_INDEPENDENT, SAMPLER_STRATIFIED, SAMPLER_SOBOL})
    for (std::uint32_t pixel = 0; pixel < 8; ++pixel) {
      Grid grid;
      constexpr std::uint32_t kSpp = 16384;
      for (std::uint32_t i = 0; i < kSpp; ++i) {
        const Point2 p = draw_alone(sampler, {3, pixel, 0, i, 1, kSpp}),
                     q = draw_alone(sampler, {3, pixel, 0, i, 2, kSpp});
        grid.add(p.u, q.u);
      }
      ps.push_back(grid.p());
    }
  for (double p : ps) EXPECT_GT(p, statistics::sidak_significance(kSignificance, ps.size()));
}

/// Root mean square error of the mean of f over `spp` samples, over many pixels.
double error_of(int sampler, std::uint32_t spp, const std::function<double(Point2)>& f, double truth) {
  constexpr std::uint32_t kPixels = 200;
  double squares = 0;
  for (std::uint32_t x = 0; x < kPixels; ++x) {
    double sum = 0;
    for (std::uint32_t i = 0; i < spp; ++i) sum += f(draw_alone(sampler, {11, x, 0, i, 1, spp}));
    squares += std::pow(sum / spp - truth, 2);
  }
  return std::sqrt(squares / kPixels);
}

/// Least-squares slope of log error over log samples, 64 ... 16384.
double convergence_slope(int sampler, const std::function<double(Point2)>& f, double truth) {
  std::vector<double> x, y;
  for (std::uint32_t spp = 64; spp <= 16384; spp *= 4) {
    x.push_back(std::log(double(spp)));
    y.push_back(std::log(error_of(sampler, spp, f, truth)));
  }
  const double n = double(x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sx += x[i];
    sy += y[i];
    sxx += x[i] * x[i];
    sxy += x[i] * y[i];
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

constexpr double kSlopeTolerance = 0.1;

/// A shadow's edge across the square: v < 0.7 - 0.43 u.
double half_plane(Point2 p) { return p.v < 0.7 - 0.43 * p.u ? 1 : 0; }
constexpr double kHalfPlaneTruth = 0.7 - 0.43 / 2;

TEST(SamplerConvergence, SmoothIntegrand) {
  EXPECT_NEAR(convergence_slope(SAMPLER_INDEPENDENT, smooth, kSmoothTruth), -0.5, kSlopeTolerance);
  EXPECT_NEAR(convergence_slope(SAMPLER_STRATIFIED, smooth, kSmoothTruth), -1.0, kSlopeTolerance);
  EXPECT_NEAR(convergence_slope(SAMPLER_SOBOL, smooth, kSmoothTruth), -1.5, kSlopeTolerance);
}

TEST(SamplerConvergence, ShadowEdge) {
  EXPECT_NEAR(convergence_slope(SAMPLER_INDEPENDENT, half_plane, kHalfPlaneTruth), -0.5, kSlopeTolerance);
  EXPECT_NEAR(convergence_slope(SAMPLER_STRATIFIED, half_plane, kHalfPlaneTruth), -0.75, kSlopeTolerance);
  EXPECT_NEAR(convergence_slope(SAMPLER_SOBOL, half_plane, kHalfPlaneTruth), -0.75, kSlopeTolerance);
}

TEST(SamplerConvergence, HaltonBeatsIndependentSamples) {
  const double independent = error_of(SAMPLER_INDEPENDENT, 1024, smooth, kSmoothTruth);
  EXPECT_LT(error_of(SAMPLER_HALTON, 1024, smooth, kSmoothTruth), 0.2 * independent);
}

}  // namespace
}  // namespace penumbra::sampler_statistics_test
