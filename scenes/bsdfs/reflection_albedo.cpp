#include "scenes/bsdfs/reflection_albedo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "kernels/bsdf/families.h"
#include "scenes/angles.h"

namespace penumbra {
namespace {

constexpr int kHeights = 64, kTurns = 32;  // of the midpoint rule

struct Turn {
  double cosine, sine;
};

/// Half of the circle; the other half is its mirror image.
const std::array<Turn, kTurns>& turns() {
  static const auto table = [] {
    std::array<Turn, kTurns> result{};
    for (int i = 0; i < kTurns; ++i)
      result[std::size_t(i)] = {std::cos(kPi * (i + 0.5) / kTurns), std::sin(kPi * (i + 0.5) / kTurns)};
    return result;
  }();
  return table;
}

}  // namespace

MicrofacetAlbedo microfacet_albedo(double alpha, double cosine) {
  // The mean over the visible normals of what is not masked on the way out (Heitz 2018). The normals are
  // those of a spherical cap, stretched (Dupuy and Benyoub 2023).
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double length = std::hypot(alpha * sine, cosine), x = alpha * sine / length, z = cosine / length;
  double plain = 0, schlick = 0;
  for (int i = 0; i < kHeights; ++i) {
    const double depth = (i + 0.5) / kHeights * (1 + z), r = std::sqrt(std::max(0.0, depth * (2 - depth)));
    const double up = 1 + z - depth;
    for (const Turn& turn : turns()) {
      const double hx = alpha * (r * turn.cosine + x), hy = alpha * r * turn.sine;
      const double to_unit = 1 / std::sqrt(hx * hx + hy * hy + up * up);
      const double half = (sine * hx + cosine * up) * to_unit;  // cosine at the half vector
      const double out = 2 * half * up * to_unit - cosine;      // of wi
      if (out <= 0) continue;
      const double seen = 2 * out / (out + std::sqrt(out * out + alpha * alpha * (1 - out * out)));
      const double m = 1 - std::min(half, 1.0);
      plain += seen;
      schlick += seen * (m * m) * (m * m) * m;
    }
  }
  return {plain / (kHeights * kTurns), schlick / (kHeights * kTurns)};
}

std::vector<float> reflection_albedo_curves() {
  std::vector<float> curves(std::size_t(2 * REFLECTION_ROWS) * CURVE_STRIDE);
  const double first = FIRST_REFLECTION_PLACE;
  for (std::size_t row = 0; row < REFLECTION_ROWS; ++row) {
    const double alpha = std::pow(first + (1 - first) * double(row) / (REFLECTION_ROWS - 1), 4);
    for (std::size_t knot = 0; knot < CURVE_KNOTS; ++knot) {
      const double cosine = std::max(1e-8, std::pow(double(knot) / (CURVE_KNOTS - 1), 4));
      const MicrofacetAlbedo albedo = microfacet_albedo(alpha, cosine);
      curves[row * CURVE_STRIDE + knot] = float(albedo.plain);
      curves[(REFLECTION_ROWS + row) * CURVE_STRIDE + knot] = float(albedo.schlick);
    }
  }
  return curves;
}

}  // namespace penumbra
