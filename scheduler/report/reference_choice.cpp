#include "scheduler/report/reference_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>

#include "scenes/settings.h"

namespace penumbra {
namespace {

/// kOwn: no other integrator has the same limit image.
enum class Quantity { kUnshadowed, kDirect, kPaths, kMedia, kOwn };

/// Nothing if the integrator does not trace paths.
std::optional<int> max_depth(const IntegratorSettings& integrator) {
  std::optional<int> depth;
  with_parameter(integrator, PENUMBRA_PARAMETER(max_depth), [&](int edges) { depth = edges; });
  return depth;
}

bool is_occlusion(const IntegratorSettings& integrator) {
  return integrator.is<AmbientOcclusionIntegrator>() || integrator.is<ReflectionOcclusionIntegrator>() ||
         integrator.is<NormalsIntegrator>();
}

bool is_part(const IntegratorSettings& integrator) {
  const auto* path = integrator.get<PathIntegrator>();
  return path != nullptr && keeps_parts(*path);
}

Quantity quantity_of(const IntegratorSettings& integrator, bool has_media) {
  if (integrator.is<VolpathIntegrator>() || (has_photons(integrator) && has_media)) return Quantity::kMedia;
  if (is_occlusion(integrator) || is_part(integrator) ||
      parameter_or(integrator, PENUMBRA_PARAMETER(indirect_samples), 1) == 0)
    return Quantity::kOwn;
  if (const auto depth = max_depth(integrator)) return *depth == 2 ? Quantity::kDirect : Quantity::kPaths;
  const bool shadows = parameter_or(integrator, PENUMBRA_PARAMETER(trace_shadows), true);
  return integrator.is<PolygonAnalyticIntegrator>() || !shadows ? Quantity::kUnshadowed : Quantity::kDirect;
}

/// The integrator's parameters in the form of `--set`: those that change its limit image, or all.
std::vector<std::string> parameters_of(const IntegratorSettings& integrator, bool all) {
  std::vector<std::string> parameters;
  // The part of the light found by one technique depends on the MIS weights.
  const bool part = is_part(integrator);
  for (const IntegratorParameter& parameter : integrator_parameters()) {
    const std::string_view n = parameter.name;
    const bool counts = all || n == "ray_length" || n == "occlusion_weighting" || n == "background" ||
                        n == "exponent" || n == "max_depth" || n == "only_bounces" || n == "only_technique" ||
                        (part && (n == "mis" || n == "direct_sampling"));
    if (const void* value = parameter.find_in(integrator); counts && value != nullptr)
      parameters.push_back(fmt::format("integrator.{}={}", n, parameter.format.print(value)));
  }
  return parameters;
}

std::string own_quantity(const IntegratorSettings& integrator) {
  const std::string name = integrator.is<AmbientOcclusionIntegrator>()      ? "ambient occlusion"
                           : integrator.is<ReflectionOcclusionIntegrator>() ? "reflection occlusion"
                           : integrator.is<NormalsIntegrator>()             ? "normals"
                           : is_part(integrator)                            ? "a part of the light"
                           : sees_media(integrator)                         ? "light through media"
                                                                            : "direct light and mirrors";
  return fmt::format("{}, {}", name, fmt::join(parameters_of(integrator, false), ", "));
}

}  // namespace

std::string estimated_quantity(const IntegratorSettings& integrator, bool has_media) {
  const bool looked_through = integrator.hidden_emitters == HiddenEmitters::kLookedThrough;
  const std::string hidden = !integrator.hide_emitters ? ""
                             : looked_through          ? ", emitters looked through"
                                                       : ", emitters hidden";
  switch (quantity_of(integrator, has_media)) {
    case Quantity::kUnshadowed:
      return "direct light without shadows" + hidden;
    case Quantity::kDirect:
      return "direct light" + hidden;
    case Quantity::kMedia:
    case Quantity::kOwn:
      return own_quantity(integrator) + (is_occlusion(integrator) ? "" : hidden);
    case Quantity::kPaths:
      break;
  }
  const int depth = max_depth(integrator).value_or(-1);
  if (depth < 0) return "all light" + hidden;
  return fmt::format("light along paths of up to {} edges{}", depth, hidden);
}

ReferencePair choose_reference(const IntegratorSettings& integrator, bool has_media) {
  ReferencePair halves;
  RenderSettings settings;
  settings.integrator = integrator;
  const auto same = [&](const char* name) {
    const std::string key = fmt::format("integrator.{}", name);
    return fmt::format("{}={}", key, print_setting(settings, key));
  };
  switch (quantity_of(integrator, has_media)) {
    case Quantity::kUnshadowed:
      halves = {{{"polygon_analytic", {}, "sobol"},
                 {"polygon_area", {"integrator.trace_shadows=false"}, "independent"}}};
      break;
    case Quantity::kDirect:
      halves = {
          {{"path_mis", {"integrator.max_depth=2"}, "sobol"},
           {"direct",
            {"integrator.emitter_samples=1", "integrator.bsdf_samples=1", "integrator.bsdf_sampling=bsdf"},
            "independent"}}};
      break;
    case Quantity::kPaths:
      halves = {{{"path_mis", {"integrator.mis=balance"}, "sobol"},
                 {"path_mis", {"integrator.mis=power"}, "independent"}}};
      for (ReferenceMethod& half : halves) half.settings.push_back(same("max_depth"));
      break;
    case Quantity::kMedia:
      halves = {{{"volpath", {"integrator.mis=balance"}, "sobol"},
                 {"volpath", {"integrator.mis=power"}, "independent"}}};
      for (ReferenceMethod& half : halves) half.settings.push_back(same("max_depth"));
      break;
    case Quantity::kOwn:
      for (ReferenceMethod& half : halves)
        half = {method_name(integrator.method), parameters_of(integrator, true), "sobol"};
      halves[1].sampler = "independent";
      return halves;
  }
  for (ReferenceMethod& half : halves) {
    if (half.integrator.starts_with("path") || half.integrator == "volpath")
      half.settings.emplace_back("integrator.nee=sample");
    half.settings.push_back(same("hide_emitters"));
    half.settings.push_back(same("hidden_emitters"));
  }
  return halves;
}

std::uint32_t half_reference_spp(std::uint32_t largest_budget, std::uint32_t total) {
  constexpr std::uint64_t kMost = std::uint64_t(1) << 30;
  if (total > 0) return std::uint32_t((std::uint64_t(total) + 1) / 2);
  const std::uint64_t half = (kReferenceFactor * largest_budget + 1) / 2;
  return std::uint32_t(std::min(kMost, std::bit_ceil(half)));
}

}  // namespace penumbra
