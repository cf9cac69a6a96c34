// Images as planes of floats.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace penumbra {

/// Plane k of pixel (x, y) is values[(k * height + y) * width + x].
struct Planes {
  Planes() = default;
  Planes(int w, int h, int planes, float value = 0)
      : width(w), height(h), count(planes), values(std::size_t(planes) * pixels(), value) {}

  int width = 0, height = 0, count = 0;
  std::vector<float> values;

  [[nodiscard]] std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
  [[nodiscard]] std::span<float> plane(int k) {
    return std::span(values).subspan(std::size_t(k) * pixels(), pixels());
  }
  [[nodiscard]] std::span<const float> plane(int k) const {
    return std::span(values).subspan(std::size_t(k) * pixels(), pixels());
  }
};

}  // namespace penumbra
