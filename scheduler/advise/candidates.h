// What `--integrator auto` chooses from: settings that change noise and work, but not the image that a render
// converges to.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// Keys and values of settings (scenes/settings.h), in an order in which they may be applied.
using SettingValues = std::vector<std::pair<std::string, std::string>>;

struct Technique {
  std::string name;  ///< for users: "ppm, caustics only"
  SettingValues settings;
  std::string not_because = {};  ///< why it cannot be compared; empty: it can
};

/// The scene's own settings: `path` and `volpath` stay as they are; where a scene's integrator shows the same
/// light by other means, the first of these replaces it. Media that the scene's integrator does not see stay
/// unseen. Integrators that show something else, such as `ao`, keep their name.
Technique first_candidate(const SceneDescription& scene);

/// Photons for caustics; the scene is as before when it returns. Its `not_because` says where it would show
/// another image. `takes_photons`: whether the render allows an integrator with photons.
Technique photon_candidate(SceneDescription& scene, const Technique& first, bool takes_photons);

/// Single changes of what was found best so far.
std::vector<Technique> variations(const SceneDescription& scene, const Technique& best);

/// The scene's settings with those of the candidate. Errors: a setting that the integrator lacks, or
/// settings that exclude each other.
Expected<RenderSettings> settings_with(const RenderSettings& scene, const SettingValues& values);

/// Gives a scene other settings while it lives; a copy of a large scene would be slow.
class WithSettings {
 public:
  WithSettings(SceneDescription& scene, const RenderSettings& settings);
  ~WithSettings();
  WithSettings(const WithSettings&) = delete;
  WithSettings& operator=(const WithSettings&) = delete;

 private:
  SceneDescription& scene_;
  RenderSettings before_;
};

}  // namespace penumbra
