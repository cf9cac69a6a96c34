#include "scenes/bsdfs/facet_albedo.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include "kernels/bsdf/families.h"
#include "scenes/angles.h"
#include "scenes/bsdfs/rough_boundary.h"

namespace penumbra {
namespace {

constexpr int kTurns = 32;  // of the midpoint rule

struct Turn {
  double cosine, sine;
};

/// The circle, first its half with sines above 0.
const std::array<Turn, 2 * kTurns>& turns() {
  static const auto table = [] {
    std::array<Turn, 2 * kTurns> result{};
    for (std::size_t i = 0; i < 2 * kTurns; ++i)
      result[i] = {std::cos(kPi * (double(i) + 0.5) / kTurns), std::sin(kPi * (double(i) + 0.5) / kTurns)};
    return result;
  }();
  return table;
}

/// Two numbers of [0, 1] in the bits of one, see facet_albedos (kernels/bsdf/openpbr.h).
float packed(const FacetAlbedo& albedo) {
  const auto bits = [](double x) { return unsigned(std::lround(std::clamp(x, 0.0, 1.0) * OPENPBR_PACKED)); };
  return std::bit_cast<float>(bits(albedo.reflected) | bits(albedo.plain) << OPENPBR_PACKED_BITS);
}
FacetAlbedo unpacked(float both) {
  const auto bits = std::bit_cast<unsigned>(both);
  return {double(bits >> OPENPBR_PACKED_BITS) / OPENPBR_PACKED,
          double(bits & OPENPBR_PACKED) / OPENPBR_PACKED, 0};
}

double knot_cosine(std::size_t knot) { return std::max(1e-8, std::pow(double(knot) / (CURVE_KNOTS - 1), 4)); }

/// 2 int f(mu) mu dmu of a curve that is linear in the fourth root of mu between its knots.
template <typename Curve>
double hemisphere_mean(const Curve& curve) {
  double mean = 0;
  for (int k = 0; k + 1 < CURVE_KNOTS; ++k) {
    // With mu = y^4, mu dmu = 4 y^7 dy.
    const double a = double(k) / (CURVE_KNOTS - 1), b = double(k + 1) / (CURVE_KNOTS - 1);
    const double slope = (curve(k + 1) - curve(k)) / (b - a), start = curve(k) - slope * a;
    mean += start * (std::pow(b, 8) - std::pow(a, 8)) + slope * (8.0 / 9) * (std::pow(b, 9) - std::pow(a, 9));
  }
  return mean;
}

/// The share of a row by azimuth in all azimuths: the integral of its hat function over the angle.
double azimuth_share(std::size_t row, std::size_t count) {
  if (count == 1) return 1;
  const auto angle = [](double place) { return 2 / kPi * std::asin(std::sqrt(std::clamp(place, 0.0, 1.0))); };
  constexpr int kParts = 64;
  const double step = 1.0 / double(count - 1), centre = double(row) * step;
  double share = 0;
  for (int k = 0; k < 2 * kParts; ++k) {
    const double from = centre + (double(k) / kParts - 1) * step, to = from + step / kParts;
    share += (1 - std::abs((from + to) / 2 - centre) / step) * (angle(to) - angle(from));
  }
  return share;
}

}  // namespace

FacetAlbedo facet_albedo(double alpha_u, double alpha_v, double ior, double cosine, double across) {
  // The mean over the visible normals of what is not masked on the way out (Heitz 2018). The normals are
  // those of a spherical cap, stretched (Dupuy and Benyoub 2023).
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double wx = sine * std::sqrt(std::max(0.0, 1 - across)), wy = sine * std::sqrt(across);
  const double length = std::hypot(alpha_u * wx, alpha_v * wy, cosine);
  const double x = alpha_u * wx / length, y = alpha_v * wy / length, z = cosine / length;
  const int count = wy == 0 ? kTurns : 2 * kTurns;  // half of the circle is the other's mirror image
  FacetAlbedo sum{0, 0, 0};
  const auto seen = [&](double u, double v, double w) {
    return 2 * w / (w + std::sqrt(w * w + alpha_u * alpha_u * u * u + alpha_v * alpha_v * v * v));
  };
  // Total reflection begins with a step.
  const int heights = ior < 1 ? 160 : 48;
  for (int i = 0; i < heights; ++i) {
    const double depth = (i + 0.5) / heights * (1 + z), r = std::sqrt(std::max(0.0, depth * (2 - depth)));
    const double up = 1 + z - depth;
    for (int k = 0; k < count; ++k) {
      const Turn& turn = turns()[std::size_t(k)];
      const double gx = alpha_u * (r * turn.cosine + x), gy = alpha_v * (r * turn.sine + y);
      const double to_unit = 1 / std::sqrt(gx * gx + gy * gy + up * up);
      const double hx = gx * to_unit, hy = gy * to_unit, hz = up * to_unit;
      const double half = std::min(1.0, wx * hx + wy * hy + cosine * hz);  // cosine at the microfacet
      if (half <= 0) continue;
      const SmoothRefraction boundary = smooth_refraction(half, ior);
      const double out = 2 * half * hz - cosine;
      if (out > 0) {
        const double visible = seen(2 * half * hx - wx, 2 * half * hy - wy, out);
        sum.plain += visible;
        sum.reflected += visible * boundary.reflected;
      }
      const double along = half / ior - boundary.cosine, in = -(along * hz - cosine / ior);
      if (in > 0 && boundary.reflected < 1)
        sum.scattered += (1 - boundary.reflected) * seen(along * hx - wx / ior, along * hy - wy / ior, in);
    }
  }
  const double parts = double(heights) * count;
  return {sum.plain / parts, sum.reflected / parts, (sum.reflected + sum.scattered) / parts};
}

double fuzz_albedo(double roughness, double cosine) {
  // In wi's cosine and azimuth. The lobe has no peak.
  constexpr int kSteps = 48;
  const double inverse = 1 / std::pow(std::max(roughness, double(LEAST_FUZZ_ROUGHNESS)), 2);
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double at = (i + 0.5) / kSteps, z = at * at * at,
                 r = std::sqrt(1 - z * z);  // more near the horizon
    double turned = 0;
    for (int k = 0; k < kTurns; ++k) {
      const Turn& turn = turns()[std::size_t(k)];
      const double hx = sine + r * turn.cosine, hy = r * turn.sine, hz = cosine + z;
      const double across = hx * hx + hy * hy;
      turned += std::pow(across / (across + hz * hz), 0.5 * inverse);
    }
    sum += turned / kTurns * z / (cosine + z - cosine * z) * 3 * at * at / kSteps;
  }
  return (2 + inverse) * sum / 4;
}

