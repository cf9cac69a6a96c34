#include "scenes/device/integrator_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <climits>
#include <limits>
#include <ranges>

#include "kernels/math/math.h"

namespace penumbra {
namespace {

constexpr int kLatestRoulette = 1024;
// With more polygons, evaluating them at every shading point would cost more than choosing by contribution
// saves.
constexpr std::size_t kMaxContributionPolygons = 256;

static_assert(int(DirectSampling::kMis) == SAMPLING_MIS && int(MisHeuristic::kPower) == HEURISTIC_POWER &&
              int(PathTechnique::kEmitter) == TECHNIQUE_EMITTER &&
              int(BsdfSampling::kUniform) == DIRECTION_UNIFORM &&
              int(IndirectSampling::kUniform) == DIRECTION_UNIFORM &&
              int(OcclusionWeighting::kUniform) == WEIGHTING_UNIFORM);

/// Balancing emitter and BSDF samples needs the density of emitter sampling for every direction. A choice by
/// contribution does not provide it for directions of BSDF samples.
bool balances(const IntegratorSettings& integrator, const LightBuilder& lights) {
  return finds_lights(integrator) && !(control_variate(integrator) && lights.only_polygons());
}

/// Integrators that depend only on geometry, not on lights and materials.
bool is_occlusion(const IntegratorSettings& integrator) {
  return integrator.is<AmbientOcclusionIntegrator>() || integrator.is<ReflectionOcclusionIntegrator>() ||
         integrator.is<NormalsIntegrator>();
}

int kind_of(const IntegratorSettings& integrator) {
  if (direct_sampling(integrator)) return INTEGRATOR_PATH;
  if (integrator.is<WhittedIntegrator>()) return INTEGRATOR_WHITTED;
  return is_occlusion(integrator) ? INTEGRATOR_OCCLUSION : INTEGRATOR_DIRECT;
}

std::uint32_t feature_of(int kind) {
  switch (kind) {
    case INTEGRATOR_PATH:
      return FEATURE_PATH;
    case INTEGRATOR_WHITTED:
      return FEATURE_WHITTED;
    case INTEGRATOR_OCCLUSION:
      return FEATURE_OCCLUSION;
    default:
      return FEATURE_DIRECT;
  }
}

int direction_kind(OcclusionSampling sampling) {
  switch (sampling) {
    case OcclusionSampling::kSphere:
      return DIRECTION_SPHERE;
    case OcclusionSampling::kHemisphere:
      return DIRECTION_UNIFORM;
    default:
      return DIRECTION_COSINE;
  }
}

void set_occlusion(const IntegratorSettings& integrator, double scene_radius, IntegratorParameters& p) {
  if (const auto* ambient = integrator.get<AmbientOcclusionIntegrator>())
    p.bsdf_sampling = direction_kind(ambient->sampling);
  if (integrator.is<ReflectionOcclusionIntegrator>()) p.bsdf_sampling = DIRECTION_LOBE;
  if (integrator.is<NormalsIntegrator>()) {
    p.weighting = WEIGHTING_NORMALS;
    p.background = 0.0f;
  }
  const float length = parameter_or(integrator, PENUMBRA_PARAMETER(ray_length), 0.0f);
  p.ray_length = length > 0 ? length : length < 0 ? float(0.5 * scene_radius) : NO_LIMIT;
}

// Rounding in single precision must not leave a shape outside of the sphere from which infinite lights shine.
constexpr double kEmissionMargin = 1.0001;
constexpr float kBestRadiusAlpha = 2.0f / 3.0f;  // see progressive_radius

void set_photons(const IntegratorSettings& integrator, double scene_radius, IntegratorParameters& p) {
  p.photons = PHOTONS_NONE;
  if (!integrator.is<PhotonMapIntegrator>()) p.gathering = GATHER_FIRST;
  p.emission_radius = std::max(float(kEmissionMargin * scene_radius), std::numeric_limits<float>::min());
  p.samples_per_map = 1;
  if (const auto* fixed = integrator.get<PhotonMapIntegrator>()) {
    const auto radius = [&](float share) {
      return fixed->photon_radius > 0 ? fixed->photon_radius : float(share * scene_radius);
    };
    p.photons = PHOTONS_FIXED;
    p.surface_radius = radius(fixed->global_lookup_radius);
    p.caustic_radius = radius(fixed->caustic_lookup_radius);
    p.volume_radius = radius(fixed->volume_lookup_radius);
    p.radius_alpha = 1.0f;
  }
  if (const auto* progressive = integrator.get<ProgressivePhotonIntegrator>()) {
    p.photons = PHOTONS_PROGRESSIVE;
    p.surface_radius = p.volume_radius = progressive->initial_radius;
    p.radius_alpha = progressive->alpha.value_or(kBestRadiusAlpha);
    p.caustic_photons = 0;
    if (progressive->caustics_only) p.gathering = GATHER_CAUSTICS;
  }
}

void copy_parameters(const IntegratorSettings& integrator, IntegratorParameters& p) {
  for (const IntegratorParameter& parameter : integrator_parameters())
    if (const void* from = parameter.find_in(integrator); from != nullptr && parameter.copy)
      parameter.copy(from, p);
}

void set_parameters(const IntegratorSettings& integrator, double scene_radius, IntegratorParameters& p) {
  // Parameters that the integrator lacks get the default of the first integrator that has them.
  for (const IntegratorMethod& method : integrator_methods() | std::views::reverse)
    copy_parameters({.method = method}, p);
  copy_parameters(integrator, p);
  p.kind = kind_of(integrator);
  if (p.only_bounces >= 0) {
    const int edges = p.only_bounces + 1;  // longer paths contribute nothing
    p.max_depth = p.max_depth < 0 ? edges : std::min(p.max_depth, edges);
  }
  if (p.max_depth < 0) {
    p.max_depth = INT_MAX;
    // Enforces Russian roulette at last; otherwise paths in a closed room of albedo 1 would never end.
    p.rr_depth = std::min(p.rr_depth, kLatestRoulette);
  }
  if (integrator.is<PolygonAnalyticIntegrator>()) p.emitter_samples = 0;
  if (!direct_sampling(integrator) && !integrator.is<DirectIntegrator>() &&
      !integrator.is<WhittedIntegrator>())
    p.bsdf_samples = 0;
  set_photons(integrator, scene_radius, p);
  set_occlusion(integrator, scene_radius, p);
  const bool looked_through = integrator.hidden_emitters == HiddenEmitters::kLookedThrough;
  p.hide_emitters = !integrator.hide_emitters ? HIDE_NOTHING
                    : looked_through          ? HIDE_LOOK_THROUGH
                                              : HIDE_LIGHT;
}

/// Does not use the closed form as estimator; it remains only for the layers.
void use_samples_alone(SceneHeader& h) {
  h.integrator.estimator = (h.features & FEATURE_LAYERS) != 0u ? ESTIMATOR_ALPHA : ESTIMATOR_SAMPLES;
  h.adjustable.alpha = 0.0f;
}

/// If every unshadowed sample equals the closed form, alpha has no effect, and plain samples are the best
/// known estimator. One sequence of samples is then better than two halves that fit each other's alpha.
void set_estimator(const IntegratorSettings& integrator, const LightBuilder& lights, SceneHeader& h) {
  const std::optional<ControlVariate> variate = control_variate(integrator);
  h.integrator.estimator = ESTIMATOR_SAMPLES;
  h.adjustable.alpha = 1.0f;
  if (lights.polygons().empty()) return;
  if (integrator.is<PolygonAnalyticIntegrator>()) {
    h.integrator.estimator = ESTIMATOR_ALPHA;
  } else if (!variate) {
    // A choice by contribution evaluates the closed form anyway, so it is available for the layers.
    if (h.integrator.light_choice == CHOICE_ANALYTIC) use_samples_alone(h);
  } else if (variate->alpha) {
    h.integrator.estimator = ESTIMATOR_ALPHA;
    h.adjustable.alpha = *variate->alpha;
  } else if ((h.families & ~ONLY(DIFFUSE)) == 0u && h.integrator.light_choice == CHOICE_ANALYTIC &&
             lights.constant_if_projected()) {
    use_samples_alone(h);
  } else {
    h.integrator.estimator = ESTIMATOR_AUTO;
  }
}

// Without a radius: this many pixels wide at the scene's distance.
constexpr float kAutomaticRadius = 3.0f;

/// The width of a pixel at the scene's centre; at its radius if the camera is nearer.
float pixel_width(const SceneHeader& h) {
  const float film = 2.0f * length3(h.camera.x) / float(h.film.width);
  if (h.camera.parallel != 0.0f) return film;
  return film * std::max(length3(h.camera.origin), h.integrator.emission_radius);
}

/// Completes the radii, and checks that photons can be emitted.
Expected<void> prepare_photons(const LightBuilder& lights, SceneHeader& h) {
  IntegratorParameters& p = h.integrator;
  const bool lit = std::ranges::any_of(
      lights.lights(), [](const Light& light) { return max_component(light.radiance) > 0.0f; });
  if (!lit) return fail("photon mapping needs a light that is not black");
  const float automatic = kAutomaticRadius * pixel_width(h);
  for (float* radius : {&p.surface_radius, &p.caustic_radius, &p.volume_radius})
    if (!(*radius > 0.0f)) *radius = automatic;
  return {};
}

LightChoice light_choice(const IntegratorSettings& integrator) {
  return parameter_or(integrator, PENUMBRA_PARAMETER(light_choice), LightChoice::kAuto);
}

/// Whether light samples choose among lights for which the hierarchy can be used.
bool chooses_lights(const IntegratorSettings& integrator, const LightBuilder& lights) {
  if (is_occlusion(integrator) || integrator.is<PolygonAnalyticIntegrator>()) return false;
  if (const auto* direct = integrator.get<DirectIntegrator>(); direct && direct->emitter_samples == 0)
    return false;
  // Lights that rays can hit do not count.
  constexpr std::uint32_t kFound = 1u << LIGHT_TRIANGLE | 1u << LIGHT_RECTANGLE | 1u << LIGHT_SPHERE |
                                   1u << LIGHT_DISK | 1u << LIGHT_ENVIRONMENT | 1u << LIGHT_ENVMAP;
  const bool finds_all =
      direct_sampling(integrator) == DirectSampling::kBsdfOnly && (lights.kinds() & ~kFound) == 0u;
  return lights.lights().size() > 1 && !finds_all;
}

}  // namespace

bool wants_polygons(const IntegratorSettings& integrator) {
  return integrator.is<PolygonAnalyticIntegrator>() || control_variate(integrator) ||
         light_choice(integrator) == LightChoice::kAnalytic;
}

bool finds_lights(const IntegratorSettings& integrator) {
  if (const auto* direct = integrator.get<DirectIntegrator>()) return direct->bsdf_samples > 0;
  if (const auto path = direct_sampling(integrator)) return *path != DirectSampling::kEmitterOnly;
  const auto* whitted = integrator.get<WhittedIntegrator>();
  return whitted != nullptr && whitted->indirect_samples > 0;
}

bool light_choice_is_auto(const IntegratorSettings& integrator) {
  return light_choice(integrator) == LightChoice::kAuto;
}

EmitterSampling default_sampling(const IntegratorSettings& integrator, bool narrow) {
  const auto wanted = parameter_or(integrator, PENUMBRA_PARAMETER(emitter_sampling), EmitterSampling::kAuto);
  if (wanted != EmitterSampling::kAuto) return wanted;
  if (integrator.is<PolygonAreaIntegrator>()) return EmitterSampling::kArea;
  // With the closed form as control variate, sampling by solid angle is as good as by projected solid angle
  // in penumbrae and exact elsewhere, at a third of the cost, unless the lobe covers only a part of the
  // light.
  if (!control_variate(integrator)) return EmitterSampling::kAuto;
  return narrow ? EmitterSampling::kProjected : EmitterSampling::kSolidAngle;
}

Expected<void> set_integrator(const IntegratorSettings& integrator, const LightBuilder& lights,
                              double scene_radius, SceneHeader& h) {
  set_parameters(integrator, scene_radius, h.integrator);
  h.features |= feature_of(h.integrator.kind);
  if (h.integrator.photons != PHOTONS_NONE) {
    if (Expected<void> done = prepare_photons(lights, h); !done) return done;
    h.features |= FEATURE_PHOTONS;
  }
  h.integrator.leads_back = (h.features & FEATURE_NESTED) == 0u ? 1 : 0;
  if (const auto* path = integrator.get<PathIntegrator>(); path && keeps_parts(*path))
    h.features |= FEATURE_PARTS;
  const bool some_are_hidden = std::ranges::any_of(
      lights.lights(), [](const Light& light) { return light.unseen == UNSEEN_BY_CAMERA; });
  if (h.integrator.hide_emitters == HIDE_NOTHING && some_are_hidden) h.integrator.hide_emitters = HIDE_MARKED;
  if (h.integrator.hide_emitters == HIDE_LOOK_THROUGH) h.features |= FEATURE_LOOK_THROUGH;

  const LightChoice wanted = light_choice(integrator);
  const bool by_contribution =
      wanted == LightChoice::kAnalytic ||
      (wanted == LightChoice::kAuto && control_variate(integrator) && !balances(integrator, lights) &&
       lights.polygons().size() <= kMaxContributionPolygons);
  h.integrator.light_choice = by_contribution && !lights.polygons().empty() ? CHOICE_ANALYTIC : CHOICE_POWER;
  if (by_contribution && balances(integrator, lights))
    return fail(
        "light_choice = analytic needs an integrator that samples lights alone: direct with bsdf_samples = "
        "0, "
        "path or volpath with direct_sampling = ems, whitted with indirect_samples = 0, polygon_area or "
        "polygon_cv");
  // If closed forms are used to choose lights or as control variates, the hierarchy is not used by default.
  const bool by_tree =
      wanted == LightChoice::kTree || (wanted == LightChoice::kAuto && !wants_polygons(integrator));
  if (by_tree && chooses_lights(integrator, lights)) {
    h.integrator.light_choice = CHOICE_TREE;
    h.features |= FEATURE_LIGHT_TREE;
  }
  set_estimator(integrator, lights, h);
  return {};
}

Expected<void> check_split_light(const IntegratorSettings& integrator, const SceneHeader& header) {
  if ((header.features & (FEATURE_DIRECT_LAYER | FEATURE_INDIRECT_LAYER)) == 0u) return {};
  const std::string_view name = method_name(integrator.method);
  if (header.integrator.kind != INTEGRATOR_PATH || (header.features & FEATURE_PHOTONS) != 0u)
    return fail(fmt::format(
        "film.layers: integrator '{}' does not tell direct from indirect light; path and volpath do", name));
  if (header.integrator.estimator != ESTIMATOR_SAMPLES)
    return fail(
        fmt::format("film.layers: integrator '{}' with closed forms of polygon lights does not tell direct "
                    "from indirect light; set nee to sample and light_choice to auto",
                    name));
  return {};
}

}  // namespace penumbra
