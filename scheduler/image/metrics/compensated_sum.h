// Sums whose rounding error does not grow with the number of terms.
#pragma once

#include <cmath>

namespace penumbra {

/// Neumaier's sum (ZAMM 54, 1974). The error is about 2 units in the last place of the sum plus n^2 eps^2
/// times the sum of magnitudes, in any order. Products of two floats from 1e-90 to 1e77 neither overflow nor
/// underflow. An infinite or NaN term makes the sum infinite or NaN.
class CompensatedSum {
 public:
  void add(double term) {
    const double next = sum_ + term;
    lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - next) + term : (term - next) + sum_;
    sum_ = next;
  }
  /// inf - inf would make the compensation of an infinite sum NaN.
  [[nodiscard]] double value() const { return std::isfinite(sum_) ? sum_ + lost_ : sum_; }

 private:
  double sum_ = 0, lost_ = 0;
};

}  // namespace penumbra
