#include "scheduler/render/option_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "scenes/number.h"

namespace penumbra {
namespace {

constexpr std::int64_t kUnlimited = std::int64_t(1) << 31;  // practically unlimited

/// `wrong` returns what is wrong with a finite number, or an empty text.
OptionCheck number_check(std::function<std::string(double)> wrong, const std::string& help) {
  return {[wrong = std::move(wrong)](const std::string& text) {
            const auto value = parse_number(text);
            return value ? wrong(*value) : value.error().message;
          },
          help};
}

/// Seconds of a number from zero with its unit. Nothing for other texts.
std::optional<double> time_with_unit(std::string_view text) {
  constexpr std::pair<char, double> kUnits[] = {{'s', 1}, {'m', 60}, {'h', 3600}, {'d', 86400}};
  if (text.empty()) return std::nullopt;
  const auto unit = std::ranges::find(kUnits, text.back(), &std::pair<char, double>::first);
  text.remove_suffix(1);
  const auto number = parse_number(text);
  if (unit == std::end(kUnits) || !number || !(*number >= 0)) return std::nullopt;
  return *number * unit->second;
}

/// Two whole numbers with "-", "..", ":" or "," between them.
bool is_range(std::string_view text) {
  for (const std::string_view between : {"..", "-", ":", ","}) {
    const std::size_t at = text.find(between, 1);
    if (at == std::string_view::npos) continue;
    if (parse_integer(text.substr(0, at)) && parse_integer(text.substr(at + between.size()))) return true;
  }
  return false;
}

}  // namespace

OptionCheck whole_number(std::int64_t low, std::int64_t high) {
  return {[low, high](const std::string& text) {
            const auto value = parse_integer(text, low, high);
            if (value) return std::string();
            return value.error().message +
                   (is_range(text) ? "; this takes one number, a list in a job file takes several"
                                   : std::string());
          },
          high < kUnlimited ? fmt::format("{} to {}", low, high) : fmt::format("{} or more", low)};
}

OptionCheck number_between(double low, double high) {
  return number_check(
      [low, high](double value) {
        return value >= low && value <= high
                   ? std::string()
                   : fmt::format("{} is not in the range from {} to {}", value, low, high);
      },
      fmt::format("{} to {}", low, high));
}

OptionCheck positive_number() {
  return number_check(
      [](double value) { return value > 0 ? std::string() : fmt::format("{} is not above 0", value); },
      "above 0");
}

OptionCheck number_from_zero() {
  return number_check(
      [](double value) { return value >= 0 ? std::string() : fmt::format("{} is below 0", value); },
      "0 or above");
}

OptionCheck duration() {
  return {[](std::string& text) -> std::string {
            const auto time = time_with_unit(text);
            if (!time) return fmt::format("'{}' is no time, as in 30s, 90m, 12h or 7d", text);
            text = fmt::to_string(*time);
            return {};
          },
          ""};
}

OptionCheck seconds() {
  return {[](std::string& text) -> std::string {
            if (const auto time = time_with_unit(text)) text = fmt::to_string(*time);
            return {};
          },
          ""};
}

OptionCheck some_text() {
  return {[](const std::string& text) { return text.empty() ? std::string("it is empty") : std::string(); },
          ""};
}

OptionCheck assignment() {
  return {[](const std::string& text) {
            const std::size_t equals = text.find('=');
            const bool good = equals != std::string::npos && equals > 0;
            return good ? std::string() : fmt::format("'{}' is not of the form name=value", text);
          },
          ""};
}

}  // namespace penumbra
