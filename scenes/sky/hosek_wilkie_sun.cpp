#include "scenes/sky/hosek_wilkie_sun.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "scenes/angles.h"
#include "scenes/sky/hosek_wilkie_sky.h"
#include "scenes/spectrum.h"

namespace penumbra {
namespace {

constexpr int kSegments = 45, kWavelengths = 9;
constexpr double kShortest = 400, kSpacing = 40;  // of the wavelengths, nm

/// A cubic of the elevation above the segment's lower end, in radians.
struct SunCubic {
  float coefficients[4];
};
constexpr SunCubic kSunCubics[] = {
#include "scenes/sky/hosek_wilkie/sun.inc"
};
static_assert(std::size(kSunCubics) == BetweenTurbidities::kCount * kSegments * kWavelengths);

// Limb darkening: for each wavelength a polynomial of the cosine, the authors' as well.
constexpr double kLimbDarkening[kWavelengths][6] = {
    {0.123511, 1.08444, -0.405598, 0.370629, -0.240567, 0.0674778},
    {0.158489, 1.23346, -0.875754, 0.857812, -0.484919, 0.110895},
    {0.198587, 1.30507, -1.25998, 1.49727, -1.04047, 0.299516},
    {0.23695, 1.29927, -1.28034, 1.3776, -0.85054, 0.21706},
    {0.26892, 1.34319, -1.58427, 1.91271, -1.3135, 0.37295},
    {0.299804, 1.36718, -1.80884, 2.29294, -1.60595, 0.454874},
    {0.33551, 1.30791, -1.79382, 2.44646, -1.89082, 0.594769},
    {0.364007, 1.27316, -1.73824, 2.28535, -1.70203, 0.517758},
    {0.389704, 1.2448, -1.69708, 2.14061, -1.51803, 0.440004},
};

/// The colour of unit spectral radiance about a wavelength of the tables. Mitsuba 3's RGB modes take the
/// matching functions there alone, for an eleventh of 467.069280386 nm (its include/mitsuba/render/sunsky.h):
/// the tables have 320 and 360 nm too, which are hardly visible. A sum over 40 nm each would be 5 to 8 %
/// less.
glm::dvec3 colour_of(int wavelength) {
  constexpr double kWidth = 467.069280386 / 11;  // nm
  return kWidth * matching_rgb(kShortest + kSpacing * wavelength) / luminance_of_unit_power();
}

/// The segments' lower ends are at cubes of equal steps.
double segment_start(int segment) { return kPi / 2 * std::pow(double(segment) / kSegments, 3); }

}  // namespace

HosekWilkieSun::HosekWilkieSun(double turbidity) : segments_(kSegments, Segment{}) {
  const BetweenTurbidities rows(turbidity);
  for (int wavelength = 0; wavelength < kWavelengths; ++wavelength) {
    const glm::dvec3 colour = colour_of(wavelength);
    for (int s = 0; s < kSegments; ++s) {
      const SunCubic &less = kSunCubics[(rows.lower * kSegments + s) * kWavelengths + wavelength],
                     &more = kSunCubics[((rows.lower + 1) * kSegments + s) * kWavelengths + wavelength];
      for (int k = 0; k < kPowers; ++k)
        for (int j = 0; j < kLimbPowers; ++j)
          segments_[std::size_t(s)].coefficients[k][j] +=
              std::lerp(double(less.coefficients[k]), double(more.coefficients[k]), rows.share_of_upper) *
              kLimbDarkening[wavelength][j] * colour;
    }
  }
}

glm::dvec3 HosekWilkieSun::radiance(double elevation, double cosine) const {
  if (!(elevation >= 0)) return glm::dvec3(0);
  const int s = std::min(int(std::cbrt(elevation / (kPi / 2)) * kSegments), kSegments - 1);
  const double above = elevation - segment_start(s);
  glm::dvec3 sum(0);
  for (int k = kPowers - 1; k >= 0; --k) {
    glm::dvec3 at_limb(0);
    for (int j = kLimbPowers - 1; j >= 0; --j)
      at_limb = at_limb * cosine + segments_[std::size_t(s)].coefficients[k][j];
    sum = sum * above + at_limb;
  }
  return sum;
}

glm::dvec3 HosekWilkieSun::mean_radiance(double elevation) const {
  constexpr int kCount = 4096;
  const double radius = kSunRadius * kDegree;
  glm::dvec3 sum(0);
  int seen = 0;
  for (int k = 0; k < kCount; ++k) {
    const glm::dvec3 w = disk_direction(k, kCount, radius);
    const double up = w.z * std::sin(elevation) + w.y * std::cos(elevation);
    if (up < 0) continue;
    ++seen;
    sum += radiance(std::asin(std::min(up, 1.0)), limb_cosine(std::hypot(w.x, w.y), radius));
  }
  return seen == 0 ? sum : sum / double(seen);
}

double HosekWilkieSun::visible_share(double elevation) {
  // The area of a circle's segment.
  const double x = std::clamp(elevation / (kSunRadius * kDegree), -1.0, 1.0);
  return 0.5 + (std::asin(x) + x * std::sqrt(1 - x * x)) / kPi;
}

glm::dvec3 HosekWilkieSun::plain_node(int node) const { return mean_radiance(kFirstNode + node * kNodeStep); }

glm::dvec3 HosekWilkieSun::plain_radiance(double elevation) const {
  return plain_between(elevation, [&](int node) { return plain_node(node); });
}

glm::dvec3 disk_direction(int k, int count, double radius) {
  const double versine = 2 * std::pow(std::sin(0.5 * radius), 2);
  const double z = 1 - versine * (k + 0.5) / count, r = std::sqrt(1 - z * z);
  const double phi = kPi * (3 - std::sqrt(5.0)) * k;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

double disk_solid_angle(double radius) { return 4 * kPi * std::pow(std::sin(0.5 * radius), 2); }

double limb_cosine(double sine, double radius) {
  const double share = sine / std::sin(radius);
  return std::sqrt(std::max(0.0, 1 - share * share));
}

}  // namespace penumbra
