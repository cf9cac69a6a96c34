// Random choices that do not depend on the standard library, as std's distributions do. (The order in which
// operands draw them depends on the compiler, and so does the scene of a seed.)
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <initializer_list>
#include <random>

namespace penumbra::differential {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// In [0, 1).
  double unit() { return double(engine_() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// 0 ... count - 1.
  int below(int count) { return int(unit() * count); }
  bool chance(double probability) { return unit() < probability; }
  template <typename T>
  T one_of(std::initializer_list<T> values) {
    return values.begin()[below(int(values.size()))];
  }
  glm::dvec3 vector(double low, double high) {
    const double x = between(low, high), y = between(low, high), z = between(low, high);
    return {x, y, z};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace penumbra::differential
