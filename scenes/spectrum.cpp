#include "scenes/spectrum.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace penumbra {
namespace {

constexpr double kFirstWavelength = 360.0;
constexpr double kWavelengthStep = 5.0;

struct CieRow {
  double x, y, z, d65;
};

// The CIE 1931 standard colorimetric observer (2 degrees) and the standard illuminant D65, relative to 100 at
// 560 nm, from 360 to 830 nm in steps of 5 nm: CIE 015:2018, Colorimetry, tables 1 and 6; both are linear
// between the rows.
// clang-format off
constexpr CieRow kCie[] = {
    {.0001299, .000003917, .0006061, 46.6383}, {.0002321, .000006965, .001086, 49.3637},  // 360 nm
    {.0004149, .00001239, .001946, 52.0891}, {.0007416, .00002202, .003486, 51.0323},  // 370 nm
    {.001368, .000039, .00645, 49.9755}, {.002236, .000064, .01055, 52.3118},  // 380 nm
    {.004243, .00012, .02005, 54.6482}, {.00765, .000217, .03621, 68.7015},  // 390 nm
    {.01431, .000396, .06785, 82.7549}, {.02319, .00064, .1102, 87.1204},  // 400 nm
    {.04351, .00121, .2074, 91.486}, {.07763, .00218, .3713, 92.4589},  // 410 nm
    {.13438, .004, .6456, 93.4318}, {.21477, .0073, 1.03905, 90.057},  // 420 nm
    {.2839, .0116, 1.3856, 86.6823}, {.3285, .01684, 1.62296, 95.7736},  // 430 nm
    {.34828, .023, 1.74706, 104.865}, {.34806, .0298, 1.7826, 110.936},  // 440 nm
    {.3362, .038, 1.77211, 117.008}, {.3187, .048, 1.7441, 117.41},  // 450 nm
    {.2908, .06, 1.6692, 117.812}, {.2511, .0739, 1.5281, 116.336},  // 460 nm
    {.19536, .09098, 1.28764, 114.861}, {.1421, .1126, 1.0419, 115.392},  // 470 nm
    {.09564, .13902, .81295, 115.923}, {.05795, .1693, .6162, 112.367},  // 480 nm
    {.03201, .20802, .46518, 108.811}, {.0147, .2586, .3533, 109.082},  // 490 nm
    {.0049, .323, .272, 109.354}, {.0024, .4073, .2123, 108.578},  // 500 nm
    {.0093, .503, .1582, 107.802}, {.0291, .6082, .1117, 106.296},  // 510 nm
    {.06327, .71, .07825, 104.79}, {.1096, .7932, .05725, 106.239},  // 520 nm
    {.1655, .862, .04216, 107.689}, {.22575, .91485, .02984, 106.047},  // 530 nm
    {.2904, .954, .0203, 104.405}, {.3597, .9803, .0134, 104.225},  // 540 nm
    {.43345, .99495, .00875, 104.046}, {.51205, 1., .00575, 102.023},  // 550 nm
    {.5945, .995, .0039, 100.}, {.6784, .9786, .00275, 98.1671},  // 560 nm
    {.7621, .952, .0021, 96.3342}, {.8425, .9154, .0018, 96.0611},  // 570 nm
    {.9163, .87, .00165, 95.788}, {.9786, .8163, .0014, 92.2368},  // 580 nm
    {1.0263, .757, .0011, 88.6856}, {1.0567, .6949, .001, 89.3459},  // 590 nm
    {1.0622, .631, .0008, 90.0062}, {1.0456, .5668, .0006, 89.8026},  // 600 nm
    {1.0026, .503, .00034, 89.5991}, {.9384, .4412, .00024, 88.6489},  // 610 nm
    {.85445, .381, .00019, 87.6987}, {.7514, .321, .0001, 85.4936},  // 620 nm
    {.6424, .265, .00005, 83.2886}, {.5419, .217, .00003, 83.4939},  // 630 nm
    {.4479, .175, .00002, 83.6992}, {.3608, .1382, .00001, 81.863},  // 640 nm
    {.2835, .107, 0., 80.0268}, {.2187, .0816, 0., 80.1207},  // 650 nm
    {.1649, .061, 0., 80.2146}, {.1212, .04458, 0., 81.2462},  // 660 nm
    {.0874, .032, 0., 82.2778}, {.0636, .0232, 0., 80.281},  // 670 nm
    {.04677, .017, 0., 78.2842}, {.0329, .01192, 0., 74.0027},  // 680 nm
    {.0227, .00821, 0., 69.7213}, {.01584, .005723, 0., 70.6652},  // 690 nm
    {.0113592, .004102, 0., 71.6091}, {.00811092, .002929, 0., 72.979},  // 700 nm
    {.00579035, .002091, 0., 74.349}, {.00410946, .001484, 0., 67.9765},  // 710 nm
    {.00289933, .001047, 0., 61.604}, {.00204919, .00074, 0., 65.7448},  // 720 nm
    {.00143997, .00052, 0., 69.8856}, {.000999949, .0003611, 0., 72.4863},  // 730 nm
    {.000690079, .0002492, 0., 75.087}, {.000476021, .0001719, 0., 69.3398},  // 740 nm
    {.000332301, .00012, 0., 63.5927}, {.000234826, .0000848, 0., 55.0054},  // 750 nm
    {.00016615, .00006, 0., 46.4182}, {.000117413, .0000424, 0., 56.6118},  // 760 nm
    {.0000830753, .00003, 0., 66.8054}, {.0000587065, .0000212, 0., 65.0941},  // 770 nm
    {.0000415099, .00001499, 0., 63.3828}, {.0000293533, .0000106, 0., 63.8434},  // 780 nm
    {.0000206738, .0000074657, 0., 64.304}, {.0000145598, .0000052578, 0., 61.8779},  // 790 nm
    {.000010254, .0000037029, 0., 59.4519}, {.00000722146, .0000026078, 0., 55.7054},  // 800 nm
    {.00000508587, .0000018366, 0., 51.959}, {.00000358165, .0000012934, 0., 54.6998},  // 810 nm
    {.00000252252, .00000091093, 0., 57.4406}, {.00000177651, .00000064153, 0., 58.8765},  // 820 nm
    {.00000125114, .00000045181, 0., 60.3125},  // 830 nm
};
// clang-format on

constexpr double kLastWavelength = kFirstWavelength + kWavelengthStep * (std::size(kCie) - 1);

CieRow cie_at(double wavelength) {
  const double at =
      std::clamp((wavelength - kFirstWavelength) / kWavelengthStep, 0.0, double(std::size(kCie) - 1));
  const std::size_t row = std::min(static_cast<std::size_t>(at), std::size(kCie) - 2);
  const double t = at - double(row);
  const CieRow &a = kCie[row], &b = kCie[row + 1];
  return {std::lerp(a.x, b.x, t), std::lerp(a.y, b.y, t), std::lerp(a.z, b.z, t), std::lerp(a.d65, b.d65, t)};
}

/// The inverse of the matrix of Rec. 709 primaries and a D65 white, IEC 61966-2-1 (sRGB).
glm::dvec3 xyz_to_rec709(glm::dvec3 c) {
  return {3.2404542 * c.x - 1.5371385 * c.y - 0.4985314 * c.z,
          -0.9692660 * c.x + 1.8760108 * c.y + 0.0415560 * c.z,
          0.0556434 * c.x - 0.2040259 * c.y + 1.0572252 * c.z};
}

double value_at(std::span<const SpectrumSample> samples, double wavelength) {
  const auto right = std::upper_bound(samples.begin(), samples.end(), wavelength,
                                      [](double w, const SpectrumSample& s) { return w < s.wavelength; });
  if (right == samples.begin()) return 0.0;
  const auto left = std::prev(right);
  if (right == samples.end()) return left->wavelength == wavelength ? left->value : 0.0;
  const double t = (wavelength - left->wavelength) / (right->wavelength - left->wavelength);
  return std::lerp(left->value, right->value, t);
}

/// Integrates spectrum times matching functions times illuminant (D65 or equal energy) and converts to Rec.
/// 709. All factors are linear between neighbouring breakpoints, so their product is at most a cubic there,
/// for which Simpson's rule is exact.
glm::dvec3 integrate(std::span<const SpectrumSample> samples, bool under_d65) {
  std::vector<double> breaks;
  for (std::size_t row = 0; row < std::size(kCie); ++row)
    breaks.push_back(kFirstWavelength + kWavelengthStep * double(row));
  for (const SpectrumSample& sample : samples)
    breaks.push_back(std::clamp(sample.wavelength, kFirstWavelength, kLastWavelength));
  std::sort(breaks.begin(), breaks.end());
  glm::dvec3 xyz(0.0);
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const double width = breaks[i + 1] - breaks[i];
    // Outside the table the spectrum is zero, with a jump at its ends.
    if (width <= 0.0 || breaks[i] < samples.front().wavelength || breaks[i + 1] > samples.back().wavelength)
      continue;
    constexpr double kSimpson[3] = {1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};
    for (int k = 0; k < 3; ++k) {
      const double wavelength = breaks[i] + 0.5 * k * width;
      const CieRow cie = cie_at(wavelength);
      const double weight = kSimpson[k] * width * value_at(samples, wavelength) * (under_d65 ? cie.d65 : 1.0);
      xyz += weight * glm::dvec3(cie.x, cie.y, cie.z);
    }
  }
  return xyz_to_rec709(xyz);
}

