#include "scheduler/image/metrics/color_space.h"

#include <cmath>

namespace penumbra {
namespace {

/// Divided by white.
constexpr ColorMatrix relative_xyz_of_rgb() {
  ColorMatrix matrix = xyz_from_rgb(kRec709);
  for (std::size_t i = 0; i < 3; ++i)
    for (double& each : matrix[i]) each /= white_of(kRec709)[i];
  return matrix;
}

constexpr ColorMatrix kFromRgb = relative_xyz_of_rgb();
constexpr ColorMatrix kToRgb = inverse(kFromRgb);

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
