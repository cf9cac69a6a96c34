#include "scheduler/advise/candidates.h"

#include <algorithm>

#include "scenes/interiors.h"
#include "scenes/settings.h"

namespace penumbra {
namespace {

bool has_media(const SceneDescription& scene) { return !scene.media.empty(); }

/// Whether the integrator shows all light, so that others may take its place.
bool shows_all_light(const IntegratorSettings& integrator) {
  if (const auto* path = integrator.get<PathIntegrator>()) return !keeps_parts(*path);
  return integrator.is<VolpathIntegrator>() || integrator.is<WhittedIntegrator>() || has_photons(integrator);
}

/// What the scene with these settings leaves out of the media inside of surfaces.
std::size_t missing_interiors(SceneDescription& scene, const RenderSettings& settings) {
  const WithSettings changed(scene, settings);
  return interior_warnings(scene).size();
}

}  // namespace

WithSettings::WithSettings(SceneDescription& scene, const RenderSettings& settings)
    : scene_(scene), before_(scene) {
  static_cast<RenderSettings&>(scene_) = settings;
}

WithSettings::~WithSettings() { static_cast<RenderSettings&>(scene_) = before_; }

Expected<RenderSettings> settings_with(const RenderSettings& scene, const SettingValues& values) {
  RenderSettings settings = scene;
  for (const auto& [key, value] : values)
    if (auto applied = apply_setting(settings, key, value); !applied) return std::unexpected(applied.error());
  if (auto checked = check_settings(settings); !checked) return std::unexpected(checked.error());
  return settings;
}

Technique first_candidate(const SceneDescription& scene) {
  const IntegratorSettings& own = scene.integrator;
  if (own.is<WhittedIntegrator>()) return {"path", {{"integrator.type", "path"}}};
  if (has_photons(own)) {
    const char* name = has_media(scene) ? "volpath" : "path";
    return {name, {{"integrator.type", name}}};
  }
  return {integrator_name(own), {}};
}

Technique photon_candidate(SceneDescription& scene, const Technique& first, bool takes_photons) {
  Technique photons{"ppm, caustics only", {{"integrator.type", "ppm"}, {"integrator.caustics_only", "true"}}};
  const auto before = settings_with(scene, first.settings), after = settings_with(scene, photons.settings);
  if (!shows_all_light(scene.integrator))
    photons.not_because = "it shows other light than the scene's integrator";
  else if (!takes_photons)
    photons.not_because = "other options exclude it";
  else if (!after)
    photons.not_because = after.error().message;
  else if (direct_sampling(before->integrator) != DirectSampling::kMis)
    photons.not_because = "the scene chooses how direct light is sampled";
  else if (has_media(scene) && !sees_media(before->integrator))
    photons.not_because = "it shows media that the scene's integrator does not";
  else if (missing_interiors(scene, *after) > missing_interiors(scene, *before))
    photons.not_because = "it does not show light inside of materials";
  return photons;
}

std::vector<Technique> variations(const SceneDescription& scene, const Technique& best) {
  const auto settings = settings_with(scene, best.settings);
  std::vector<Technique> all;
  const auto add = [&](const char* key, const char* value) {
    const Setting* setting = find_setting(key);
    if (!setting->belongs_to(*settings) || setting->print(*settings) == value) return;
    Technique changed = best;
    changed.name += std::string(", ") + setting->name() + " = " + value;
    changed.settings.emplace_back(key, value);
    if (const auto with = settings_with(scene, changed.settings); !with)
      changed.not_because = with.error().message;
    all.push_back(std::move(changed));
  };
  add("integrator.nee", "cv");
  add("integrator.light_choice", "power");
  add("sampler.type", "independent");
  return all;
}

}  // namespace penumbra
