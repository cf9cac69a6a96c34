#include "scenes/device/integrator_builder.h"

#include <algorithm>
#include <climits>

namespace penumbra {
namespace {

constexpr int kLatestRoulette = 1024;
// Evaluating more polygons at every shading point would cost more than a choice by contribution saves.
constexpr std::size_t kMaxContributionPolygons = 256;

static_assert(int(SamplerKind::kSobol) == SAMPLER_SOBOL && int(DirectSampling::kMis) == SAMPLING_MIS &&
              int(MisHeuristic::kPower) == HEURISTIC_POWER &&
              int(BsdfSampling::kUniform) == DIRECTION_UNIFORM);

/// The balance of emitter and direction samples needs the density of every direction, which a choice by
/// contribution does not provide for directions of other samples.
bool balances(const IntegratorSettings& integrator, const LightBuilder& lights) {
  switch (integrator.kind) {
    case IntegratorKind::kDirect:
      return integrator.bsdf_samples > 0;
    case IntegratorKind::kPath:
      return integrator.direct_sampling != DirectSampling::kEmitterOnly &&
             !(integrator.next_event == NextEvent::kCv && lights.only_polygons());
    case IntegratorKind::kPolygonAnalytic:
    case IntegratorKind::kPolygonArea:
    case IntegratorKind::kPolygonCv:
      return false;
  }
  return true;
}

void set_samples(const IntegratorSettings& integrator, SceneHeader& h) {
  switch (integrator.kind) {
    case IntegratorKind::kPolygonAnalytic:
      h.integrator.emitter_samples = h.integrator.bsdf_samples = 0;
      return;
    case IntegratorKind::kPolygonCv:
      h.integrator.emitter_samples = integrator.vis_samples;
      h.integrator.bsdf_samples = 0;
      return;
    case IntegratorKind::kPolygonArea:
      h.integrator.emitter_samples = integrator.emitter_samples;
      h.integrator.bsdf_samples = 0;
      return;
    case IntegratorKind::kDirect:
    case IntegratorKind::kPath:
      h.integrator.emitter_samples = integrator.emitter_samples;
      h.integrator.bsdf_samples = integrator.bsdf_samples;
  }
}

/// The closed form is then of interest for the layers only.
void use_samples_alone(SceneHeader& h) {
  h.integrator.estimator = (h.features & FEATURE_LAYERS) != 0u ? ESTIMATOR_ALPHA : ESTIMATOR_SAMPLES;
  h.adjustable.alpha = 0.0f;
}

/// Where every sample without shadows is the closed form itself, no alpha changes anything, and plain samples
/// are the best estimate known: one sequence of samples is then better than the two halves that fit each
/// other's alpha.
void set_estimator(const SceneDescription& scene, const LightBuilder& lights, SceneHeader& h) {
  const IntegratorSettings& integrator = scene.integrator;
  h.integrator.estimator = ESTIMATOR_SAMPLES;
  h.adjustable.alpha = 1.0f;
  if (lights.polygons().empty()) return;
  if (integrator.kind == IntegratorKind::kPolygonAnalytic) {
    h.integrator.estimator = ESTIMATOR_ALPHA;
  } else if (!has_control_variate(integrator)) {
    // A choice by contribution evaluates the closed form, so the layers show it.
    if (h.integrator.light_choice == CHOICE_ANALYTIC) use_samples_alone(h);
  } else if (integrator.estimator == CvEstimator::kRatio) {
    h.integrator.estimator = ESTIMATOR_RATIO;
    h.features |= FEATURE_RATIO;
  } else if (integrator.alpha) {
    h.integrator.estimator = ESTIMATOR_ALPHA;
    h.adjustable.alpha = *integrator.alpha;
  } else if ((h.families & ~(1u << FAMILY_DIFFUSE)) == 0u && h.integrator.light_choice == CHOICE_ANALYTIC &&
             lights.constant_if_projected()) {
    use_samples_alone(h);
  } else {
    h.integrator.estimator = ESTIMATOR_AUTO;
  }
}

}  // namespace

bool wants_polygons(const IntegratorSettings& integrator) {
  return integrator.kind == IntegratorKind::kPolygonAnalytic || has_control_variate(integrator) ||
         integrator.light_choice == LightChoice::kAnalytic;
}

EmitterSampling default_sampling(const IntegratorSettings& integrator) {
  if (integrator.emitter_sampling != EmitterSampling::kAuto) return integrator.emitter_sampling;
  if (integrator.kind == IntegratorKind::kPolygonArea) return EmitterSampling::kArea;
  // With the closed form beside it, sampling by solid angle is as good as by projected solid angle in
  // penumbrae and exact elsewhere, at a third of the cost.
  return has_control_variate(integrator) ? EmitterSampling::kSolidAngle : EmitterSampling::kAuto;
}

Expected<void> set_integrator(const SceneDescription& scene, const LightBuilder& lights, SceneHeader& h) {
  const IntegratorSettings& integrator = scene.integrator;
  const bool path = integrator.kind == IntegratorKind::kPath;
  h.integrator.kind = path ? INTEGRATOR_PATH : INTEGRATOR_DIRECT;
  h.features |= path ? FEATURE_PATH : FEATURE_DIRECT;
  h.integrator.max_depth = integrator.max_depth < 0 ? INT_MAX : integrator.max_depth;
  // A path that nothing else ends meets roulette at last, or albedo 1 in a closed room would never end.
  h.integrator.rr_depth =
      integrator.max_depth < 0 ? std::min(integrator.rr_depth, kLatestRoulette) : integrator.rr_depth;
  h.integrator.direct_sampling = int(integrator.direct_sampling);
  set_samples(integrator, h);
  h.integrator.bsdf_sampling = int(integrator.bsdf_sampling);
  h.integrator.heuristic = int(integrator.heuristic);
  const bool looked_through = integrator.hidden_emitters == HiddenEmitters::kLookedThrough;
  h.integrator.hide_emitters = !integrator.hide_emitters ? HIDE_NOTHING
                               : looked_through          ? HIDE_LOOK_THROUGH
                                                         : HIDE_LIGHT;
  if (h.integrator.hide_emitters == HIDE_LOOK_THROUGH) h.features |= FEATURE_LOOK_THROUGH;
  const bool can_trace =
      integrator.kind == IntegratorKind::kDirect || integrator.kind == IntegratorKind::kPolygonArea;
  h.integrator.trace_shadows = can_trace && !integrator.trace_shadows ? 0 : 1;

  const bool by_contribution =
      integrator.light_choice == LightChoice::kAnalytic ||
      (integrator.light_choice == LightChoice::kAuto && has_control_variate(integrator) &&
       !balances(integrator, lights) && lights.polygons().size() <= kMaxContributionPolygons);
  h.integrator.light_choice = by_contribution && !lights.polygons().empty() ? CHOICE_ANALYTIC : CHOICE_POWER;
  if (by_contribution && balances(integrator, lights))
    return fail(
        "light_choice = analytic needs an integrator that samples lights alone: direct with bsdf_samples = "
        "0, "
        "path with direct_sampling = ems, polygon_area or polygon_cv");
  set_estimator(scene, lights, h);
  return {};
}

}  // namespace penumbra
