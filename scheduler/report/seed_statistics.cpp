#include "scheduler/report/seed_statistics.h"

#include <cmath>
#include <limits>

#include "scheduler/metrics/compensated_sum.h"

namespace penumbra {

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
  CompensatedSum error, variance, bias, bias_square;
  double pixels = 0;
  for (std::size_t p = 0; p < finite_.size(); ++p) {
    if (finite_[p] == 0) continue;
    double pixel_bias = 0;
    for (std::size_t i = p * channels; i < (p + 1) * channels; ++i) {
      const double truth = references_.truth(i);
      const double w = (weighted ? 1 / (truth * truth + epsilon) : 1.0) / double(channels);
      const double a = mean_[i] - double(references_.reference[i]);
      const double b = two ? mean_[i] - double(references_.second_reference[i]) : a;
      const double s2 = seeds_ > 1 ? m2_[i] / (seeds_ - 1) : 0;
      error.add((a * b + m2_[i] / seeds_) * w);
      variance.add(s2 * w);
      pixel_bias += (a * b - s2 / seeds_) * w;
    }
    bias.add(pixel_bias);
    bias_square.add(pixel_bias * pixel_bias);
    ++pixels;
  }
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  ErrorSplit split{error.value() / pixels, kUnknown, kUnknown, kUnknown};
  if (seeds_ < 2) return split;
  split.variance = variance.value() / pixels;
  split.bias_squared = bias.value() / pixels;
  const double spread = bias_square.value() / pixels - split.bias_squared * split.bias_squared;
  split.bias_squared_error = std::sqrt(std::max(0.0, spread) / std::max(1.0, pixels - 1));
  return split;
}

}  // namespace penumbra
