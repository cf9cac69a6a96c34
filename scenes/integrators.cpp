#include "scenes/integrators.h"

#include <string_view>
#include <utility>

namespace penumbra {
namespace {

template <typename Method>
void add_names(std::vector<std::pair<const char*, IntegratorMethod>>& names) {
  names.emplace_back(Method::kName, Method{});
  if constexpr (requires { Method::kPresets; }) {
    for (const auto& [name, direct_sampling] : Method::kPresets) {
      if (name == std::string_view(Method::kName)) continue;
      Method preset;
      preset.direct_sampling = direct_sampling;
      names.emplace_back(name, preset);
    }
  }
  if constexpr (requires { Method::kAliases; })
    for (const char* alias : Method::kAliases) names.emplace_back(alias, Method{});
}

template <std::size_t... I>
std::vector<IntegratorMethod> all_methods(std::index_sequence<I...>) {
  return {std::variant_alternative_t<I, IntegratorMethod>{}...};
}

}  // namespace

std::vector<IntegratorMethod> integrator_methods() {
  return all_methods(std::make_index_sequence<std::variant_size_v<IntegratorMethod>>());
}

const char* method_name(const IntegratorMethod& method) {
  return std::visit([]<typename Method>(const Method&) { return Method::kName; }, method);
}

std::vector<std::pair<const char*, IntegratorMethod>> integrator_names() {
  std::vector<std::pair<const char*, IntegratorMethod>> names;
  for (const IntegratorMethod& each : integrator_methods())
    std::visit([&]<typename Method>(const Method&) { add_names<Method>(names); }, each);
  return names;
}

const char* integrator_name(const IntegratorSettings& integrator) {
  return std::visit(
      []<typename Method>(const Method& method) {
        if constexpr (requires { Method::kPresets; }) {
          for (const auto& [name, direct_sampling] : Method::kPresets)
            if (direct_sampling == method.direct_sampling) return name;
        }
        return Method::kName;
      },
      integrator.method);
}

namespace {
/// Whether rr_depth is the integrator's default, as far as it has one.
bool has_default_roulette(const IntegratorSettings& integrator) {
  const IntegratorMethod fresh = std::visit(
      []<typename Method>(const Method&) { return IntegratorMethod(Method{}); }, integrator.method);
  return parameter_or(integrator, PENUMBRA_PARAMETER(rr_depth), 0) ==
         parameter_or(IntegratorSettings{.method = fresh}, PENUMBRA_PARAMETER(rr_depth), 0);
}
}  // namespace

void use_integrator(IntegratorSettings& integrator, IntegratorMethod method) {
  IntegratorSettings next{method, integrator.hide_emitters, integrator.hidden_emitters};
  for (const IntegratorParameter& parameter : integrator_parameters()) {
    void* to = parameter.find(next);
    const void* from = parameter.find_in(integrator);
    if (to != nullptr && from != nullptr) parameter.format.assign(to, from);
  }
  if (const auto preset = direct_sampling({.method = method}))
    with_parameter(next, PENUMBRA_PARAMETER(direct_sampling), [&](DirectSampling& own) { own = *preset; });
  const auto renew = [&, fresh = IntegratorSettings{.method = method}](const auto& parameter) {
    with_parameter(next, parameter, [&](auto& own) {
      with_parameter(fresh, parameter, [&](const auto& given) { own = given; });
    });
  };
  // The alphas of control variates and of shrinking radii are different quantities.
  if (has_photons(next) != has_photons(integrator)) renew(PENUMBRA_PARAMETER(alpha));
  if (has_default_roulette(integrator)) renew(PENUMBRA_PARAMETER(rr_depth));
  integrator = next;
}

std::optional<DirectSampling> direct_sampling(const IntegratorSettings& integrator) {
  std::optional<DirectSampling> sampling;
  if (has_photons(integrator)) sampling = DirectSampling::kMis;
  with_parameter(integrator, PENUMBRA_PARAMETER(direct_sampling),
                 [&](DirectSampling own) { sampling = own; });
  return sampling;
}

bool has_photons(const IntegratorSettings& integrator) {
  return integrator.is<PhotonMapIntegrator>() || integrator.is<ProgressivePhotonIntegrator>();
}

bool sees_media(const IntegratorSettings& integrator) {
  return integrator.is<VolpathIntegrator>() || has_photons(integrator);
}

bool sees_interiors(const IntegratorSettings& integrator) {
  return integrator.is<PathIntegrator>() || integrator.is<VolpathIntegrator>();
}

std::optional<ControlVariate> control_variate(const IntegratorSettings& integrator) {
  if (const auto* cv = integrator.get<PolygonCvIntegrator>()) return ControlVariate{cv->alpha};
  return std::visit(
      []<typename Method>(const Method& method) -> std::optional<ControlVariate> {
        if constexpr (requires { method.next_event; })
          if (method.next_event == NextEvent::kCv) return ControlVariate{method.alpha};
        return std::nullopt;
      },
      integrator.method);
}

}  // namespace penumbra
