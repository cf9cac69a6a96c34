#include "scheduler/image/metrics/color_space.h"

#include <cmath>

namespace penumbra {
namespace {

using Matrix = std::array<Color, 3>;  // of rows

constexpr Color transformed(const Matrix& m, const Color& v) {
  return {m[0][0] * v[0] + m[0][1] * v[1] + m[0][2] * v[2], m[1][0] * v[0] + m[1][1] * v[1] + m[1][2] * v[2],
          m[2][0] * v[0] + m[2][1] * v[1] + m[2][2] * v[2]};
}

constexpr Matrix inverse(const Matrix& m) {
  const auto cofactor = [&](int i, int j) {
    const auto &a = m[(i + 1) % 3], &b = m[(i + 2) % 3];
    return a[(j + 1) % 3] * b[(j + 2) % 3] - a[(j + 2) % 3] * b[(j + 1) % 3];
  };
  const double determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
  Matrix result{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result[i][j] = cofactor(j, i) / determinant;
  }
  return result;
}

/// XYZ of Y = 1 and chromaticity (x, y).
constexpr Color xyz_of(double x, double y) { return {x / y, 1, (1 - x - y) / y}; }

constexpr Color kWhite = xyz_of(0.3127, 0.3290);

/// Columns: the primaries, scaled to add up to white; rows: divided by white.
constexpr Matrix relative_xyz_of_rgb() {
  const Color red = xyz_of(0.64, 0.33), green = xyz_of(0.30, 0.60), blue = xyz_of(0.15, 0.06);
  Matrix primaries{};
  for (int i = 0; i < 3; ++i) primaries[i] = {red[i], green[i], blue[i]};
  const Color scale = transformed(inverse(primaries), kWhite);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) primaries[i][j] *= scale[j] / kWhite[i];
  }
  return primaries;
}

constexpr Matrix kFromRgb = relative_xyz_of_rgb();
constexpr Matrix kToRgb = inverse(kFromRgb);

constexpr double kDelta = 6.0 / 29.0;

double lab_curve(double t) {
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29.0;
}

double lab_curve_inverse(double t) { return t > kDelta ? t * t * t : 3 * kDelta * kDelta * (t - 4.0 / 29.0); }

}  // namespace

Color relative_xyz_from_rgb(const Color& rgb) { return transformed(kFromRgb, rgb); }

Color rgb_from_relative_xyz(const Color& xyz) { return transformed(kToRgb, xyz); }

double luminance(const Color& rgb) {
  return kFromRgb[1][0] * rgb[0] + kFromRgb[1][1] * rgb[1] + kFromRgb[1][2] * rgb[2];
}

Color lab_from_relative_xyz(const Color& xyz) {
  const double x = lab_curve(xyz[0]), y = lab_curve(xyz[1]), z = lab_curve(xyz[2]);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Color relative_xyz_from_lab(const Color& lab) {
  const double y = (lab[0] + 16) / 116;
  return {lab_curve_inverse(y + lab[1] / 500), lab_curve_inverse(y), lab_curve_inverse(y - lab[2] / 200)};
}

double linear_from_srgb(double signal) {
  return signal <= 0.04045 ? signal / 12.92 : std::pow((signal + 0.055) / 1.055, 2.4);
}

}  // namespace penumbra
