#include "scheduler/report/seed_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scheduler/image/metrics/compensated_sum.h"

namespace penumbra {

namespace {

/// Variance of the estimate of bias^2 in one value, itself estimated without bias. The estimate is the mean
/// of (x_r - A)(x_s - B) over pairs r != s, so with v = sigma^2 / R and n the sum of the variances of A and
/// B:
///   4 b^2 v + 2 v^2 R / (R - 1) + (b^2 + v) n + Var A Var B.
/// `bias_squared`, `v` and n = (A - B)^2 are estimates. The first is correlated with the second by
/// -2 v^2 / (R - 1) and with the third by -2 Var A Var B; v estimated squared is too large by
/// (R + 1) / (R - 1), exactly so for normal noise and more for heavier tails; and (A - B)^4 is 3 n^2, at
/// least 12 Var A Var B.
double variance_of_bias_squared(double bias_squared, double v, double seeds, double reference_difference) {
  const double v_squared = v * v * (seeds - 1) / (seeds + 1);
  const double n = reference_difference * reference_difference;
  return 4 * (bias_squared * v + 2 * v_squared / (seeds - 1)) + 2 * v_squared * seeds / (seeds - 1) +
         (bias_squared + v) * n + n * n / 4;
}

}  // namespace

void SeedStatistics::add(const ImagePair& pair) {
  if (seeds_ == 0) {
    references_ = pair;
    references_.image.clear();
    finite_.assign(pair.pixels(), 1);
    mean_.assign(pair.image.size(), 0);
    m2_.assign(pair.image.size(), 0);
  }
  ++seeds_;
  for (std::size_t p = 0; p < finite_.size(); ++p) finite_[p] &= pair.finite[p];
  for (std::size_t i = 0; i < mean_.size(); ++i) {  // Welford
    const double delta = pair.value(i) - mean_[i];
    mean_[i] += delta / seeds_;
    m2_[i] += delta * (pair.value(i) - mean_[i]);
  }
}

ErrorSplit SeedStatistics::split(bool weighted, double epsilon) const {
  const std::size_t channels = references_.channels.size();
  const bool two = !references_.second_reference.empty();
  CompensatedSum error, variance, bias, bias_variance;
  double pixels = 0;
  for (std::size_t p = 0; p < finite_.size(); ++p) {
    if (finite_[p] == 0) continue;
    ++pixels;
    for (std::size_t i = p * channels; i < (p + 1) * channels; ++i) {
      const double truth = references_.truth(i);
      const double w = (weighted ? 1 / (truth * truth + epsilon) : 1.0) / double(channels);
      const double a = mean_[i] - double(references_.reference[i]);
      const double b = two ? mean_[i] - double(references_.second_reference[i]) : a;
      error.add((a * b + m2_[i] / seeds_) * w);
      if (seeds_ < 2) continue;
      const double s2 = m2_[i] / (seeds_ - 1), v = s2 / seeds_;
      variance.add(s2 * w);
      bias.add((a * b - v) * w);
      bias_variance.add(variance_of_bias_squared(a * b - v, v, seeds_, a - b) * w * w * double(channels));
    }
  }
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  ErrorSplit split{error.value() / pixels, kUnknown, kUnknown, kUnknown};
  if (seeds_ < 2) return split;
  split.variance = variance.value() / pixels;
  split.bias_squared = bias.value() / pixels;
  split.bias_squared_error = std::sqrt(std::max(0.0, bias_variance.value())) / pixels;
  return split;
}

}  // namespace penumbra
