// The settings of a scene by name: the parameters of integrator, sampler, film and camera that a file's text
// or a command line may give, in one table for every format.
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

namespace penumbra {

constexpr std::uint32_t kMaxSamplesPerPixel = std::uint32_t(1) << 31;
constexpr std::uint32_t kMaxSeed = std::numeric_limits<std::uint32_t>::max();

enum class SettingKind { kInteger, kNumber, kBoolean, kText, kNumberOrText };

struct Setting {
  std::string key;   ///< group and name: "film.width"
  SettingKind kind;  ///< what a typed format must give for it
  /// Sets it from text. The error says what is wrong with the value, without the key.
  std::function<Expected<void>(SceneDescription&, std::string_view)> apply;
  std::vector<std::string> choices = {};  ///< the names that it takes; empty: not one of several names
};

/// All of them, in an order in which they may be applied one after the other: kinds before what depends on
/// them, the size of the film before its crop window.
std::span<const Setting> all_settings();

/// The setting of that key (exactly as in the table), or null.
const Setting* find_setting(std::string_view key);

/// "auto", "area", "solid_angle" or "projected".
Expected<EmitterSampling> emitter_sampling_from_name(std::string_view name);
std::string_view emitter_sampling_name(EmitterSampling sampling);

/// Sets `integrator.*`, `sampler.*`, `film.*` or `camera.*`; camelCase and snake_case alike. Errors: an
/// unknown key (lists the known ones, and the nearest), a bad value.
Expected<void> apply_setting(SceneDescription& scene, std::string_view key, std::string_view value);

/// What no single setting can tell: the crop window lies in the film, direct light has samples, near is
/// before far.
Expected<void> check_settings(const SceneDescription& scene);

}  // namespace penumbra
