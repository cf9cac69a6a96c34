// The integrators' part of the table of settings, from the rows of integrators.h.
#include <fmt/format.h>

#include "scenes/diagnostic.h"
#include "scenes/setting_rows.h"

namespace penumbra {
namespace {

/// `is_owner`: whether given integrator settings have the parameter.
template <typename IsOwner>
std::unexpected<Error> not_a_parameter(const IntegratorSettings& integrator, const char* name,
                                       const IsOwner& is_owner) {
  std::vector<std::string> owners;
  for (const IntegratorMethod& method : integrator_methods())
    if (is_owner(IntegratorSettings{.method = method})) owners.emplace_back(method_name(method));
  return fail(fmt::format("integrator '{}' has no parameter '{}'; these have: {}",
                          method_name(integrator.method), name, list_names(owners)));
}

template <typename Values, typename Parameter>
Setting parameter_row(const char* name, const Parameter& parameter, const Values& values,
                      const char* description) {
  Setting setting = setting_of(fmt::format("integrator.{}", name), values, description);
  setting.apply = [=](RenderSettings& settings, std::string_view text) -> Expected<void> {
    const auto value = values.parse(text);
    if (!value) return std::unexpected(value.error());
    const auto set = [&]<typename T>(T& member) { member = T(*value); };
    if (with_parameter(settings.integrator, parameter, set)) return {};
    return not_a_parameter(settings.integrator, name, [&](const IntegratorSettings& other) {
      return with_parameter(other, parameter, [](const auto&) {});
    });
  };
  setting.print = [=](const RenderSettings& settings) {
    std::string text;
    with_parameter(settings.integrator, parameter, [&](const auto& member) { text = values.print(member); });
    return text;
  };
  if constexpr (!std::is_invocable_v<const Parameter&, IntegratorSettings&>) {
    setting.is_there = [=](const RenderSettings& settings) {
      return with_parameter(settings.integrator, parameter, [](const auto&) {});
    };
  }
  setting.recorded = true;
  return setting;
}

Setting type_row() {
  std::vector<std::string> names;
  for (const auto& [name, method] : integrator_names()) names.emplace_back(name);
  Setting setting{
      .key = "integrator.type",
      .kind = SettingKind::kText,
      .values = list_names(names),
      .description = "integrator; path is path_mis; parameters that the one before has as well are kept",
      .choices = names,
      .option = "integrator",
      .recorded = true};
  setting.apply = [names](RenderSettings& settings, std::string_view text) -> Expected<void> {
    const auto index = parse_name(text, names);
    if (!index) return std::unexpected(index.error());
    use_integrator(settings.integrator, integrator_names()[*index].second);
    return {};
  };
  setting.print = [](const RenderSettings& settings) {
    return std::string(integrator_name(settings.integrator));
  };
  return setting;
}

/// Mitsuba's single name for both numbers of samples, and for those of its ambient occlusion.
Setting shading_samples_row() {
  const WholeNumber values{1, MAX_DIRECT_SAMPLES};
  Setting setting = setting_of("integrator.shading_samples", values,
                               "emitter_samples and bsdf_samples at once; vis_samples of ao");
  const auto is_owner = [](const IntegratorSettings& integrator) {
    return integrator.is<DirectIntegrator>() || integrator.is<AmbientOcclusionIntegrator>();
  };
  setting.is_there = [=](const RenderSettings& settings) { return is_owner(settings.integrator); };
  setting.apply = [=](RenderSettings& settings, std::string_view text) -> Expected<void> {
    const auto value = values.parse(text);
    if (!value) return std::unexpected(value.error());
    if (auto* ambient = std::get_if<AmbientOcclusionIntegrator>(&settings.integrator.method)) {
      ambient->vis_samples = int(*value);
      return {};
    }
    auto* direct = std::get_if<DirectIntegrator>(&settings.integrator.method);
    if (direct == nullptr) return not_a_parameter(settings.integrator, "shading_samples", is_owner);
    direct->emitter_samples = direct->bsdf_samples = int(*value);
    return {};
  };
  return setting;
}

/// Marks settings that have an effect only with certain values of others.
void set_dependencies(std::vector<Setting>& table) {
  for (Setting& setting : table) {
    if (setting.key == "integrator.alpha")
      setting.matters = [](const RenderSettings& s) {
        return control_variate(s.integrator) || s.integrator.is<ProgressivePhotonIntegrator>();
      };
    if (setting.key == "integrator.hidden_emitters")
      setting.matters = [](const RenderSettings& s) { return s.integrator.hide_emitters; };
  }
}

}  // namespace

void add_integrator_rows(std::vector<Setting>& table) {
  table.push_back(type_row());
  table.push_back(shading_samples_row());
  integrator_parameters(
      [&](const char* name, const auto& parameter, const auto& values, const char* description, auto...) {
        table.push_back(parameter_row(name, parameter, values, description));
      });
  set_dependencies(table);
}

}  // namespace penumbra
