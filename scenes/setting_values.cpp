#include "scenes/setting_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "scenes/number.h"

namespace penumbra {
namespace {

template <typename T>
std::string range_text(const Number<T>& number) {
  return fmt::format("{} {} and below {}", number.end == LowEnd::kOpen ? "above" : "at least", number.low,
                     number.high);
}

}  // namespace

std::string WholeNumber::values() const {
  // The limit of int is not worth mentioning.
  return high == kMaxInt ? fmt::format("{} or more", low) : fmt::format("{} to {}", low, high);
}

Expected<std::int64_t> WholeNumber::parse(std::string_view text) const {
  return parse_integer(text, low, high);
}

std::string WholeNumber::print(std::int64_t value) { return fmt::to_string(value); }

template <typename T>
std::string Number<T>::values() const {
  // Nor is the limit of float.
  if (high < std::numeric_limits<float>::max()) return range_text(*this);
  return end == LowEnd::kOpen ? fmt::format("above {}", low) : fmt::format("{} or more", low);
}

template <typename T>
Expected<T> Number<T>::parse(std::string_view text) const {
  const auto number = parse_number(text);
  if (!number) return std::unexpected(number.error());
  const T value = T(*number);
  if ((end == LowEnd::kOpen ? value > low : value >= low) && value < high) return value;
  return fail(fmt::format("{} is not {}", *number, range_text(*this)));
}

template <typename T>
std::string Number<T>::print(T value) {
  return fmt::to_string(value);
}

template struct Number<float>;
template struct Number<double>;

std::string NumberOrAuto::values() const { return fmt::format("auto, or {} to {}", low, high); }

Expected<std::optional<float>> NumberOrAuto::parse(std::string_view text) const {
  if (trim(text) == "auto") return std::nullopt;
  const auto number = parse_number(text);
  if (!number) return fail(number.error().message + "; nor is it 'auto'");
  if (*number >= double(low) && *number <= double(high)) return float(*number);
  return fail(fmt::format("{} is not between {} and {}", *number, double(low), double(high)));
}

std::string NumberOrAuto::print(std::optional<float> value) {
  return value ? fmt::to_string(*value) : "auto";
}

std::string TrueOrFalse::values() { return "true, false"; }
Expected<bool> TrueOrFalse::parse(std::string_view text) { return parse_boolean(text); }
std::string TrueOrFalse::print(bool value) { return value ? "true" : "false"; }

std::string NamedCurve::values() const {
  return fmt::format("{}, or 2 to {} numbers of 0 or more", list_names(choice_names(curves)), most);
}

Expected<std::vector<double>> NamedCurve::parse(std::string_view text) const {
  for (const auto& [name, curve] : curves)
    if (trim(text) == name) return curve;
  auto numbers = parse_numbers(text);
  if (!numbers)
    return fail(
        fmt::format("{}; nor is it one of: {}", numbers.error().message, list_names(choice_names(curves))));
  if (numbers->size() < 2 || numbers->size() > most)
    return fail(fmt::format("a curve takes 2 to {} numbers, not {}", most, numbers->size()));
  const auto [low, high] = std::ranges::minmax(*numbers);
  if (low < 0.0) return fail(fmt::format("{} is below 0", low));
  if (high == 0.0) return fail("one of the numbers must be above 0");
  return numbers;
}

std::string NamedCurve::print(const std::vector<double>& curve) const {
  for (const auto& [name, known] : curves)
    if (known == curve) return name;
  return fmt::format("{}", fmt::join(curve, ","));
}

Expected<std::size_t> parse_name(std::string_view text, const std::vector<std::string>& names) {
  const std::string_view name = trim(text);
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return std::size_t(found - names.begin());
  return fail(fmt::format("'{}' is not one of: {}{}", name, list_names(names), suggestion(name, names)));
}

Expected<std::vector<bool>> parse_names(std::string_view text, const std::vector<std::string>& names) {
  std::vector<bool> chosen(names.size());
  if (trim(text) == "none") return chosen;
  const auto entries = split_list(text);
  if (!entries) return std::unexpected(entries.error());
  if (entries->empty()) return fail("no name is given; 'none' stands for none");
  for (const std::string_view entry : *entries) {
    const auto index = parse_name(entry, names);
    if (!index) return std::unexpected(index.error());
    chosen[*index] = true;
  }
  return chosen;
}

}  // namespace penumbra