double mean_fresnel(double ior) {
  constexpr int kSteps = 2000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double y = (i + 0.5) / kSteps;  // square root of the cosine
    sum += smooth_refraction(y * y, ior).reflected * 4 * y * y * y / kSteps;
  }
  return sum;
}

int FacetCurves::row_count() const { return rows == FacetRows::kOne ? 1 : CURVE_ROWS; }
int FacetCurves::sets() const { return layered ? OPENPBR_SETS : OPENPBR_PLAIN_SETS; }

std::vector<float> FacetCurves::curves() const {
  const auto count = std::size_t(row_count());
  std::vector<float> result(count * std::size_t(sets()) * CURVE_STRIDE);
  const auto at = [&](int set, std::size_t row) {
    return result.data() + (std::size_t(set) * count + row) * CURVE_STRIDE;
  };
  for (std::size_t row = 0; row < count; ++row) {
    const double place = count > 1 ? double(row) / double(count - 1) : 0;
    const bool by_roughness = rows == FacetRows::kRoughness;
    const double alpha = std::pow(double(FIRST_FACET_PLACE) + (1 - double(FIRST_FACET_PLACE)) * place, 4);
    const double u = by_roughness ? alpha : alpha_u, v = by_roughness ? alpha : alpha_v;
    const double across = rows == FacetRows::kAzimuth ? place : 0;
    for (std::size_t knot = 0; knot < CURVE_KNOTS; ++knot) {
      const double cosine = knot_cosine(knot);
      const FacetAlbedo base = facet_albedo(u, v, ior, cosine, across);
      at(OPENPBR_BASE, row)[knot] = packed(base);
      if (!layered) continue;
      at(OPENPBR_SCATTERED, row)[knot] = float(transmits ? base.scattered : 1);
      if (coat_ior != 1) {
        const double coat = by_roughness ? alpha : coat_alpha;
        const bool again = row > 0 && !by_roughness;
        at(OPENPBR_COAT, row)[knot] = again ? at(OPENPBR_COAT, 0)[knot]
                                            : float(facet_albedo(coat, coat, coat_ior, cosine, 0).reflected);
      }
      if (fuzz_roughness >= 0)
        at(OPENPBR_FUZZ, row)[knot] =
            float(fuzz_albedo(by_roughness ? std::sqrt(alpha) : fuzz_roughness, cosine));
    }
  }
  for (int set = 0; set < sets(); ++set) {
    FacetAlbedo all{0, 0, 0};
    for (std::size_t row = 0; row < count; ++row) {
      const float* knots = at(set, row);
      FacetAlbedo mean{0, hemisphere_mean([&](int k) { return double(knots[k]); }), 0};
      if (set == OPENPBR_BASE) {
        mean.plain = hemisphere_mean([&](int k) { return unpacked(knots[k]).plain; });
        mean.reflected = hemisphere_mean([&](int k) { return unpacked(knots[k]).reflected; });
      }
      at(set, row)[CURVE_KNOTS] = set == OPENPBR_BASE ? packed(mean) : float(mean.reflected);
      const double share = azimuth_share(row, count);
      all.plain += share * mean.plain;
      all.reflected += share * mean.reflected;
    }
    if (set != OPENPBR_BASE || rows != FacetRows::kAzimuth) continue;
    for (std::size_t row = 0; row < count; ++row) at(set, row)[CURVE_KNOTS] = packed(all);
  }
  return result;
}

}  // namespace penumbra
