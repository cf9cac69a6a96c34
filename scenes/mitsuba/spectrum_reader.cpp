#include "scenes/mitsuba/spectrum_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scenes/number.h"

namespace penumbra::mitsuba {
namespace {

using Colour = std::optional<glm::vec3>;

/// A list of tabulated values in a text parameter.
std::optional<std::vector<double>> read_list(PluginReader& plugin, const char* name) {
  if (!plugin.has(name)) {
    plugin.accept({name});
    plugin.wrong(fmt::format("{} needs <string name=\"{}\" …>", plugin.title(), name));
    return std::nullopt;
  }
  const Expected<std::vector<double>> numbers = parse_numbers(plugin.text(name, ""));
  if (numbers && numbers->size() >= 2) return *numbers;
  plugin.wrong(name, numbers ? fmt::format("{}: a table has at least two numbers", name)
                             : fmt::format("{}: {}", name, numbers.error().message));
  return std::nullopt;
}

Colour read_table(PluginReader& plugin, ColourRole role, const std::vector<double>& wavelengths,
                  const std::vector<double>& values) {
  std::vector<SpectrumSample> samples;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0 && !(wavelengths[i] > wavelengths[i - 1])) {
      plugin.wrong("wavelengths", fmt::format("the wavelengths of a spectrum must ascend; {} follows {}",
                                              wavelengths[i], wavelengths[i - 1]));
      return std::nullopt;
    }
    samples.push_back({wavelengths[i], values[i]});
  }
  const Expected<glm::vec3> rgb = table_to_rgb(samples, role);
  if (rgb) return *rgb;
  plugin.wrong("values", rgb.error().message);
  return std::nullopt;
}

Colour read_irregular(PluginReader& plugin, ColourRole role) {
  const auto wavelengths = read_list(plugin, "wavelengths"), values = read_list(plugin, "values");
  if (!wavelengths || !values) return std::nullopt;
  if (wavelengths->size() == values->size()) return read_table(plugin, role, *wavelengths, *values);
  plugin.wrong("values", fmt::format("there are {} wavelengths and {} values: give one for each",
                                     wavelengths->size(), values->size()));
  return std::nullopt;
}

Colour read_regular(PluginReader& plugin, ColourRole role) {
  const double low = plugin.number("wavelength_min", 360.0), high = plugin.number("wavelength_max", 830.0);
  const auto values = read_list(plugin, "values");
  if (!values) return std::nullopt;
  if (!(high > low)) {
    plugin.wrong("wavelength_max", "wavelength_max must be more than wavelength_min");
    return std::nullopt;
  }
  std::vector<double> wavelengths;
  for (std::size_t i = 0; i < values->size(); ++i)
    wavelengths.push_back(low + (high - low) * double(i) / double(values->size() - 1));
  return read_table(plugin, role, wavelengths, *values);
}

/// A spectrum that is constant over wavelength is grey, as in Mitsuba 3.
Colour read_uniform(PluginReader& plugin, ColourRole) {
  return glm::vec3(float(plugin.number("value", 1.0)));
}

/// D65 is white, so the result is its scale times a colour.
Colour read_d65(PluginReader& plugin, ColourRole) {
  glm::vec3 colour(1.0f);
  plugin.read_colour("color", colour, ColourRole::kEmission);
  return colour * float(plugin.number("scale", 1.0));
}

Colour read_rgb(PluginReader& plugin, ColourRole role) {
  glm::vec3 colour(0.5f);
  plugin.read_colour(plugin.has("value") ? "value" : "color", colour, role);
  return colour;
}

/// "5000", "5000k", "5000 K".
std::optional<double> kelvins(std::string_view text) {
  text = trim(text);
  if (!text.empty() && (text.back() == 'k' || text.back() == 'K')) text.remove_suffix(1);
  const Expected<double> number = parse_number(trim(text));
  return number && *number > 0.0 && *number <= 1e6 ? std::optional(*number) : std::nullopt;
}

