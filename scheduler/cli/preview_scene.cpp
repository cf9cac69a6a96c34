#include "scheduler/cli/preview_scene.h"

#include <algorithm>

namespace penumbra {
namespace {

bool has_only_polygon_lights(const SceneDescription& scene) {
  return scene.point_lights.empty() && !scene.environment &&
         std::ranges::all_of(scene.shapes, [](const Shape& s) {
           return !s.radiance || std::holds_alternative<Mesh>(s.geometry);
         });
}

/// Whether the integrator estimates direct light, which polygon_cv can as well.
bool is_direct(const IntegratorSettings& integrator, bool was_chosen) {
  switch (integrator.kind) {
    case IntegratorKind::kPolygonAnalytic:
    case IntegratorKind::kPolygonArea:
    case IntegratorKind::kPolygonCv:
      return true;
    case IntegratorKind::kDirect:
      return !was_chosen;
    case IntegratorKind::kPath:
      return false;
  }
  return false;
}

}  // namespace

std::function<void(SceneDescription&)> preview_adjustment(const SceneOptions& options) {
  return [options](SceneDescription& scene) {
    if (!options.spp && scene.sampler.kind != SamplerKind::kStratified) scene.sampler.spp = kPreviewSpp;
    IntegratorSettings& integrator = scene.integrator;
    if (options.no_features || !has_only_polygon_lights(scene) ||
        !is_direct(integrator, options.integrator.has_value()))
      return;
    if (integrator.kind != IntegratorKind::kPolygonCv)
      integrator.vis_samples = std::max(1, integrator.emitter_samples);
    integrator.kind = IntegratorKind::kPolygonCv;
    integrator.estimator = CvEstimator::kCv;
    if (!integrator.alpha) integrator.alpha = 1.0f;
  };
}

}  // namespace penumbra
