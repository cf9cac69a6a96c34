#include "scheduler/render/render_option.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <ranges>

namespace penumbra {
namespace {

/// Without dashes, and without the value of a flag.
std::vector<std::string> bare_names(const RenderOption& option) {
  std::vector<std::string> names;
  for (const auto& part : std::views::split(option.names, ',')) {
    const std::string_view text(part.begin(), part.end());
    names.emplace_back(text.substr(0, text.find('{')).substr(text.find_first_not_of('-')));
  }
  return names;
}

/// Parses exactly `values.size()` non-negative integers separated by commas.
bool parse_integers(const std::string& text, std::span<int> values) {
  const char* at = text.data();
  const char* end = text.data() + text.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0 && (at == end || *at++ != ',')) return false;
    const auto [next, error] = std::from_chars(at, end, values[i]);
    if (error != std::errc() || values[i] < 0) return false;
    at = next;
  }
  return at == end;
}

}  // namespace

std::string RenderOption::name() const {
  const std::vector<std::string> all = bare_names(*this);
  const auto long_name = std::ranges::find_if(all, [](const std::string& each) { return each.size() > 1; });
  return long_name == all.end() ? all.front() : *long_name;
}

std::string RenderOption::word() const {
  const std::string bare = name();
  return (bare.size() > 1 ? "--" : "-") + bare;
}

std::string RenderOption::record_name() const {
  if (!recorded_as.empty()) return recorded_as;
  std::string text = name();
  std::ranges::replace(text, '-', '_');
  return text;
}

std::string RenderOption::flag_text() const {
  const std::size_t open = names.find('{');
  return open == std::string::npos ? "true" : names.substr(open + 1, names.find('}') - open - 1);
}

const RenderOption* find_render_option(std::string_view name) {
  const auto options = all_render_options();
  const auto found = std::ranges::find_if(options, [name](const RenderOption& option) {
    const std::vector<std::string> all = bare_names(option);
    return std::ranges::find(all, name) != all.end();
  });
  return found == options.end() ? nullptr : &*found;
}

std::vector<std::string> given_values(const RenderOption& option, const RenderRequest& request) {
  static const RenderRequest defaults;
  std::vector<std::string> values = option.print(request);
  if (values == option.print(defaults)) values.clear();
  return values;
}

Expected<void> check_exclusions(const RenderRequest& request) {
  for (const RenderOption& option : all_render_options())
    for (const std::string& other : option.excludes)
      if (!given_values(option, request).empty() &&
          !given_values(*find_render_option(other), request).empty())
        return fail(fmt::format("{} excludes --{}", option.word(), other));
  return {};
}

PlanOptions plan_of(const RenderRequest& request, const IntegratorSettings& integrator) {
  const bool with_maps = integrator.is<ProgressivePhotonIntegrator>();
  PlanOptions plan = request.plan;
  if (plan.samples_per_pass == 0) plan.samples_per_pass = with_maps ? kPassWithMaps : kDefaultPass;
  if (plan.tile == 0) plan.tile = with_maps ? kTileWithMaps : kDefaultTile;
  return plan;
}

Expected<CropRectangle> parse_crop(const std::string& text) {
  int v[4];
  if (!parse_integers(text, v) || v[0] >= v[2] || v[1] >= v[3])
    return fail("'" + text + "' is not x0,y0,x1,y1 with 0 <= x0 < x1, 0 <= y0 < y1");
  return CropRectangle{v[0], v[1], v[2], v[3]};
}

Expected<PixelPosition> parse_pixel(const std::string& text) {
  int v[2];
  if (!parse_integers(text, v)) return fail("'" + text + "' is not x,y with x and y from 0 up");
  return PixelPosition{v[0], v[1]};
}

}  // namespace penumbra
