#include "scenes/mitsuba/value_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "scenes/mitsuba/xml_source.h"
#include "scenes/names.h"
#include "scenes/number.h"

namespace penumbra::mitsuba {

std::optional<std::string> ElementReader::attribute(std::string_view name) const {
  for (const pugi::xml_attribute& each : element_.attributes()) {
    if (name == each.name()) return substitute_(each.value(), value_location(name));
  }
  return std::nullopt;
}

std::optional<std::string> ElementReader::required(std::string_view name) const {
  const std::string text(name);
  if (!element_.attribute(text.c_str())) {
    return wrong(fmt::format("<{}> needs the attribute '{}'", element_.name(), name));
  }
  return attribute(name);
}

bool ElementReader::check_attributes(std::initializer_list<std::string_view> known) const {
  constexpr std::ptrdiff_t kMaxAttributes = 16;
  const auto attributes = element_.attributes();
  if (std::distance(attributes.begin(), attributes.end()) > kMaxAttributes) {
    wrong(fmt::format("<{}> has more than {} attributes", element_.name(), kMaxAttributes));
    return false;
  }
  bool good = true;
  std::vector<std::string> seen;
  for (const pugi::xml_attribute& each : element_.attributes()) {
    const SourceLocation place = locate_attribute(file_, element_, each.name());
    if (std::find(known.begin(), known.end(), each.name()) == known.end()) {
      const std::vector<std::string> names(known.begin(), known.end());
      diagnostics_.error(place, fmt::format("<{}> has no attribute '{}'{}", element_.name(), each.name(),
                                            known_names(each.name(), names, "It has")));
      good = false;
    } else if (std::find(seen.begin(), seen.end(), each.name()) != seen.end()) {
      diagnostics_.error(place, fmt::format("the attribute '{}' is there twice", each.name()));
      good = false;
    }
    seen.emplace_back(each.name());
  }
  return good;
}

std::nullopt_t ElementReader::wrong(std::string_view message) const {
  diagnostics_.error(location(), message);
  return std::nullopt;
}

std::nullopt_t ElementReader::wrong_value(std::string_view attribute, std::string_view message) const {
  diagnostics_.error(value_location(attribute), message);
  return std::nullopt;
}

SourceLocation ElementReader::location() const { return locate(file_, element_); }

SourceLocation ElementReader::value_location(std::string_view attribute) const {
  return locate_value(file_, element_, attribute);
}

namespace {

std::optional<Value> read_rgb_hex(const ElementReader& element, std::string_view text) {
  glm::vec3 rgb(0.0f);
  bool good = text.size() == 7;
  for (std::size_t i = 1; good && i < 7; ++i) good = std::isxdigit(static_cast<unsigned char>(text[i])) != 0;
  if (!good)
    return element.wrong_value("value", fmt::format("'{}' is not a colour of the form #rrggbb", text));
  for (int channel = 0; channel < 3; ++channel) {
    const std::string digits(text.substr(1 + 2 * std::size_t(channel), 2));
    rgb[channel] = float(srgb_to_linear(double(std::stoi(digits, nullptr, 16)) / 255.0));
  }
  return RgbValue{rgb};
}

std::optional<Value> read_rgb(const ElementReader& element, std::string_view text, bool encoded) {
  if (trim(text).starts_with('#')) return read_rgb_hex(element, trim(text));
  const auto numbers = parse_numbers(text);
  if (!numbers) return element.wrong_value("value", numbers.error().message);
  if (numbers->size() != 1 && numbers->size() != 3) {
    return element.wrong_value("value",
                               fmt::format("a colour has one or three numbers, not {}", numbers->size()));
  }
  glm::vec3 rgb(0.0f);
  for (std::size_t i = 0; i < 3; ++i) {
    const double number = (*numbers)[numbers->size() == 3 ? i : 0];
    rgb[int(i)] = float(encoded ? srgb_to_linear(number) : number);
  }
  return RgbValue{rgb};
}

std::optional<Value> read_spectrum(const ElementReader& element, std::string_view text) {
  const auto tokens = split_list(text);
  if (!tokens) return element.wrong_value("value", tokens.error().message);
  SpectrumValue spectrum;
  if (text.find(':') == text.npos) {
    if (tokens->size() == 3) return read_rgb(element, text, false);
    if (tokens->size() != 1) {
      return element.wrong_value("value", "a spectrum is one number, or a table such as '400:0.1, 700:0.2'");
    }
    const auto constant = parse_number(tokens->front());
    if (!constant) return element.wrong_value("value", constant.error().message);
    spectrum.constant = *constant;
    return spectrum;
  }
  for (const std::string_view token : *tokens) {
    const std::size_t colon = token.find(':');
    if (colon == token.npos) {
      return element.wrong_value("value", fmt::format("'{}' is not of the form wavelength:value", token));
    }
    const auto wavelength = parse_number(token.substr(0, colon));
    const auto value = parse_number(token.substr(colon + 1));
    if (!wavelength) return element.wrong_value("value", wavelength.error().message);
    if (!value) return element.wrong_value("value", value.error().message);
    if (!spectrum.samples.empty() && !(*wavelength > spectrum.samples.back().wavelength)) {
      return element.wrong_value(
          "value", fmt::format("the wavelengths of a spectrum must ascend; {} follows {}", *wavelength,
                               spectrum.samples.back().wavelength));
    }
    spectrum.samples.push_back({*wavelength, *value});
  }
  if (spectrum.samples.size() < 2)
    return element.wrong_value("value", "a table has at least two wavelengths");
  return spectrum;
}

std::optional<Value> read_triple(const ElementReader& element) {
  if (const auto text = element.attribute("value")) {
    const auto numbers = parse_numbers(*text);
    if (!numbers) return element.wrong_value("value", numbers.error().message);
    if (numbers->size() != 3) {
      return element.wrong_value("value", fmt::format("three numbers are wanted, not {}", numbers->size()));
    }
    return glm::dvec3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
  }
  glm::dvec3 result(0.0);
  static constexpr std::string_view kAxes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    const auto text = element.required(kAxes[i]);
    if (!text) return std::nullopt;
    const auto number = parse_number(*text);
    if (!number) return element.wrong_value(kAxes[i], number.error().message);
    result[i] = *number;
  }
  return result;
}

template <typename T>
std::optional<Value> checked(const ElementReader& element, Expected<T> value) {
  if (!value) return element.wrong_value("value", value.error().message);
  return Value(*value);
}

std::optional<Value> read_text_value(const ElementReader& element, std::string_view tag, std::string& text) {
  auto written = element.required("value");
  if (!written) return std::nullopt;
  text = std::move(*written);
  if (tag == "integer") return checked(element, parse_integer(text));
  if (tag == "float") return checked(element, parse_number(text));
  if (tag == "boolean") return checked(element, parse_boolean(text));
  if (tag == "rgb") return read_rgb(element, text, false);
  if (tag == "srgb") return read_rgb(element, text, true);
  if (tag == "spectrum") return read_spectrum(element, text);
  return Value(text);
}

}  // namespace

