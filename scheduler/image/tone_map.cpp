#include "scheduler/image/tone_map.h"

#include <array>
#include <bit>
#include <cmath>

namespace penumbra {

double srgb_from_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

namespace {

std::uint8_t rounded_byte(float linear) {
  return std::uint8_t(std::lround(255.0 * srgb_from_linear(linear)));
}

/// rounded_byte by table lookup instead of a power. The table holds where the byte changes. The byte never
/// decreases, because neighbouring floats are further apart than the errors of double precision.
class ByteTable {
 public:
  ByteTable() {
    for (int byte = 0; byte <= kMost; ++byte) from_[std::size_t(byte)] = first_of(byte);
    int byte = 0;
    for (std::uint32_t upper = 0; upper < kEntries; ++upper) {
      while (byte < kMost && from_[std::size_t(byte) + 1] <= upper << kLowerBits) ++byte;
      least_[upper] = std::uint8_t(byte);
    }
  }
  /// For numbers in [0, 1).
  [[nodiscard]] std::uint8_t operator()(float linear) const {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(linear);
    int byte = least_[bits >> kLowerBits];
    while (byte < kMost && from_[std::size_t(byte) + 1] <= bits) ++byte;
    return std::uint8_t(byte);
  }

 private:
  static constexpr int kMost = 255, kLowerBits = 16;
  static constexpr std::uint32_t kOne = std::bit_cast<std::uint32_t>(1.0f), kEntries = kOne >> kLowerBits;

  /// The bits of the smallest number that gives at least this byte.
  static std::uint32_t first_of(int byte) {
    std::uint32_t below = 0, first = kOne;
    if (byte == 0) return 0;
    while (first - below > 1) {
      const std::uint32_t middle = below + (first - below) / 2;
      (rounded_byte(std::bit_cast<float>(middle)) < byte ? below : first) = middle;
    }
    return first;
  }

  std::array<std::uint32_t, kMost + 1> from_{};
  std::array<std::uint8_t, kEntries> least_{};  // the smallest byte of numbers with these upper bits
};

}  // namespace

std::uint8_t display_byte(float linear) {
  static const ByteTable byte_of;
  if (!(linear > 0.0f)) return 0;
  return linear < 1.0f ? byte_of(linear) : 255;
}

}  // namespace penumbra
