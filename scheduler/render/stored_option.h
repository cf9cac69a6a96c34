// Makes the rows of options whose value is a member of the request, by its type: from text, and to text.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <concepts>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "scenes/number.h"
#include "scheduler/render/render_option.h"
#include "worker/cli/command_line.h"

namespace penumbra {

/// The type of one value of a member that has at most one, or a list.
template <typename T>
struct OneValue {
  using Type = T;
};
template <typename T>
struct OneValue<std::optional<T>> {
  using Type = T;
};
template <typename T>
struct OneValue<std::vector<T>> {
  using Type = T;
};

template <typename T>
constexpr OptionKind kind_of() {
  using Value = typename OneValue<T>::Type;
  if constexpr (std::is_same_v<T, std::vector<std::string>>) return OptionKind::kList;
  if constexpr (std::is_same_v<Value, bool>) return OptionKind::kFlag;
  if constexpr (std::is_same_v<Value, double>) return OptionKind::kNumber;
  if constexpr (!std::is_integral_v<Value>) return OptionKind::kText;
  return sizeof(Value) > sizeof(int) ? OptionKind::kCount : OptionKind::kInteger;
}

/// The value that the text says. Of a text that is no number, parse_number and the like say what is wrong.
template <typename T>
Expected<T> value_of(const std::string& text) {
  if constexpr (std::is_same_v<T, bool>) return parse_boolean(text);
  if constexpr (std::is_same_v<T, double>) return parse_number(text);
  if constexpr (std::is_same_v<T, std::string>) return text;
  if constexpr (std::is_same_v<T, Backend>) return backend_from_name(text);
  if constexpr (std::is_same_v<T, CropRectangle>) return parse_crop(text);
  if constexpr (std::is_same_v<T, PixelPosition>) return parse_pixel(text);
  if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    const auto number = parse_integer(
        text, 0, std::int64_t(std::min<std::uint64_t>(std::numeric_limits<T>::max(), INT64_MAX)));
    if (!number) return std::unexpected(number.error());
    return T(*number);
  }
}

using Texts = std::vector<std::string>;
inline Texts texts_of(bool value) { return value ? Texts{"true"} : Texts(); }
inline Texts texts_of(const std::string& value) { return value.empty() ? Texts() : Texts{value}; }
inline Texts texts_of(const std::vector<std::string>& values) { return values; }
inline Texts texts_of(Backend value) { return {std::string(backend_name(value))}; }
inline Texts texts_of(const CropRectangle& c) { return {fmt::format("{},{},{},{}", c.x0, c.y0, c.x1, c.y1)}; }
inline Texts texts_of(const PixelPosition& p) { return {fmt::format("{},{}", p.x, p.y)}; }
inline Texts texts_of(double value) { return {fmt::to_string(value)}; }
template <std::integral T>
Texts texts_of(T value) {
  return {fmt::to_string(value)};
}
template <typename T>
Texts texts_of(const std::optional<T>& value) {
  return value ? texts_of(*value) : Texts();
}

/// Adds rows that have a heading, and what they determine and change, in common.
struct OptionRows {
  std::vector<RenderOption>& all;
  std::string group;
  OptionPart part;
  OptionEffect effect;

  /// Adds the option whose value is at(request) and has to pass the checks.
  template <typename At>
  RenderOption& add(std::string names, std::string value, At at, std::vector<OptionCheck> checks,
                    std::string help) {
    using T = std::remove_cvref_t<decltype(at(std::declval<RenderRequest&>()))>;
    using Value = typename OneValue<T>::Type;
    RenderOption row{.names = std::move(names),
                     .value = std::move(value),
                     .group = group,
                     .help = std::move(help),
                     .part = part,
                     .effect = effect,
                     .kind = kind_of<T>()};
    for (const OptionCheck& check : checks) row.limits += check.limits;
    row.apply = [at, checks = std::move(checks)](RenderRequest& request,
                                                 std::string& text) -> Expected<void> {
      for (const OptionCheck& check : checks)
        if (const std::string wrong = check.wrong(text); !wrong.empty()) return fail(wrong);
      const auto value = value_of<Value>(text);
      if (!value) return std::unexpected(value.error());
      if constexpr (kind_of<T>() == OptionKind::kList)
        at(request).push_back(*value);
      else
        at(request) = *value;
      return {};
    };
    row.print = [at](const RenderRequest& request) { return texts_of(at(request)); };
    return all.emplace_back(std::move(row));
  }
};
#define PENUMBRA_AT(member) \
  [](auto& request) -> auto& { return request.member; }

}  // namespace penumbra