const std::vector<std::string>& value_tags() {
  static const std::vector<std::string> tags = {"integer",  "float",     "boolean",  "string",
                                                "point",    "vector",    "rgb",      "srgb",
                                                "spectrum", "transform", "animation"};
  return tags;
}

bool is_value(const pugi::xml_node& element) {
  const std::string_view tag = element.name();
  if (tag == "spectrum" && element.attribute("type")) return false;
  return std::find(value_tags().begin(), value_tags().end(), tag) != value_tags().end();
}

std::optional<Parameter> read_value(const ElementReader& element) {
  Parameter result;
  result.tag = element.element().name();
  result.location = element.location();
  result.value_location = element.value_location("value");
  std::optional<Value> value;
  if (result.tag == "transform") {
    if (!element.check_attributes({"name"})) return std::nullopt;
    if (const auto matrix = read_transform(element)) value = *matrix;
  } else if (result.tag == "animation") {
    if (!element.check_attributes({"name"})) return std::nullopt;
    value = read_animation(element);
  } else {
    const bool triple = result.tag == "point" || result.tag == "vector";
    const bool known =
        triple                     ? element.check_attributes({"name", "value", "x", "y", "z"})
        : result.tag == "spectrum" ? element.check_attributes({"name", "value", "intent", "filename"})
        : result.tag == "rgb" || result.tag == "srgb" ? element.check_attributes({"name", "value", "intent"})
                                                      : element.check_attributes({"name", "value"});
    if (!known) return std::nullopt;
    if (const auto file = element.attribute("filename")) {
      if (element.element().attribute("value"))
        return element.wrong("a spectrum has a value or a filename, not both");
      result.value_location = element.value_location("filename");
      value = SpectrumValue{0.0, {}, *file};
    }
    for (const pugi::xml_node& child : element.element().children()) {
      if (child.type() == pugi::node_element) {
        return element.child(child).wrong(fmt::format("<{}> cannot hold other elements", result.tag));
      }
    }
    if (!value) value = triple ? read_triple(element) : read_text_value(element, result.tag, result.text);
  }
  if (!value) return std::nullopt;
  result.value = std::move(*value);
  const auto name = element.required("name");
  if (!name) return std::nullopt;
  result.name = to_snake_case(*name);
  return result;
}

}  // namespace penumbra::mitsuba
