// The types of setting values. Each type parses text, prints a value as text that parses back to the same
// value, and describes the accepted values in words.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/diagnostic.h"

namespace penumbra {

enum class SettingKind { kInteger, kNumber, kBoolean, kText, kNumberOrText };

constexpr std::int64_t kMaxInt = std::numeric_limits<int>::max();

/// A whole number in [low, high].
struct WholeNumber {
  std::int64_t low, high;

  static constexpr SettingKind kKind = SettingKind::kInteger;
  [[nodiscard]] std::string values() const;
  [[nodiscard]] Expected<std::int64_t> parse(std::string_view text) const;
  [[nodiscard]] static std::string print(std::int64_t value);
};

/// A number with low < value < high, or low <= value < high. The range applies to the number after rounding
/// to the type that stores it, float or double.
enum class LowEnd { kOpen, kClosed };
template <typename T>
struct Number {
  LowEnd end;
  T low, high;

  static constexpr SettingKind kKind = SettingKind::kNumber;
  [[nodiscard]] std::string values() const;
  [[nodiscard]] Expected<T> parse(std::string_view text) const;
  [[nodiscard]] static std::string print(T value);
};

/// A number in [low, high], or "auto", which is stored as no number.
struct NumberOrAuto {
  float low, high;

  static constexpr SettingKind kKind = SettingKind::kNumberOrText;
  [[nodiscard]] std::string values() const;
  [[nodiscard]] Expected<std::optional<float>> parse(std::string_view text) const;
  [[nodiscard]] static std::string print(std::optional<float> value);
};

struct TrueOrFalse {
  static constexpr SettingKind kKind = SettingKind::kBoolean;
  [[nodiscard]] static std::string values();
  [[nodiscard]] static Expected<bool> parse(std::string_view text);
  [[nodiscard]] static std::string print(bool value);
};

/// The index of the name. Errors: an unknown name; the message lists the names and suggests the nearest.
Expected<std::size_t> parse_name(std::string_view text, const std::vector<std::string>& names);

/// Whether each of the names is in a list, whose names are separated by commas; none is in "none". Errors: an
/// unknown name, as for parse_name.
Expected<std::vector<bool>> parse_names(std::string_view text, const std::vector<std::string>& names);

template <typename T>
std::vector<std::string> choice_names(const std::vector<std::pair<const char*, T>>& choices) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) names.emplace_back(name);
  return names;
}

/// One of several values by name. If two names have the same value, the first is printed.
template <typename T>
struct OneOf {
  std::vector<std::pair<const char*, T>> choices;

  static constexpr SettingKind kKind = SettingKind::kText;
  [[nodiscard]] std::vector<std::string> names() const { return choice_names(choices); }
  [[nodiscard]] std::string values() const { return list_names(names()); }
  [[nodiscard]] Expected<T> parse(std::string_view text) const {
    const auto index = parse_name(text, names());
    if (!index) return std::unexpected(index.error());
    return choices[*index].second;
  }
  [[nodiscard]] std::string print(T value) const {
    for (const auto& [name, known] : choices)
      if (known == value) return name;
    return "?";
  }
};

/// Any of several values by name, separated by commas; "none" for none of them.
template <typename T>
struct SomeOf {
  std::vector<std::pair<const char*, T>> choices;

  static constexpr SettingKind kKind = SettingKind::kText;
  [[nodiscard]] std::vector<std::string> names() const { return choice_names(choices); }
  [[nodiscard]] std::string values() const { return "none, or some of " + list_names(names()); }
  /// In the order of the choices, each once.
  [[nodiscard]] Expected<std::vector<T>> parse(std::string_view text) const {
    const auto chosen = parse_names(text, names());
    if (!chosen) return std::unexpected(chosen.error());
    std::vector<T> result;
    for (std::size_t i = 0; i < choices.size(); ++i)
      if ((*chosen)[i]) result.push_back(choices[i].second);
    return result;
  }
  [[nodiscard]] std::string print(const std::vector<T>& some) const {
    std::string text;
    for (const T& value : some) text += (text.empty() ? "" : ",") + OneOf<T>{choices}.print(value);
    return text.empty() ? "none" : text;
  }
};

/// A curve by its values at evenly spaced places, or by name. The values are at least two and at most `most`;
/// none is negative, and one is above 0.
struct NamedCurve {
  std::vector<std::pair<const char*, std::vector<double>>> curves;
  std::size_t most;

  static constexpr SettingKind kKind = SettingKind::kText;
  [[nodiscard]] std::string values() const;
  [[nodiscard]] Expected<std::vector<double>> parse(std::string_view text) const;
  /// The name, or the values with commas.
  [[nodiscard]] std::string print(const std::vector<double>& curve) const;
};

/// How values of one type are read from text and printed, where only their place is known.
struct ValueFormat {
  SettingKind kind;
  std::string values;                ///< the accepted values in words
  std::vector<std::string> choices;  ///< the accepted names, also of a list of names; empty: it is neither
  /// `to` may be null: the text is only checked.
  std::function<Expected<void>(std::string_view text, void* to)> read;
  std::function<std::string(const void* from)> print;
  void (*assign)(void* to, const void* from);
};

/// The format of values that are stored as a T.
template <typename T, typename Values>
ValueFormat format_of(const Values& values) {
  ValueFormat format{
      .kind = Values::kKind, .values = values.values(), .choices = {}, .read = {}, .print = {}, .assign = {}};
  if constexpr (requires { values.names(); }) format.choices = values.names();
  format.read = [values](std::string_view text, void* to) -> Expected<void> {
    auto value = values.parse(text);
    if (!value) return std::unexpected(value.error());
    if (to != nullptr) *static_cast<T*>(to) = T(*std::move(value));
    return {};
  };
  format.print = [values](const void* from) { return values.print(*static_cast<const T*>(from)); };
  format.assign = [](void* to, const void* from) { *static_cast<T*>(to) = *static_cast<const T*>(from); };
  return format;
}

}  // namespace penumbra
