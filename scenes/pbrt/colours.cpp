#include "scenes/pbrt/colours.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/number.h"
#include "scenes/refractive_indices.h"
#include "scenes/spectrum.h"

namespace penumbra::pbrt {
namespace {

/// Chromaticities of primaries and white.
struct ColourSpace {
  std::string_view name;
  glm::dvec2 red, green, blue, white;
};
constexpr glm::dvec2 kD65{0.3127, 0.3290};
const ColourSpace kColourSpaces[] = {
    {"srgb", {0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, kD65},
    {"rec2020", {0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, kD65},
    {"dci-p3", {0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, kD65},
    {"aces2065-1", {0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.077}, {0.32168, 0.33767}}};

glm::dvec3 xyz_of(const glm::dvec2& at) { return {at.x / at.y, 1.0, (1.0 - at.x - at.y) / at.y}; }

glm::dmat3 to_xyz(const ColourSpace& space) {
  const glm::dmat3 primaries(xyz_of(space.red), space.green.y > 0 ? xyz_of(space.green) : glm::dvec3(0.0),
                             xyz_of(space.blue));
  const glm::dvec3 strengths = glm::inverse(primaries) * xyz_of(space.white);
  return {primaries[0] * strengths.x, primaries[1] * strengths.y, primaries[2] * strengths.z};
}

/// Converts to linear Rec. 709 and maps white to white: (1, 1, 1) means in pbrt the space's own white, or a
/// constant spectrum.
glm::dvec3 to_rec709(const glm::dvec3& colour, std::string_view space) {
  if (space == "srgb") return colour;
  for (const ColourSpace& each : kColourSpaces) {
    if (each.name != space) continue;
    const glm::dmat3 to_own = glm::inverse(to_xyz(kColourSpaces[0])) * to_xyz(each);
    const glm::dvec3 white = to_own * glm::dvec3(1.0);
    return glm::max(to_own * colour / white, 0.0);
  }
  return colour;
}

glm::vec3 with_luminance_1(const glm::vec3& colour) {
  const double y = luminance(glm::dvec3(colour));
  return y > 0.0 ? glm::vec3(glm::dvec3(colour) / y) : glm::vec3(0.0f);
}

/// Planck's law up to a factor.
glm::vec3 black_body(double kelvin) {
  std::vector<SpectrumSample> samples;
  for (double nm = 360.0; nm <= 830.0; nm += 5.0) {
    const double x = 1.4387769e7 / (nm * kelvin);  // second radiation constant, nm K
    const double reference = 1.4387769e7 / (560.0 * kelvin);
    samples.push_back({nm, std::pow(560.0 / nm, 5.0) * std::expm1(reference) / std::expm1(x)});
  }
  return with_luminance_1(emission_to_rgb(samples));
}

/// Illuminants of CIE 15:2004, given by their chromaticities.
std::optional<glm::vec3> standard_illuminant(std::string_view name) {
  static constexpr std::pair<std::string_view, glm::dvec2> kIlluminants[] = {
      {"A", {0.44757, 0.40745}},   {"D50", {0.34567, 0.35850}}, {"D65", kD65},
      {"F1", {0.31310, 0.33727}},  {"F2", {0.37208, 0.37529}},  {"F3", {0.40910, 0.39430}},
      {"F4", {0.44018, 0.40329}},  {"F5", {0.31379, 0.34531}},  {"F6", {0.37790, 0.38835}},
      {"F7", {0.31292, 0.32933}},  {"F8", {0.34588, 0.35875}},  {"F9", {0.37417, 0.37281}},
      {"F10", {0.34609, 0.35986}}, {"F11", {0.38052, 0.37713}}, {"F12", {0.43695, 0.40441}}};
  for (const auto& [each, at] : kIlluminants)
    if (each == name)
      return with_luminance_1(glm::vec3(glm::max(glm::inverse(to_xyz(kColourSpaces[0])) * xyz_of(at), 0.0)));
  return std::nullopt;
}

std::optional<glm::vec3> of_samples(const Parameter& parameter, const std::vector<double>& numbers,
                                    ColourOf use, ReaderReport& report) {
  std::vector<SpectrumSample> samples;
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) samples.push_back({numbers[i], numbers[i + 1]});
  const bool ascend = std::ranges::adjacent_find(samples, [](const auto& a, const auto& b) {
                        return !(a.wavelength < b.wavelength);
                      }) == samples.end();
  const bool positive = std::ranges::all_of(samples, [](const auto& s) { return s.value >= 0.0; });
  if (samples.empty() || numbers.size() % 2 != 0 || !ascend || !positive) {
    report.error(parameter.location,
                 "a spectrum is pairs of ascending wavelengths, nm, and values of at least 0");
    return std::nullopt;
  }
  report.warn_counted(parameter.location, "spectra are read as the colours that they have");
  if (use == ColourOf::kReflectance) return reflectance_to_rgb(samples);
  if (use == ColourOf::kIndex) return index_to_rgb(samples);
  return with_luminance_1(emission_to_rgb(samples));
}

std::optional<glm::vec3> named(const Parameter& parameter, const std::string& name, ColourOf use,
                               const FileAccess& files, const std::filesystem::path& folder,
                               ReaderReport& report) {
  if (name.starts_with("metal-")) {
    const std::size_t end = name.rfind('-');
    const auto conductor = conductor_names().parse(name.substr(6, end > 6 ? end - 6 : 0));
    if (conductor) {
      report.warn_counted(parameter.location, "spectra are read as the colours that they have");
      const ComplexIndex index = metal_index(*conductor);
      return name.ends_with("-k") ? index.k : index.eta;
    }
  }
  if (use == ColourOf::kLight && name.starts_with("stdillum-"))
    if (const auto colour = standard_illuminant(name.substr(9))) {
      report.warn_counted(parameter.location, "spectra are read as the colours that they have");
      return colour;
    }
  const std::array<std::filesystem::path, 1> folders = {folder};
  const auto path = files.find(name, folders);
  const auto file = path ? files.read(*path, kMaxSceneFileBytes) : std::unexpected(path.error());
  if (!file) {
    report.error(parameter.location, fmt::format("'{}' is no spectrum that is known, nor a file: {}", name,
                                                 file.error().message));
    return std::nullopt;
  }
  std::string text;
  for (std::size_t i = 0; i < (*file)->text.size(); ++i) {
    if ((*file)->text[i] == '#') i = std::min((*file)->text.find('\n', i), (*file)->text.size() - 1);
    text += (*file)->text[i];
  }
  const auto numbers = parse_numbers(trim(text));
  if (!numbers) {
    report.error(parameter.location, fmt::format("'{}': {}", name, numbers.error().message));
    return std::nullopt;
  }
  return of_samples(parameter, *numbers, use, report);
}

}  // namespace

std::optional<glm::vec3> colour_of(const Parameter& parameter, ColourOf use, const FileAccess& files,
                                   const std::filesystem::path& folder, ReaderReport& report) {
  const auto wrong = [&](std::string_view message) {
    report.error(parameter.location, fmt::format("'{}': {}", parameter.name, message));
    return std::nullopt;
  };
  const std::vector<double>& n = parameter.numbers;
  if (parameter.type == "rgb") {
    if (n.size() != 3) return wrong("an rgb has three numbers");
    const double most = use == ColourOf::kReflectance ? 1.0 : 1e30;
    for (const double x : n)
      if (!(x >= 0.0 && x <= most))
        return wrong(fmt::format("numbers must be in [0, {}], not {}",
                                 use == ColourOf::kReflectance ? "1" : "1e30", x));
    const glm::dvec3 colour = to_rec709({n[0], n[1], n[2]}, parameter.colour_space);
    // A reflectance of a larger gamut may be above 1 in ours: under white light, it is that bright.
    return glm::vec3(colour);
  }
  if (parameter.type == "blackbody") {
    if (n.size() != 1 || !(n[0] >= 100.0 && n[0] <= 1e6))
      return wrong("a blackbody has one temperature, 100 to 1e6 K");
    if (use != ColourOf::kLight) return wrong("only lights are black bodies");
    return black_body(n[0]);
  }
  if (parameter.type == "spectrum") {
    if (parameter.texts.size() == 1 && n.empty())
      return named(parameter, parameter.texts[0], use, files, folder, report);
    return of_samples(parameter, n, use, report);
  }
  return wrong(fmt::format("a colour is of the type rgb, spectrum or blackbody, not {}", parameter.type));
}

double luminance(const glm::dvec3& c) { return 0.212671 * c.x + 0.71516 * c.y + 0.072169 * c.z; }

ComplexIndex metal_index(int metal) {
  ComplexIndex index = conductor_index(metal);
  const glm::vec3 constant = emission_to_rgb(1.0);
  index.eta /= constant;
  index.k /= constant;
  return index;
}

glm::dmat3 white_balance(double kelvin) {
  // The second radiation constant was 1.4380e-2 m K when the illuminants were named by temperature.
  const double t = kelvin * 1.4388 / 1.4380;
  const glm::dmat3 xyz_of_rgb = to_xyz(kColourSpaces[0]);
  glm::dvec3 white = xyz_of_rgb * glm::dvec3(black_body(kelvin));
  if (t >= 4000.0) {
    const double x = t <= 7000.0 ? 0.244063 + (0.09911e3 + (2.9678e6 - 4.6070e9 / t) / t) / t
                                 : 0.237040 + (0.24748e3 + (1.9018e6 - 2.0064e9 / t) / t) / t;
    white = xyz_of({x, -3.0 * x * x + 2.870 * x - 0.275});
  }
  const glm::dmat3 cones =
      glm::transpose(glm::dmat3(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296));
  const glm::dvec3 gains = (cones * xyz_of(kD65)) / (cones * (white / white.y));
  const glm::dmat3 adapted =
      glm::inverse(cones) * glm::dmat3(gains.x, 0, 0, 0, gains.y, 0, 0, 0, gains.z) * cones;
  return glm::inverse(xyz_of_rgb) * adapted * xyz_of_rgb;
}

bool is_colour_space(std::string_view name) {
  return std::ranges::any_of(kColourSpaces, [&](const ColourSpace& each) { return each.name == name; });
}

std::optional<Glass> glass_named(std::string_view name) {
  // From the makers' data sheets; diamond: Peter's formula (1923). pbrt's glass-F5, -F10 and -F11 are
  // Schott's SF5, SF10 and SF11.
  static constexpr Glass kSf5{1.6727, 32.21}, kSf10{1.7283, 28.41}, kSf11{1.7847, 25.76};
  static constexpr std::pair<std::string_view, Glass> kGlasses[] = {{"glass-BK7", {1.5168, 64.17}},
                                                                    {"glass-BAF10", {1.6700, 47.11}},
                                                                    {"glass-FK51A", {1.4866, 84.47}},
                                                                    {"glass-LASF9", {1.8503, 32.17}},
                                                                    {"glass-F5", kSf5},
                                                                    {"glass-F10", kSf10},
                                                                    {"glass-F11", kSf11},
                                                                    {"glass-SF5", kSf5},
                                                                    {"glass-SF10", kSf10},
                                                                    {"glass-SF11", kSf11},
                                                                    {"diamond", {2.4176, 55.3}}};
  for (const auto& [glass, values] : kGlasses)
    if (glass == name) return values;
  return std::nullopt;
}

}  // namespace penumbra::pbrt
