// The settings of a scene by name: the parameters of integrator, sampler, film and camera that a file's text
// or a command line may give, in one table for every format. What prints a setting, lists its values or
// records it reads the same table.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"
#include "scenes/setting_values.h"

namespace penumbra {

constexpr std::uint32_t kMaxSamplesPerPixel = std::uint32_t(1) << 31;
constexpr std::uint32_t kMaxSeed = std::numeric_limits<std::uint32_t>::max();

struct Setting {
  std::string key;          ///< group and name: "film.width"
  SettingKind kind;         ///< what a typed format must give for it
  std::string values;       ///< what is right, in words: "1 to 65536"
  std::string description;  ///< in one line
  /// Sets it from text. The error says what is wrong with the value, without the key.
  std::function<Expected<void>(RenderSettings&, std::string_view)> apply = {};
  /// Its value as text that sets it to the same; empty where it is another way to give other settings.
  std::function<std::string(const RenderSettings&)> print = {};
  /// Whether these settings have it: integrators have parameters of their own. Empty: they always have.
  std::function<bool(const RenderSettings&)> is_there = {};
  /// Whether the image depends on it, where it is there. Empty: it does.
  std::function<bool(const RenderSettings&)> matters = {};
  std::vector<std::string> choices = {};  ///< the names that it takes; empty: not one of several names
  std::string option = {};                ///< the command line's option of the same meaning: "spp"
  bool recorded = false;                  ///< part of a render's record, unlike the view of the scene

  [[nodiscard]] bool belongs_to(const RenderSettings& settings) const {
    return !is_there || is_there(settings);
  }
  /// What it is called on its own: its key without the group.
  [[nodiscard]] std::string name() const { return key.substr(key.find('.') + 1); }
};

/// All of them, in an order in which they may be applied one after the other: kinds before what depends on
/// them, the size of the film before its crop window.
std::span<const Setting> all_settings();

/// The setting of that key (exactly as in the table), or null.
const Setting* find_setting(std::string_view key);

/// The value of a setting that is there, as text: print_setting(scene, "sampler.type") is "sobol".
std::string print_setting(const RenderSettings& settings, std::string_view key);

/// Sets `integrator.*`, `sampler.*`, `film.*` or `camera.*`; camelCase and snake_case alike. Errors: an
/// unknown key (lists the known ones, and the nearest), a bad value, a parameter of another integrator (names
/// those that have it).
Expected<void> apply_setting(RenderSettings& settings, std::string_view key, std::string_view value);

/// What no single setting can tell: the crop window lies in the film, direct light has samples, near is
/// before far.
Expected<void> check_settings(const RenderSettings& settings);

/// The value that it has where nobody sets it, as text; of integrators that have it. Empty: none.
std::string setting_default(const Setting& setting);
/// Names of the integrators that have it; empty: all settings have it.
std::vector<std::string> integrators_with(const Setting& setting);

}  // namespace penumbra
