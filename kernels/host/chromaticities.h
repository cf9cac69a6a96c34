// Chromaticities of an image's red, green and blue, and conversion between them.
#pragma once

#include <array>
#include <cmath>
#include <optional>

namespace penumbra {

/// CIE 1931 x and y of red, green, blue and white.
using Chromaticities = std::array<float, 8>;
/// Rec. 709 (ITU-R BT.709-6, item 1.3), whose primaries and white are sRGB's.
constexpr Chromaticities kRec709 = {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};

using Color = std::array<double, 3>;
using ColorMatrix = std::array<Color, 3>;  ///< three rows

constexpr Color transformed(const ColorMatrix& m, const Color& v) {
  return {m[0][0] * v[0] + m[0][1] * v[1] + m[0][2] * v[2], m[1][0] * v[0] + m[1][1] * v[1] + m[1][2] * v[2],
          m[2][0] * v[0] + m[2][1] * v[1] + m[2][2] * v[2]};
}

/// The elements are not finite for a singular matrix.
constexpr ColorMatrix inverse(const ColorMatrix& m) {
  const auto cofactor = [&](int i, int j) {
    const auto &a = m[(i + 1) % 3], &b = m[(i + 2) % 3];
    return a[(j + 1) % 3] * b[(j + 2) % 3] - a[(j + 2) % 3] * b[(j + 1) % 3];
  };
  const double determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
  ColorMatrix result{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result[i][j] = cofactor(j, i) / determinant;
  }
  return result;
}

/// XYZ of white, with Y = 1.
constexpr Color white_of(const Chromaticities& c) {
  const double x = c[6], y = c[7];
  return {x / y, 1, (1 - x - y) / y};
}

/// From linear RGB with these primaries to CIE XYZ, in which white has Y = 1. The primaries are scaled so
/// that together they are white.
constexpr ColorMatrix xyz_from_rgb(const Chromaticities& c) {
  ColorMatrix primaries{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double x = c[2 * i], y = c[2 * i + 1];
    primaries[0][i] = x, primaries[1][i] = y, primaries[2][i] = 1 - x - y;
  }
  const Color scale = transformed(inverse(primaries), white_of(c));
  for (Color& row : primaries)
    for (std::size_t j = 0; j < 3; ++j) row[j] *= scale[j];
  return primaries;
}

/// From linear RGB with these primaries to Rec. 709, without adaptation of the white point, like OpenEXR's
/// own conversion. Empty if the chromaticities define no colours.
inline std::optional<ColorMatrix> rec709_from_rgb(const Chromaticities& c) {
  const ColorMatrix to_xyz = xyz_from_rgb(c), from_xyz = inverse(xyz_from_rgb(kRec709));
  ColorMatrix result{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) result[i][j] += from_xyz[i][k] * to_xyz[k][j];
      if (!std::isfinite(result[i][j])) return std::nullopt;
    }
  return result;
}

}  // namespace penumbra
