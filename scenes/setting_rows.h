// Functions that make the rows of the table of settings, and the parts of that table.
#pragma once

#include <functional>
#include <string>
#include <type_traits>
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
Setting setting_of(std::string key, const ValueFormat& format, std::string description);

/// A setting that is stored at place(settings).
Setting stored_row(std::string key, ValueFormat format, std::function<void*(RenderSettings&)> place,
                   std::string description);

/// A setting that is written by store(settings, value) and read by load(settings).
template <typename Values, typename Load, typename Store>
Setting row(std::string key, const Values& values, Load load, Store store, std::string description) {
  using T = std::decay_t<decltype(load(RenderSettings{}))>;
  const ValueFormat format = format_of<T>(values);
  Setting setting = setting_of(std::move(key), format, std::move(description));
  setting.apply = [=](RenderSettings& settings, std::string_view text) -> Expected<void> {
    T value;
    if (const Expected<void> done = format.read(text, &value); !done) return done;
    store(settings, value);
    return {};
  };
  setting.print = [=](const RenderSettings& settings) {
    const T value = load(settings);
    return format.print(&value);
  };
  return setting;
}

/// A setting that is a member of one part of the settings: member_row("sampler.seed", …,
/// &RenderSettings::sampler, &SamplerSettings::seed, …).
template <typename Values, typename Part, typename T>
Setting member_row(std::string key, const Values& values, Part RenderSettings::*part, T Part::*member,
                   std::string description) {
  return stored_row(
      std::move(key), format_of<T>(values),
      [part, member](RenderSettings& s) -> void* { return &(s.*part.*member); }, std::move(description));
}

}  // namespace penumbra
