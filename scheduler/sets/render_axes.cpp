#include "scheduler/sets/render_axes.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/number.h"

namespace penumbra {
namespace {

constexpr int kWidestField = 32;
constexpr std::int64_t kLongestRange = 1'000'000;

struct Field {
  std::string_view name;
  std::string_view width;  // empty: none
  std::size_t end = 0;     // after the closing brace
};

/// The field that begins at `at`. Nothing if its end is missing.
std::optional<Field> field_at(std::string_view text, std::size_t at) {
  const std::size_t end = text.find('}', at);
  if (end == text.npos) return std::nullopt;
  const std::string_view inside = text.substr(at + 1, end - at - 1);
  const std::size_t colon = inside.find(':');
  if (colon == inside.npos) return Field{inside, {}, end + 1};
  return Field{inside.substr(0, colon), inside.substr(colon + 1), end + 1};
}

std::string list_fields(const NameFields& fields) {
  std::string list;
  for (const auto& [name, value] : fields) list += (list.empty() ? "{" : ", {") + name + "}";
  return list;
}

}  // namespace

void set_axis(std::vector<RenderAxis>& axes, RenderAxis axis) {
  const auto same = std::ranges::find_if(
      axes, [&](const RenderAxis& other) { return other.kind == axis.kind && other.name == axis.name; });
  if (same == axes.end())
    axes.push_back(std::move(axis));
  else
    *same = std::move(axis);
}

std::size_t count_combinations(const std::vector<RenderAxis>& axes, std::size_t most) {
  std::size_t count = 1;
  for (const RenderAxis& axis : axes) {
    if (axis.values.size() > most / count) return 0;
    count *= axis.values.size();
  }
  return count;
}

std::vector<RenderChoice> all_choices(const std::vector<RenderAxis>& axes) {
  std::vector<RenderChoice> choices(1);
  for (const RenderAxis& axis : axes) {
    std::vector<RenderChoice> longer;
    longer.reserve(choices.size() * axis.values.size());
    for (const RenderChoice& choice : choices)
      for (const std::string& value : axis.values) longer.emplace_back(choice).push_back(value);
    choices = std::move(longer);
  }
  return choices;
}

Expected<std::string> fill_in(std::string_view text, const NameFields& fields) {
  std::string filled;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] != '{') {
      filled += text[at++];
      continue;
    }
    const auto field = field_at(text, at);
    if (!field) return fail(fmt::format("{}: a '{{' without its '}}'", text));
    const auto found = fields.find(field->name);
    if (found == fields.end())
      return fail(fmt::format("{}: '{{{}}}' is no field of a name here; these are: {}", text, field->name,
                              list_fields(fields)));
    at = field->end;
    if (field->width.empty()) {
      filled += found->second;
      continue;
    }
    const auto width = parse_integer(field->width), number = parse_integer(found->second);
    if (!width || *width < 1 || *width > kWidestField)
      return fail(fmt::format("{}: the width of {{{}:{}}} is none; 3 or 03 would be", text, field->name,
                              field->width));
    if (!number)
      return fail(fmt::format("{}: {{{}:{}}} is for a whole number, not '{}'", text, field->name,
                              field->width, found->second));
    filled += field->width.front() == '0' ? fmt::format("{:0{}}", *number, *width)
                                          : fmt::format("{:{}}", *number, *width);
  }
  return filled;
}

bool has_field(std::string_view text, std::string_view name) {
  for (std::size_t at = text.find('{'); at != text.npos; at = text.find('{', at + 1))
    if (const auto field = field_at(text, at); field && field->name == name) return true;
  return false;
}

std::optional<std::vector<std::string>> range_of(std::string_view text) {
  const std::size_t dots = text.find("..");
  if (dots == text.npos) return std::nullopt;
  const std::string_view rest = text.substr(dots + 2);
  const std::size_t cross = rest.find('x');
  const auto first = parse_integer(text.substr(0, dots)), last = parse_integer(rest.substr(0, cross)),
             step = parse_integer(cross == rest.npos ? "1" : rest.substr(cross + 1));
  if (!first || !last || !step || *step < 1 || *first < 0 || *last < *first) return std::nullopt;
  if ((*last - *first) / *step >= kLongestRange) return std::nullopt;
  std::vector<std::string> numbers;
  for (std::int64_t i = 0; i <= (*last - *first) / *step; ++i)
    numbers.push_back(fmt::to_string(*first + i * *step));
  return numbers;
}

}  // namespace penumbra