/// In W/(m² sr nm) as in Mitsuba 0.6, which gives thousands for the sun's temperature.
Colour read_blackbody(PluginReader& plugin, ColourRole role) {
  const Parameter* given = nullptr;
  for (const Parameter& each : plugin.object().parameters)
    if (each.name == "temperature") given = &each;
  plugin.accept({"temperature"});
  const double scale = plugin.number("scale", 1.0);
  const auto temperature = given != nullptr ? kelvins(given->text) : std::nullopt;
  if (!temperature) {
    plugin.wrong("temperature",
                 given != nullptr
                     ? fmt::format("'{}' is not a temperature such as 5000 (kelvins)", given->text)
                     : "a black body needs a temperature, kelvins");
    return std::nullopt;
  }
  if (role == ColourRole::kReflectance) {
    plugin.wrong("a black body is no reflectance");
    return std::nullopt;
  }
  return float(scale) * blackbody_to_rgb(*temperature);
}

struct SpectrumPlugin {
  std::string_view type;
  Colour (*read)(PluginReader&, ColourRole);
};
constexpr std::array kSpectra = {SpectrumPlugin{"blackbody", read_blackbody},
                                 SpectrumPlugin{"d65", read_d65},
                                 SpectrumPlugin{"irregular", read_irregular},
                                 SpectrumPlugin{"regular", read_regular},
                                 SpectrumPlugin{"rgb", read_rgb},
                                 SpectrumPlugin{"srgb", read_rgb},
                                 SpectrumPlugin{"uniform", read_uniform}};

}  // namespace

Expected<glm::vec3> table_to_rgb(std::span<const SpectrumSample> samples, ColourRole role) {
  const bool reflects = role == ColourRole::kReflectance, emits = role == ColourRole::kEmission;
  for (const SpectrumSample& sample : samples) {
    // Check before the conversion, which clamps to the gamut and would hide these.
    if (sample.value < 0.0 || (reflects && sample.value > 1.0))
      return fail(fmt::format("the value {} at {} nm is not {}", sample.value, sample.wavelength,
                              reflects ? "between 0 and 1" : "0 or more"));
  }
  return emits ? emission_to_rgb(samples) : reflects ? reflectance_to_rgb(samples) : index_to_rgb(samples);
}

std::optional<glm::vec3> read_spectrum_plugin(const Context& context, const Object& object, ColourRole role) {
  PluginReader plugin(context, object);
  const SpectrumPlugin* known = find_plugin(kSpectra, object.type);
  if (known == nullptr) {
    context.unknown_plugin(object, plugin_types(kSpectra), "a plain magenta stands in for it");
    plugin.skip();
    return std::nullopt;
  }
  const Colour colour = known->read(plugin, role);
  plugin.finish();
  return colour;
}

Expected<std::vector<SpectrumSample>> read_spectrum_file(const SourceFile& file) {
  std::vector<SpectrumSample> samples;
  const std::string_view text = file.text;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view whole = text.substr(at, end - at);
    const std::string_view line = trim(whole.substr(0, whole.find('#')));
    const auto wrong = [&](const std::string& message) {
      return fail(format_diagnostic({&file, std::size_t(line.data() - text.data())}, "error", message));
    };
    at = end + 1;
    if (line.empty()) continue;
    const Expected<std::vector<double>> numbers = parse_numbers(line);
    if (!numbers) return wrong(numbers.error().message);
    if (numbers->size() != 2)
      return wrong(fmt::format("a line has a wavelength and a value, not {} numbers", numbers->size()));
    const SpectrumSample sample{(*numbers)[0], (*numbers)[1]};
    if (!samples.empty() && !(sample.wavelength > samples.back().wavelength))
      return wrong(fmt::format("the wavelengths of a spectrum must ascend; {} follows {}", sample.wavelength,
                               samples.back().wavelength));
    samples.push_back(sample);
  }
  if (samples.size() < 2)
    return fail(format_diagnostic({&file, 0}, "error", "a spectrum's file has at least two wavelengths"));
  return samples;
}

}  // namespace penumbra::mitsuba
