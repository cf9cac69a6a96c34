#include "scheduler/report/reference_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>

namespace penumbra {
namespace {

enum class Light { kUnshadowed, kDirect, kPaths };

Light light_of(const IntegratorSettings& integrator) {
  if (integrator.kind == IntegratorKind::kPath)
    return integrator.max_depth == 2 ? Light::kDirect : Light::kPaths;
  if (integrator.kind == IntegratorKind::kPolygonAnalytic) return Light::kUnshadowed;
  const bool may_leave_shadows_out =
      integrator.kind == IntegratorKind::kDirect || integrator.kind == IntegratorKind::kPolygonArea;
  return may_leave_shadows_out && !integrator.trace_shadows ? Light::kUnshadowed : Light::kDirect;
}

}  // namespace

std::string estimated_quantity(const IntegratorSettings& integrator) {
  const bool looked_through = integrator.hidden_emitters == HiddenEmitters::kLookedThrough;
  const std::string hidden = !integrator.hide_emitters ? ""
                             : looked_through          ? ", emitters looked through"
                                                       : ", emitters hidden";
  switch (light_of(integrator)) {
    case Light::kUnshadowed:
      return "direct light without shadows" + hidden;
    case Light::kDirect:
      return "direct light" + hidden;
    case Light::kPaths:
      break;
  }
  if (integrator.max_depth < 0) return "all light" + hidden;
  return fmt::format("light along paths of up to {} edges{}", integrator.max_depth, hidden);
}

std::array<ReferenceMethod, 2> choose_reference(const IntegratorSettings& integrator) {
  std::array<ReferenceMethod, 2> halves;
  switch (light_of(integrator)) {
    case Light::kUnshadowed:
      halves = {{{"polygon_analytic", {}, "sobol"},
                 {"polygon_area", {"integrator.trace_shadows=false"}, "independent"}}};
      break;
    case Light::kDirect:
      halves = {
          {{"path_mis", {"integrator.max_depth=2"}, "sobol"},
           {"direct",
            {"integrator.emitter_samples=1", "integrator.bsdf_samples=1", "integrator.bsdf_sampling=bsdf"},
            "independent"}}};
      break;
    case Light::kPaths:
      halves = {{{"path_mis", {"integrator.mis=balance"}, "sobol"},
                 {"path_mis", {"integrator.mis=power"}, "independent"}}};
      for (ReferenceMethod& half : halves)
        half.settings.push_back(fmt::format("integrator.max_depth={}", integrator.max_depth));
      break;
  }
  for (ReferenceMethod& half : halves) {
    if (half.integrator != "polygon_analytic" && half.integrator != "polygon_area")
      half.settings.emplace_back("integrator.nee=sample");
    half.settings.push_back(fmt::format("integrator.hide_emitters={}", integrator.hide_emitters));
    half.settings.emplace_back(integrator.hidden_emitters == HiddenEmitters::kLookedThrough
                                   ? "integrator.hidden_emitters=looked_through"
                                   : "integrator.hidden_emitters=unlit");
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
