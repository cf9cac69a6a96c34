#include "scheduler/run/preview_scene.h"

#include <algorithm>

namespace penumbra {
namespace {

bool has_cylinder_or_curve(const SceneDescription& scene) {
  return std::ranges::any_of(scene.shapes, [](const Shape& s) {
    return std::holds_alternative<Cylinder>(s.geometry) || std::holds_alternative<Curves>(s.geometry);
  });
}

bool has_only_polygon_lights(const SceneDescription& scene) {
  if (!scene.instances.empty() || has_cylinder_or_curve(scene))
    return false;  // the window does not draw these
  return scene.emitters.empty() && std::ranges::all_of(scene.shapes, [](const Shape& s) {
           return !s.radiance || std::holds_alternative<Mesh>(s.geometry);
         });
}

/// Whether the integrator estimates direct illumination, which polygon_cv can do as well.
bool is_direct(const IntegratorSettings& integrator, bool was_chosen) {
  if (integrator.is<DirectIntegrator>()) return !was_chosen;
  return integrator.is<PolygonAnalyticIntegrator>() || integrator.is<PolygonAreaIntegrator>() ||
         integrator.is<PolygonCvIntegrator>();
}

}  // namespace

std::function<void(SceneDescription&)> preview_adjustment(const SceneOptions& options) {
  return [options](SceneDescription& scene) {
    if (!options.spp && scene.sampler.kind != SamplerKind::kStratified) scene.sampler.spp = kPreviewSpp;
    scene.film.alpha = false;  // no window shows alpha
    IntegratorSettings& integrator = scene.integrator;
    if (options.no_features || !has_only_polygon_lights(scene) ||
        !is_direct(integrator, options.integrator.has_value()))
      return;
    const int samples = parameter_or(integrator, PENUMBRA_PARAMETER(emitter_samples), 1);
    PolygonCvIntegrator cv;
    cv.vis_samples = std::max(1, parameter_or(integrator, PENUMBRA_PARAMETER(vis_samples), samples));
    use_integrator(integrator, cv);
    auto& chosen = std::get<PolygonCvIntegrator>(integrator.method);
    if (!chosen.alpha) chosen.alpha = 1.0f;
  };
}

}  // namespace penumbra
