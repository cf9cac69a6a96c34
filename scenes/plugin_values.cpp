#include "scenes/plugin_values.h"

#include <fmt/format.h>

namespace penumbra {

void check_within(Findings& findings, const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high))
    findings.push_back(
        {name, fmt::format("{} must be a number in [{}, {}], not {}", name, low, high, value)});
}

std::string ColourWithin::values() const {
  if (high == kAnyNumber) return fmt::format("colour, {} or more", low);
  return fmt::format("colour in [{}, {}]", low, high);
}

std::string IndexColour::values() const { return fmt::format("colour in [0, {}]", kMostIndex); }

std::string NumberWithin::values() const {
  if (low == -kAnyNumber && high == kAnyNumber) return "number";
  if (high == kAnyNumber)
    return end == LowEnd::kOpen ? fmt::format("number above {}", low)
                                : fmt::format("number, {} or more", low);
  return fmt::format("number in {}{}, {}]", end == LowEnd::kOpen ? '(' : '[', low, high);
}

std::string print_default(const glm::vec3& colour) {
  if (colour.x == colour.y && colour.y == colour.z) return fmt::format("{}", colour.x);
  return fmt::format("{}, {}, {}", colour.x, colour.y, colour.z);
}
std::string print_default(const TexturedColour& colour) { return print_default(colour.value); }
std::string print_default(const TexturedNumber& number) { return print_default(number.value); }
std::string print_default(const glm::dvec3& point) {
  return fmt::format("{}, {}, {}", point.x, point.y, point.z);
}
std::string print_default(const glm::dmat4& transform) {
  return transform == glm::dmat4(1.0) ? "identity" : "other";
}
std::string print_default(const std::string& text) { return text; }
std::string print_default(float number) { return fmt::format("{}", number); }
std::string print_default(double number) { return fmt::format("{}", number); }
std::string print_default(bool value) { return value ? "true" : "false"; }

}  // namespace penumbra
