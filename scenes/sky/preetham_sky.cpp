#include "scenes/sky/preetham_sky.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes/angles.h"
#include "scenes/spectrum.h"

namespace penumbra {
namespace {

constexpr double kLeastCosine = 0.001;  // the distribution is not defined at the horizon
/// The luminance in cd/m² of radiance 1 W/m²/sr/nm at all wavelengths: 683 lm/W times the integral of the
/// luminous efficiency function, in nm.
constexpr double kCandelas = 683.0 * 106.856895;

/// From CIE XYZ to linear RGB (IEC 61966-2-1).
glm::dvec3 xyz_to_rgb(const glm::dvec3& c) {
  return {3.2404542 * c.x - 1.5371385 * c.y - 0.4985314 * c.z,
          -0.9692660 * c.x + 1.8760108 * c.y + 0.0415560 * c.z,
          0.0556434 * c.x - 0.2040259 * c.y + 1.0572252 * c.z};
}

}  // namespace

double PreethamSky::Perez::at(double cosine, double gamma) const {
  return (1 + a * std::exp(b / cosine)) *
         (1 + c * std::exp(d * gamma) + e * std::cos(gamma) * std::cos(gamma));
}

PreethamSky::PreethamSky(const glm::dvec3& to_sun, double turbidity) : to_sun_(to_sun) {
  const double t = std::max(turbidity, 2.0);
  // The paper's appendix A.2.
  luminance_ = {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
                -0.0670 * t + 0.3703};
  x_ = {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
        -0.0033 * t + 0.0452};
  y_ = {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
        -0.0109 * t + 0.0529};
  const double angle = std::acos(std::clamp(to_sun.y, 0.0, 1.0)),
               chi = (4.0 / 9 - t / 120) * (kPi - 2 * angle);
  const double candelas = 1000 * ((4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192);
  const glm::dvec3 powers(angle * angle * angle, angle * angle, angle);
  const double x = t * t * glm::dot(powers, {0.00166, -0.00375, 0.00209}) +
                   t * (glm::dot(powers, {-0.02903, 0.06377, -0.03202}) + 0.00394) +
                   glm::dot(powers, {0.11693, -0.21196, 0.06052}) + 0.25886;
  const double y = t * t * glm::dot(powers, {0.00275, -0.00610, 0.00317}) +
                   t * (glm::dot(powers, {-0.04214, 0.08970, -0.04153}) + 0.00516) +
                   glm::dot(powers, {0.15346, -0.26756, 0.06670}) + 0.26688;
  zenith_ = glm::dvec3(std::max(candelas, 0.0), x, y) /
            glm::dvec3(luminance_.at(1, angle), x_.at(1, angle), y_.at(1, angle));
}

glm::dvec3 PreethamSky::radiance(const glm::dvec3& w) const {
  const double cosine = std::max(w.y, kLeastCosine);
  const glm::dvec3 above = glm::normalize(glm::dvec3(w.x, std::max(w.y, 0.0), w.z) + glm::dvec3(0, 1e-12, 0));
  const double gamma = std::atan2(glm::length(glm::cross(above, to_sun_)), glm::dot(above, to_sun_));
  const double luminance = zenith_.x * luminance_.at(cosine, gamma) / kCandelas;
  const double x = zenith_.y * x_.at(cosine, gamma), y = zenith_.z * y_.at(cosine, gamma);
  const glm::dvec3 xyz(x / y * luminance, luminance, (1 - x - y) / y * luminance);
  return glm::max(xyz_to_rgb(xyz), glm::dvec3(0));
}

glm::dvec3 sun_radiance(double cosine, double turbidity) {
  if (!(cosine > 0)) return glm::dvec3(0);
  // The paper's appendix A.1, in the visible range, with a black body for the sun: Iqbal 1983. Wavelengths
  // are in micrometres.
  const double degrees = std::acos(std::min(cosine, 1.0)) * 180 / kPi;
  const double air = 1 / (cosine + 0.15 * std::pow(93.885 - degrees, -1.253));
  const double haze = 0.04608 * turbidity - 0.04586, ozone_layer = 0.35;  // cm
  // Absorption of ozone, 1/cm, from 445 to 690 nm in steps of 5.
  constexpr double kOzone[] = {0.003, 0.003, 0.004, 0.006, 0.008, 0.009, 0.012, 0.014, 0.017, 0.021,
                               0.025, 0.030, 0.035, 0.040, 0.045, 0.048, 0.057, 0.063, 0.070, 0.075,
                               0.080, 0.085, 0.095, 0.103, 0.110, 0.120, 0.122, 0.120, 0.118, 0.115,
                               0.120, 0.125, 0.130, 0.120, 0.105, 0.090, 0.079, 0.067, 0.057, 0.048,
                               0.036, 0.028, 0.023, 0.018, 0.014, 0.011, 0.010, 0.009, 0.007, 0.004};
  std::vector<SpectrumSample> spectrum;
  for (int nm = 360; nm <= 830; nm += 5) {
    const double l = nm / 1000.0;
    const int row = (nm - 445) / 5;
    const double ozone = nm >= 445 && row < int(std::size(kOzone)) ? kOzone[row] : 0.0;
    // Planck's law at 5778 K, W/m²/sr/nm: 2hc²/λ⁵ / (exp(hc / λkT) - 1).
    const double body = 1.191042972e5 / std::pow(l, 5) / std::expm1(14387.768775 / (l * 5778));
    const double passes = std::exp(-air * (0.008735 * std::pow(l, -4.08) +
                                           std::max(haze, 0.0) * std::pow(l, -1.3) + ozone_layer * ozone));
    spectrum.push_back({double(nm), body * passes});
  }
  return glm::dvec3(emission_to_rgb(spectrum));
}

}  // namespace penumbra
