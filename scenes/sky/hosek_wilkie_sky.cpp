#include "scenes/sky/hosek_wilkie_sky.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "scenes/angles.h"
#include "scenes/spectrum.h"

namespace penumbra {
namespace {

constexpr int kAlbedos = 2, kControlPoints = 6, kChannels = 3;

/// For a turbidity, an albedo, a control point of the sun's elevation and a channel.
struct SkyRow {
  float a, b, c, d, e, f, g, i, h, mean;
};
constexpr SkyRow kSkyRows[] = {
#include "scenes/sky/hosek_wilkie/sky.inc"
};
static_assert(std::size(kSkyRows) == BetweenTurbidities::kCount * kAlbedos * kControlPoints * kChannels);

}  // namespace

BetweenTurbidities::BetweenTurbidities(double turbidity)
    : lower(std::clamp(int(turbidity) - 1, 0, kCount - 2)), share_of_upper(turbidity - 1 - lower) {}

HosekWilkieSky::HosekWilkieSky(const glm::dvec3& to_sun, double turbidity, const glm::dvec3& albedo)
    : to_sun_(to_sun), parameters_{}, mean_(0) {
  const BetweenTurbidities rows(turbidity);
  // Bézier curves over the cube root of the elevation.
  const double x = std::cbrt(std::asin(std::clamp(to_sun.y, 0.0, 1.0)) / (kPi / 2));
  constexpr double kBinomials[kControlPoints] = {1, 5, 10, 10, 5, 1};
  for (int t = 0; t < 2; ++t)
    for (int ground = 0; ground < kAlbedos; ++ground)
      for (int point = 0; point < kControlPoints; ++point)
        for (int channel = 0; channel < kChannels; ++channel) {
          const SkyRow& row =
              kSkyRows[(((rows.lower + t) * kAlbedos + ground) * kControlPoints + point) * kChannels +
                       channel];
          const double weight = (t == 1 ? rows.share_of_upper : 1 - rows.share_of_upper) *
                                (ground == 1 ? albedo[channel] : 1 - albedo[channel]) * kBinomials[point] *
                                std::pow(x, point) * std::pow(1 - x, kControlPoints - 1 - point);
          const float values[] = {row.a, row.b, row.c, row.d, row.e, row.f, row.g, row.i, row.h};
          for (std::size_t k = 0; k < std::size(values); ++k)
            parameters_[k][channel] += weight * double(values[k]);
          mean_[channel] += weight * double(row.mean);
        }
  // The coefficients are of integrals over the wavelength.
  mean_ /= luminance_of_unit_power();
}

glm::dvec3 HosekWilkieSky::radiance(const glm::dvec3& w) const {
  const auto& [a, b, c, d, e, f, g, i, h] = parameters_;
  const double up = std::max(w.y, 0.0), cosine = glm::dot(w, to_sun_);
  const double gamma = std::atan2(glm::length(glm::cross(w, to_sun_)), cosine);
  // The paper's extension of Perez's formula, and its term for the aureole.
  const glm::dvec3 square = 1.0 + h * h - 2.0 * cosine * h,
                   chi = (1 + cosine * cosine) / (square * glm::sqrt(square));
  return mean_ * (1.0 + a * glm::exp(b / (up + 0.01))) *
         (c + d * glm::exp(e * gamma) + f * cosine * cosine + g * chi + i * std::sqrt(up));
}

}  // namespace penumbra