/// Planck's law, in W/(m² sr nm).
double planck(double nanometres, double kelvins) {
  constexpr double kPlanck = 6.62607015e-34, kLight = 299792458.0, kBoltzmann = 1.380649e-23;  // SI, exact
  const double metres = nanometres * 1e-9;
  const double exponent = kPlanck * kLight / (metres * kBoltzmann * kelvins);
  return 2 * kPlanck * kLight * kLight / (std::pow(metres, 5) * std::expm1(exponent)) * 1e-9;
}

constexpr SpectrumSample kFlat[] = {{kFirstWavelength, 1.0}, {kLastWavelength, 1.0}};

}  // namespace

double luminance_of_unit_power() {
  double sum = 0.0;
  for (std::size_t row = 0; row + 1 < std::size(kCie); ++row)
    sum += 0.5 * kWavelengthStep * (kCie[row].y + kCie[row + 1].y);
  return sum;
}

glm::dvec3 matching_rgb(double wavelength) {
  const CieRow cie = cie_at(wavelength);
  return xyz_to_rec709({cie.x, cie.y, cie.z});
}

glm::dvec3 reflectance_weight(double wavelength) {
  static const glm::dvec3 white = integrate(kFlat, true);
  return matching_rgb(wavelength) * cie_at(wavelength).d65 / white;
}

