#include "scheduler/report/method.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/diagnostic.h"
#include "scenes/number.h"
#include "scenes/settings.h"

namespace penumbra {
namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

Expected<std::uint32_t> parse_budget(std::string_view text) {
  const auto value = parse_integer(text, 1, kMaxSamplesPerPixel);
  if (!value) return fail("samples per pixel: " + value.error().message);
  return std::uint32_t(*value);
}

}  // namespace

Expected<Method> parse_method(std::string_view text) {
  Method method;
  const std::size_t colon = text.find(':');
  std::string_view name = text.substr(0, colon);
  const std::size_t equals = name.find('=');
  method.label = text;
  if (equals != std::string_view::npos) {
    method.label = text.substr(0, equals);
    name.remove_prefix(equals + 1);
  }
  if (method.label.empty()) return fail(fmt::format("'{}' has no name", text));
  method.integrator = name;
  const auto& known = find_setting("integrator.type")->choices;
  if (std::ranges::find(known, method.integrator) == known.end()) {
    return fail(
        fmt::format("integrator '{}' is not one of: {}{}", name, list_names(known), suggestion(name, known)));
  }
  if (colon == std::string_view::npos) return method;
  for (const std::string_view setting : split(text.substr(colon + 1), ',')) {
    const std::size_t at = setting.find('=');
    if (at == 0 || at == std::string_view::npos) {
      return fail(fmt::format("'{}' in '{}' is not of the form key=value", setting, text));
    }
    const bool has_group = setting.substr(0, at).find('.') != std::string_view::npos;
    method.settings.push_back(fmt::format("{}{}", has_group ? "" : "integrator.", setting));
  }
  return method;
}

Expected<std::vector<std::uint32_t>> parse_budgets(std::string_view text) {
  std::vector<std::uint32_t> budgets;
  if (const std::size_t dots = text.find(".."); dots != std::string_view::npos) {
    const auto first = parse_budget(text.substr(0, dots)), last = parse_budget(text.substr(dots + 2));
    if (!first) return std::unexpected(first.error());
    if (!last) return std::unexpected(last.error());
    if (*first > *last) return fail(fmt::format("'{}' ends before it begins", text));
    for (std::uint64_t budget = *first; budget <= *last; budget *= 2)
      budgets.push_back(std::uint32_t(budget));
    return budgets;
  }
  for (const std::string_view part : split(text, ',')) {
    const auto budget = parse_budget(part);
    if (!budget) return std::unexpected(budget.error());
    budgets.push_back(*budget);
  }
  std::ranges::sort(budgets);
  if (const auto twice = std::ranges::adjacent_find(budgets); twice != budgets.end()) {
    return fail(fmt::format("{} samples per pixel twice in '{}'", *twice, text));
  }
  return budgets;
}

Expected<Target> parse_target(std::string_view text) {
  const std::size_t equals = text.find('=');
  const std::string_view name = text.substr(0, equals);
  if (equals == std::string_view::npos || (name != "relmse" && name != "mse" && name != "block_relmse")) {
    return fail(fmt::format("'{}' is not relmse=VALUE, mse=VALUE or block_relmse=VALUE", text));
  }
  const auto value = parse_number(text.substr(equals + 1));
  if (!value || !(*value > 0)) {
    return fail(fmt::format("'{}' is not a positive error", text.substr(equals + 1)));
  }
  return Target{name != "mse", *value, name == "block_relmse"};
}

}  // namespace penumbra
