#include "scenes/bsdfs/facet_albedo.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include "kernels/bsdf/fuzz.h"
#include "scenes/angles.h"
#include "scenes/bsdfs/rough_boundary.h"
#include "scenes/bsdfs/sheen_table.h"

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
          double(bits & OPENPBR_PACKED) / OPENPBR_PACKED, 0, 0};
}

double knot_cosine(std::size_t knot) { return std::max(1e-8, std::pow(double(knot) / (CURVE_KNOTS - 1), 4)); }

/// 2 int f(mu) mu dmu of a curve that is linear in the root of mu, of this degree, between its knots.
template <typename Curve>
double hemisphere_mean(const Curve& curve, int knots = CURVE_KNOTS, int degree = 4) {
  double mean = 0;
  const int power = 2 * degree;
  for (int k = 0; k + 1 < knots; ++k) {
    // With mu = y^n, mu dmu = n y^(2n - 1) dy.
    const double a = double(k) / (knots - 1), b = double(k + 1) / (knots - 1);
    const double slope = (curve(k + 1) - curve(k)) / (b - a), start = curve(k) - slope * a;
    mean += start * (std::pow(b, power) - std::pow(a, power)) +
            slope * (double(power) / (power + 1)) * (std::pow(b, power + 1) - std::pow(a, power + 1));
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

/// Calls visit(weight, cosine at the microfacet, what is not masked of a reflection, of a refraction) for
/// visible microfacets, for the parameters of facet_albedo. Their weights are probabilities: their sum is 1.
template <typename Visit>
void visit_facets(double alpha_u, double alpha_v, double ior, double cosine, double across,
                  const Visit& visit) {
  // The mean over the visible normals of what is not masked on the way out (Heitz 2018). The normals are
  // those of a spherical cap, stretched (Dupuy and Benyoub 2023).
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double wx = sine * std::sqrt(std::max(0.0, 1 - across)), wy = sine * std::sqrt(across);
  const double length = std::hypot(alpha_u * wx, alpha_v * wy, cosine);
  const double x = alpha_u * wx / length, y = alpha_v * wy / length, z = cosine / length;
  const int count = wy == 0 ? kTurns : 2 * kTurns;  // half of the circle is the other's mirror image
  const auto seen = [&](double u, double v, double w) {
    return 2 * w / (w + std::sqrt(w * w + alpha_u * alpha_u * u * u + alpha_v * alpha_v * v * v));
  };
  // Total reflection begins with a step.
  const int heights = ior < 1 ? 160 : 48;
  for (int k = 0; k < count; ++k) {
    const Turn& turn = turns()[std::size_t(k)];
    // The heights of the cap have equal probabilities. Those of steep normals, GGX's tail, are of the size of
    // the roughness: layers between equidistant values of its inverse hyperbolic sine have both sizes.
    const double steep = 0.5 * std::hypot(alpha_u * turn.cosine, alpha_v * turn.sine);
    const double step = std::asinh((1 + z) / steep) / heights;
    double below = 0;
    for (int i = 0; i < heights; ++i) {
      const double above = steep * std::sinh((i + 1) * step), up = 0.5 * (below + above);
      const double weight = (above - below) / ((1 + z) * count),
                   r = std::sqrt(std::max(0.0, 1 - (up - z) * (up - z)));
      below = above;
      const double gx = alpha_u * (r * turn.cosine + x), gy = alpha_v * (r * turn.sine + y);
      const double to_unit = 1 / std::sqrt(gx * gx + gy * gy + up * up);
      const double hx = gx * to_unit, hy = gy * to_unit, hz = up * to_unit;
      const double half = std::min(1.0, wx * hx + wy * hy + cosine * hz);  // cosine at the microfacet
      if (half <= 0) continue;
      const SmoothRefraction boundary = smooth_refraction(half, ior);
      const double out = 2 * half * hz - cosine;
      const double reflection = out > 0 ? seen(2 * half * hx - wx, 2 * half * hy - wy, out) : 0;
      const double along = half / ior - boundary.cosine, in = -(along * hz - cosine / ior);
      const bool refracts = in > 0 && boundary.reflected < 1;
      visit(weight, half, boundary, reflection,
            refracts ? seen(along * hx - wx / ior, along * hy - wy / ior, in) : 0);
    }
  }
}

double film_knot_cosine(int knot) { return std::max(1e-6, std::pow(double(knot) / (FILM_KNOTS - 1), 2)); }

/// RGB curve of a film, with its means.
using FilmCurve = std::array<glm::dvec3, FILM_KNOTS + 1>;

template <typename OfCosine>
FilmCurve film_curve(const OfCosine& of_cosine) {
  FilmCurve curve;
  for (int k = 0; k < FILM_KNOTS; ++k) curve[std::size_t(k)] = of_cosine(film_knot_cosine(k));
  for (int c = 0; c < 3; ++c)
    curve.back()[c] = hemisphere_mean([&](int k) { return curve[std::size_t(k)][c]; }, FILM_KNOTS, 2);
  return curve;
}

/// As the kernels interpolate it.
glm::dvec3 at_cosine(const FilmCurve& curve, double cosine) {
  const double x = std::sqrt(cosine) * (FILM_KNOTS - 1);
  const int knot = std::min(int(x), FILM_KNOTS - 2);
  return glm::mix(curve[std::size_t(knot)], curve[std::size_t(knot) + 1], x - knot);
}

/// The albedos of microfacets with a film.
struct FilmAlbedos {
  glm::dvec3 reflected{0}, scattered{0};
};
FilmAlbedos film_albedos(double alpha_u, double alpha_v, double ior, double cosine, double across,
                         const FilmCurve& reflectance) {
  FilmAlbedos sum;
  visit_facets(alpha_u, alpha_v, ior, cosine, across,
               [&](double weight, double half, const SmoothRefraction& boundary, double reflection,
                   double refraction) {
                 const glm::dvec3 r = boundary.reflected < 1 ? at_cosine(reflectance, half) : glm::dvec3(1);
                 sum.reflected += weight * reflection * r;
                 sum.scattered += weight * (reflection * r + refraction * (1.0 - r));
               });
  return sum;
}

float packed(double low, double high) { return packed(FacetAlbedo{high, low, 0, 0}); }

}  // namespace

FacetAlbedo facet_albedo(double alpha_u, double alpha_v, double ior, double cosine, double across) {
  FacetAlbedo sum{0, 0, 0, 0};
  visit_facets(
      alpha_u, alpha_v, ior, cosine, across,
      [&](double weight, double, const SmoothRefraction& boundary, double reflection, double refraction) {
        const double reflected = reflection * boundary.reflected;
        sum.plain += weight * reflection;
        sum.reflected += weight * reflected;
        sum.scattered += weight * (reflected + (1 - boundary.reflected) * refraction);
        sum.refracted += weight * refraction;
      });
  return sum;
}

double fuzz_albedo(double roughness, double cosine) {
  // In wi's cosine and azimuth. The lobe has no peak.
  constexpr int kSteps = 48;
  const float alpha = fuzz_alpha(float(roughness));
  const double inverse = 1 / double(alpha);
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
    sum +=
        turned / kTurns * z * double(fuzz_visibility(alpha, float(cosine), float(z))) * 3 * at * at / kSteps;
  }
  return (2 + inverse) * sum;
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

std::size_t FacetCurves::size() const {
  const auto rows_of_sets = std::size_t(row_count() * sets()) * CURVE_STRIDE;
  return rows_of_sets +
         std::size_t(film_rows) * (FILM_REFLECTANCES + 3 * CURVE_STRIDE * std::size_t(row_count()));
}

std::vector<float> FacetCurves::film_blocks() const {
  std::vector<float> result;
  const auto put = [&](const FilmCurve& curve) {
    for (const glm::dvec3& each : curve)
      for (int c = 0; c < 3; ++c) result.push_back(float(each[c]));
  };
  for (int k = 0; k < film_rows; ++k) {
    ThinFilm of_row = *film;
    if (film_rows > 1)
      of_row.nanometres = std::lerp(film->nanometres, last_nanometres, double(k) / (film_rows - 1));
    const FilmCurve reflectance = film_curve([&](double cosine) { return film_colour(of_row, cosine); });
    put(reflectance);
    for (int metal = 0; metal < FILM_METALS; ++metal) {
      const double base = std::pow(double(metal) / (FILM_METALS - 1), 2);
      put(film_curve([&](double cosine) { return film_on_metal(of_row, base, cosine); }));
    }
    const std::size_t start = result.size();
    const int count = row_count();
    result.resize(start + 3 * CURVE_STRIDE * std::size_t(count));
    std::vector<glm::dvec3> means;
    for (int row = 0; row < count; ++row) {
      const FacetRow facets = row_of(std::size_t(row));
      std::array<FilmAlbedos, CURVE_KNOTS> knots;
      for (std::size_t knot = 0; knot < CURVE_KNOTS; ++knot)
        knots[knot] =
            film_albedos(facets.alpha_u, facets.alpha_v, ior, knot_cosine(knot), facets.across, reflectance);
      float* const at = result.data() + start + 3 * CURVE_STRIDE * std::size_t(row);
      glm::dvec3 mean(0);
      for (int c = 0; c < 3; ++c) {
        for (std::size_t knot = 0; knot < CURVE_KNOTS; ++knot)
          at[3 * knot + std::size_t(c)] = packed(knots[knot].reflected[c], knots[knot].scattered[c]);
        mean[c] = hemisphere_mean([&](int knot) { return knots[std::size_t(knot)].reflected[c]; });
      }
      means.push_back(mean);
    }
    glm::dvec3 all(0);
    for (std::size_t row = 0; row < means.size(); ++row) all += azimuth_share(row, means.size()) * means[row];
    for (std::size_t row = 0; row < means.size(); ++row)
      for (std::size_t c = 0; c < 3; ++c)
        result[start + 3 * (row * CURVE_STRIDE + CURVE_KNOTS) + c] =
            packed((rows == FacetRows::kAzimuth ? all : means[row])[int(c)], 0);
  }
  return result;
}

FacetCurves::FacetRow FacetCurves::row_of(std::size_t row) const {
  const auto count = std::size_t(row_count());
  const double place = count > 1 ? double(row) / double(count - 1) : 0;
  const bool by_roughness = rows == FacetRows::kRoughness;
  const double alpha = std::pow(double(FIRST_FACET_PLACE) + (1 - double(FIRST_FACET_PLACE)) * place, 4);
  return {by_roughness ? alpha : alpha_u, by_roughness ? alpha : alpha_v,
          rows == FacetRows::kAzimuth ? place : 0, alpha};
}

std::vector<float> FacetCurves::curves() const {
  const auto count = std::size_t(row_count());
  std::vector<float> result(count * std::size_t(sets()) * CURVE_STRIDE);
  const auto at = [&](int set, std::size_t row) {
    return result.data() + (std::size_t(set) * count + row) * CURVE_STRIDE;
  };
  for (std::size_t row = 0; row < count; ++row) {
    const bool by_roughness = rows == FacetRows::kRoughness;
    const auto [u, v, across, alpha] = row_of(row);
    for (std::size_t knot = 0; knot < CURVE_KNOTS; ++knot) {
      const double cosine = knot_cosine(knot);
      const FacetAlbedo base = facet_albedo(u, v, ior, cosine, across);
      at(OPENPBR_BASE, row)[knot] = packed(base);
      if (!layered) continue;
      at(OPENPBR_SCATTERED, row)[knot] = float(transmits ? base.scattered : 1);
      if (gltf) at(OPENPBR_REFRACTED, row)[knot] = float(transmits ? base.refracted : 1);
      if (coat_ior != 1) {
        const double coat = by_roughness ? alpha : coat_alpha;
        const bool again = row > 0 && !by_roughness;
        at(OPENPBR_COAT, row)[knot] = again ? at(OPENPBR_COAT, 0)[knot]
                                            : float(facet_albedo(coat, coat, coat_ior, cosine, 0).reflected);
      }
      if (fuzz_roughness < 0) continue;
      const double rough = by_roughness ? std::sqrt(alpha) : fuzz_roughness;
      const SheenCell sheen = sheen_cell(rough, cosine);
      at(OPENPBR_FUZZ, row)[knot] = gltf ? float(fuzz_albedo(rough, cosine)) : sheen.reflectance;
      if (gltf) continue;
      at(OPENPBR_FUZZ_NARROW, row)[knot] = sheen.narrow;
      at(OPENPBR_FUZZ_LEAN, row)[knot] = sheen.lean;
    }
  }
  for (int set = 0; set < sets(); ++set) {
    FacetAlbedo all{0, 0, 0, 0};
    for (std::size_t row = 0; row < count; ++row) {
      const float* knots = at(set, row);
      FacetAlbedo mean{0, hemisphere_mean([&](int k) { return double(knots[k]); }), 0, 0};
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
  const std::vector<float> blocks = film_blocks();
  result.insert(result.end(), blocks.begin(), blocks.end());
  return result;
}

}  // namespace penumbra
