#include "scheduler/stress/selection.h"

#include <algorithm>

#include "scenes/diagnostic.h"
#include "scheduler/stress/cases/cases.h"

namespace penumbra::stress {
namespace {

bool glob(std::string_view name, std::string_view pattern) {
  // On a mismatch, only the last * is retried with one more character; earlier ones need no retry.
  std::size_t n = 0, p = 0, star = std::string_view::npos, retry = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      retry = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++n, ++p;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++retry;
    } else {
      return false;
    }
  }
  return std::all_of(pattern.begin() + std::ptrdiff_t(p), pattern.end(), [](char c) { return c == '*'; });
}

}  // namespace

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const auto add :
       {add_polygon_cases, add_lobe_cases, add_solid_angle_cases, add_projected_cases, add_bsdf_cases,
        add_mixture_cases, add_sampler_cases, add_intersection_cases, add_small_function_cases,
        add_medium_cases, add_render_medium_cases, add_render_photon_cases, add_render_light_cases,
        add_sky_and_beam_cases, add_render_cases, add_merge_cases})
    add(cases);
  return cases;
}

bool matches(std::string_view name, std::string_view pattern) {
  if (pattern.find_first_of("*?") != std::string_view::npos) return glob(name, pattern);
  return name.find(pattern) != std::string_view::npos;
}

Expected<std::vector<Case>> select(std::vector<Case> cases, const std::vector<std::string>& patterns) {
  for (const std::string& pattern : patterns) {
    if (std::none_of(cases.begin(), cases.end(), [&](const Case& c) { return matches(c.name, pattern); })) {
      std::vector<std::string> names;
      for (const Case& c : cases) names.push_back(c.name);
      return fail("no case matches '" + pattern + "'" + suggestion(pattern, names) + " (--list shows all)");
    }
  }
  if (patterns.empty()) return cases;
  std::erase_if(cases, [&](const Case& c) {
    return std::none_of(patterns.begin(), patterns.end(),
                        [&](const std::string& pattern) { return matches(c.name, pattern); });
  });
  return cases;
}

}  // namespace penumbra::stress
