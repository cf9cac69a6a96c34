#include "scenes/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/diagnostic.h"
#include "scenes/names.h"
#include "scenes/setting_rows.h"

namespace penumbra {
namespace {

constexpr std::int64_t kMaxFilmPixels = std::int64_t{1} << 31;

std::vector<Setting> make_table() {
  std::vector<Setting> table;
  add_integrator_rows(table);
  add_sampler_rows(table);
  add_film_rows(table);
  add_camera_rows(table);
  return table;
}

/// Limit on the branches of one camera ray.
constexpr double kMostBranches = 1 << 20;

Expected<void> check_integrator(const IntegratorSettings& integrator) {
  if (const auto* direct = integrator.get<DirectIntegrator>())
    if (direct->emitter_samples == 0 && direct->bsdf_samples == 0)
      return fail("integrator 'direct' needs at least one of emitter_samples and bsdf_samples");
  if (const auto* area = integrator.get<PolygonAreaIntegrator>())
    if (area->emitter_samples == 0) return fail("integrator 'polygon_area' needs emitter_samples");
  const auto sampling = direct_sampling(integrator);
  if (sampling &&
      parameter_or(integrator, PENUMBRA_PARAMETER(next_event), NextEvent::kSample) == NextEvent::kCv) {
    if (*sampling == DirectSampling::kBsdfOnly)
      return fail(
          fmt::format("integrator '{}' with nee = cv samples emitters, which direct_sampling = mats forbids",
                      method_name(integrator.method)));
    if (const auto* path = integrator.get<PathIntegrator>(); path && keeps_parts(*path))
      return fail(
          "integrator 'path' with nee = cv adds closed forms, of which only_bounces and only_technique know "
          "no part; set nee to sample");
  }
  if (const auto* whitted = integrator.get<WhittedIntegrator>()) {
    const int surfaces = whitted->max_depth < 0 ? whitted->branch_depth
                                                : std::min(whitted->branch_depth, whitted->max_depth - 1);
    if (std::pow(double(whitted->indirect_samples), surfaces) > kMostBranches)
      return fail(fmt::format(
          "integrator 'whitted' would branch {} times at each of {} surfaces in a row; a lower branch_depth "
          "than {} would leave that to the first ones",
          whitted->indirect_samples, surfaces, surfaces));
  }
  if (const auto* maps = integrator.get<PhotonMapIntegrator>())
    if (maps->global_photons == 0 && maps->caustic_photons == 0 && maps->volume_photons == 0)
      return fail(
          "integrator 'photonmapper' needs photons; at least one of global_photons, caustic_photons and "
          "volume_photons must be above 0");
  if (const auto* progressive = integrator.get<ProgressivePhotonIntegrator>()) {
    const float alpha = progressive->alpha.value_or(1.0f);
    if (!(alpha > 0.0f && alpha <= 1.0f))
      return fail(fmt::format(
          "integrator 'ppm' with alpha = {}; radii shrink with an alpha above 0 and up to 1, or auto",
          alpha));
  }
  if (const auto* ambient = integrator.get<AmbientOcclusionIntegrator>())
    if (ambient->sampling == OcclusionSampling::kCosine && ambient->weighting == OcclusionWeighting::kUniform)
      return fail(
          "integrator 'ao' with occlusion_weighting = uniform has no finite variance with "
          "occlusion_sampling = cosine; set it to hemisphere");
  return {};
}

}  // namespace

std::span<const Setting> all_settings() {
  static const std::vector<Setting> table = make_table();
  return table;
}

const Setting* find_setting(std::string_view key) {
  const auto settings = all_settings();
  const auto found = std::ranges::find(settings, key, &Setting::key);
  return found == settings.end() ? nullptr : &*found;
}

std::string print_setting(const RenderSettings& settings, std::string_view key) {
  return find_setting(key)->print(settings);
}

Expected<void> apply_setting(RenderSettings& settings, std::string_view key, std::string_view value) {
  const Setting* setting = find_setting(to_snake_case(key));
  if (setting == nullptr) {
    std::vector<std::string> known, without_group;
    for (const Setting& each : all_settings()) {
      known.push_back(each.key);
      if (each.name() == to_snake_case(key)) without_group.push_back(each.key);
    }
    const std::string hint = without_group.empty()
                                 ? suggestion(to_snake_case(key), known)
                                 : fmt::format("; did you mean '{}'?", fmt::join(without_group, "' or '"));
    if (!hint.empty())
      return fail(fmt::format("there is no setting '{}'{} `penumbra settings` lists all", key, hint));
    return fail(fmt::format("there is no setting '{}'; the settings are: {}", key, list_names(known)));
  }
  if (const auto done = setting->apply(settings, value); !done) {
    return fail(fmt::format("setting {}: {}", setting->key, done.error().message));
  }
  return {};
}

Expected<void> check_settings(const RenderSettings& settings) {
  const Film& film = settings.film;
  const bool inside = film.crop_x >= 0 && film.crop_y >= 0 && film.crop_width >= 1 && film.crop_height >= 1 &&
                      std::int64_t{film.crop_x} + film.crop_width <= film.width &&
                      std::int64_t{film.crop_y} + film.crop_height <= film.height;
  if (!inside) {
    return fail(fmt::format("the crop window of {} x {} pixels at ({}, {}) is not inside the film of {} x {}",
                            film.crop_width, film.crop_height, film.crop_x, film.crop_y, film.width,
                            film.height));
  }
  if (std::int64_t{film.crop_width} * film.crop_height > kMaxFilmPixels) {
    return fail(fmt::format("an image of {} x {} pixels is too large: at most {} pixels, {} a side",
                            film.crop_width, film.crop_height, kMaxFilmPixels, kMaxFilmSide));
  }
  if (auto checked = check_camera(settings.camera, settings.film); !checked) return checked;
  return check_integrator(settings.integrator);
}

std::string setting_default(const Setting& setting) {
  if (!setting.print) return "";
  RenderSettings settings;
  for (const IntegratorMethod& method : integrator_methods()) {
    if (setting.belongs_to(settings)) break;
    settings.integrator.method = method;
  }
  std::string text = setting.print(settings);
  const std::string first = text;
  for (const IntegratorMethod& method : integrator_methods()) {
    settings.integrator.method = method;
    if (!setting.belongs_to(settings) || setting.print(settings) == first) continue;
    text += fmt::format("; {}: {}", method_name(method), setting.print(settings));
  }
  return text;
}

std::vector<std::string> integrators_with(const Setting& setting) {
  std::vector<std::string> names;
  if (!setting.is_there) return names;
  for (const IntegratorMethod& method : integrator_methods()) {
    RenderSettings settings;
    settings.integrator.method = method;
    if (setting.belongs_to(settings)) names.emplace_back(method_name(method));
  }
  return names;
}

}  // namespace penumbra
