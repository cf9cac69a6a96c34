// Random numbers of the sequences that libstdc++'s distributions have, in half of their time or less: without
// optimisation those take two logarithms of long doubles for each number, of a constant.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace penumbra {

/// Uniform in [0, 1).
inline double uniform_deviate(std::mt19937_64& random) {
  const double u = double(random()) * 0x1p-64;
  return u < 1 ? u : std::nextafter(1.0, 0.0);
}

/// Normal deviates by the polar method of Marsaglia and Bray (1964), two at a time.
class NormalDeviates {
 public:
  explicit NormalDeviates(double mean = 0, double deviation = 1) : mean_(mean), deviation_(deviation) {}

  double operator()(std::mt19937_64& random) {
    has_other_ = !has_other_;
    if (!has_other_) return other_ * deviation_ + mean_;
    double x, y, r2;
    do {
      x = 2 * uniform_deviate(random) - 1;
      y = 2 * uniform_deviate(random) - 1;
      r2 = x * x + y * y;
    } while (r2 > 1 || r2 == 0);
    const double factor = std::sqrt(-2 * std::log(r2) / r2);
    other_ = x * factor;
    return y * factor * deviation_ + mean_;
  }

 private:
  double mean_, deviation_, other_ = 0;
  bool has_other_ = false;
};

}  // namespace penumbra