glm::vec3 reflectance_to_rgb(std::span<const SpectrumSample> samples) {
  return glm::min(index_to_rgb(samples), 1.0f);
}

glm::vec3 index_to_rgb(std::span<const SpectrumSample> samples) {
  return glm::max(unclamped_index_to_rgb(samples), 0.0);
}

glm::dvec3 unclamped_index_to_rgb(std::span<const SpectrumSample> samples) {
  static const glm::dvec3 white = integrate(kFlat, true);
  return integrate(samples, true) / white;
}

glm::vec3 emission_to_rgb(std::span<const SpectrumSample> samples) {
  static const double normalisation = luminance_of_unit_power();
  return glm::max(integrate(samples, false) / normalisation, 0.0);
}

glm::vec3 emission_to_rgb(double constant) {
  static const glm::dvec3 white = integrate(kFlat, false) / luminance_of_unit_power();
  return white * constant;
}

glm::vec3 blackbody_to_rgb(double temperature) {
  std::vector<SpectrumSample> samples;
  for (double nanometres = kFirstWavelength; nanometres <= kLastWavelength; nanometres += 1.0)
    samples.push_back({nanometres, planck(nanometres, temperature)});
  return emission_to_rgb(samples);
}

glm::vec3 unit_blackbody_to_rgb(double temperature) {
  constexpr double kWien = 2.897771955e6;  // nm K
  const double most = planck(kWien / temperature, temperature);
  std::vector<SpectrumSample> samples;
  for (double nanometres = kFirstWavelength; nanometres <= kLastWavelength; nanometres += 1.0)
    samples.push_back({nanometres, luminance_of_unit_power() * planck(nanometres, temperature) / most});
  return emission_to_rgb(samples);
}

double srgb_to_linear(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace penumbra
