// The settings of a scene by name: the parameters of integrator, sampler, film and camera that a scene file
// or a command line may set. There is one table for all formats. The code that prints, lists and records
// settings uses the same table.
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
  SettingKind kind;         ///< the type that a typed format must use
  std::string values;       ///< the accepted values in words: "1 to 65536"
  std::string description;  ///< one line
  /// Sets the value from text. The error says what is wrong with the value, without the key.
  std::function<Expected<void>(RenderSettings&, std::string_view)> apply = {};
  /// The value as text that apply() accepts. Empty if this setting is only another way to set other settings.
  std::function<std::string(const RenderSettings&)> print = {};
  /// Whether the setting exists for these settings: each integrator has its own parameters. Empty: it always
  /// exists.
  std::function<bool(const RenderSettings&)> is_there = {};
  /// Whether the image depends on an existing setting. Empty: it does.
  std::function<bool(const RenderSettings&)> matters = {};
  /// The accepted names, also of a list of names; empty: the value is neither.
  std::vector<std::string> choices = {};
  std::string option = {};  ///< the equivalent option of the command line: "spp"
  bool recorded = false;    ///< stored in a render's record; settings of the camera are not

  [[nodiscard]] bool belongs_to(const RenderSettings& settings) const {
    return !is_there || is_there(settings);
  }
  /// The key without the group.
  [[nodiscard]] std::string name() const { return key.substr(key.find('.') + 1); }
};

/// All settings, in an order in which they may be applied one after the other: a type comes before the
/// parameters that depend on it, and the film's size before its crop window.
std::span<const Setting> all_settings();

/// The setting with exactly that key, or null.
const Setting* find_setting(std::string_view key);

/// The value of an existing setting as text: print_setting(scene, "sampler.type") is "sobol".
std::string print_setting(const RenderSettings& settings, std::string_view key);

/// Sets `integrator.*`, `sampler.*`, `film.*` or `camera.*`. Names may be in camelCase or snake_case. Errors:
/// an unknown key (the message lists the known keys and suggests the nearest), an invalid value, a parameter
/// of another integrator (the message names the integrators that have it).
Expected<void> apply_setting(RenderSettings& settings, std::string_view key, std::string_view value);

/// Checks that involve several settings: the crop window lies in the film, direct illumination has samples,
/// near_clip is below far_clip.
Expected<void> check_settings(const RenderSettings& settings);

/// The default value as text, of the first integrator that has the setting, then those that differ. Empty:
/// there is none.
std::string setting_default(const Setting& setting);
/// The names of the integrators that have the setting. Empty: the setting belongs to no particular
/// integrator.
std::vector<std::string> integrators_with(const Setting& setting);

}  // namespace penumbra
