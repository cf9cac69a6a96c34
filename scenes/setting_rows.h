// Functions that make the rows of the table of settings, and the parts of that table.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scenes/settings.h"

namespace penumbra {

constexpr int kMaxFilmSide = 65536;

void add_integrator_rows(std::vector<Setting>& table);
void add_sampler_rows(std::vector<Setting>& table);
void add_film_rows(std::vector<Setting>& table);
void add_camera_rows(std::vector<Setting>& table);

/// A setting with the description of its values, but still without the functions that read and write it.
template <typename Values>
Setting setting_of(std::string key, const Values& values, std::string description) {
  Setting setting{.key = std::move(key),
                  .kind = Values::kKind,
                  .values = values.values(),
                  .description = std::move(description)};
  if constexpr (requires { values.names(); }) setting.choices = values.names();
  return setting;
}

/// A setting that is written by store(settings, value) and read by load(settings).
template <typename Values, typename Load, typename Store>
Setting row(std::string key, const Values& values, Load load, Store store, std::string description) {
  Setting setting = setting_of(std::move(key), values, std::move(description));
  setting.apply = [=](RenderSettings& settings, std::string_view text) -> Expected<void> {
    const auto value = values.parse(text);
    if (!value) return std::unexpected(value.error());
    store(settings, *value);
    return {};
  };
  setting.print = [=](const RenderSettings& settings) { return values.print(load(settings)); };
  return setting;
}

/// A setting that is a member of one part of the settings: member_row("sampler.seed", …,
/// &RenderSettings::sampler, &SamplerSettings::seed, …).
template <typename Values, typename Part, typename T>
Setting member_row(std::string key, const Values& values, Part RenderSettings::*part, T Part::*member,
                   std::string description) {
  return row(
      std::move(key), values, [=](const RenderSettings& s) { return s.*part.*member; },
      [=](RenderSettings& s, auto value) { s.*part.*member = T(value); }, std::move(description));
}

}  // namespace penumbra
