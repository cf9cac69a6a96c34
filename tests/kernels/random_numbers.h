// Random numbers for tests: 64-bit, seeded, the same on every machine.
#pragma once

#include <cstdint>

#include "tests/kernels/exact_vector.h"

namespace penumbra {

/// SplitMix64 (Steele, Lea and Flood 2014).
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, 1).
  double uniform() { return double(next() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in [0, 1 - 2^-24], the numbers that samplers give.
  float unit_float() { return float(next() >> 40) * 0x1p-24f; }
  std::uint64_t below(std::uint64_t n) { return next() % n; }

  /// Uniform on the unit sphere.
  Exact3 direction() {
    const long double z = 2 * (long double)uniform() - 1, phi = 2 * 3.14159265358979323846L * uniform();
    const long double r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
  }
  /// Uniform in the cube of half-width `reach`.
  Exact3 point(double reach) {
    return {between(-reach, reach), between(-reach, reach), between(-reach, reach)};
  }

 private:
  std::uint64_t state_;
};

}  // namespace penumbra
