#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "kernels/host/device_scene.h"
#include "kernels/host/text.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/device/scene_inventory.h"

namespace penumbra {
namespace {

int edge_count(const DeviceScene& scene) {
  int edges = 0;
  for (const PolygonCorner& corner : table<PolygonCorner>(scene, scene.header.tables.polygon_corners))
    edges += corner.starts != 0 ? 0 : 1;
  return edges;
}

bool analytic_alone(const SceneHeader& h) {
  return h.integrator.kind == INTEGRATOR_DIRECT && h.integrator.estimator == ESTIMATOR_ALPHA &&
         h.integrator.emitter_samples == 0;
}

int lights_without_form(const DeviceScene& scene) {
  const auto lights = table<Light>(scene, scene.header.tables.lights);
  return int(std::ranges::count_if(lights, [](const Light& light) { return light.polygon < 0; }));
}

int curve_pieces_of(const DeviceScene& scene) {
  return int(std::ranges::count_if(table<Quadric>(scene, scene.header.tables.quadrics),
                                   [](const Quadric& q) { return is_curve_kind(q.kind); }));
}

std::string estimator_text(const SceneHeader& h) {
  switch (h.integrator.estimator) {
    case ESTIMATOR_ALPHA:
      if (analytic_alone(h)) return "closed form alone";
      return h.adjustable.alpha == 0.0f ? "samples alone"
                                        : fmt::format("control variate, alpha {}", h.adjustable.alpha);
    case ESTIMATOR_AUTO:
      return "control variate, alpha fitted for each pixel";
    default:
      return "samples alone";
  }
}

}  // namespace

SceneSummary summarize(const DeviceScene& scene) {
  const SceneHeader& h = scene.header;
  SceneSummary summary;
  const auto needs = [&](const char* what, std::string amount) {
    summary.needs.emplace_back(what, std::move(amount));
  };
  needs("triangles", std::to_string(h.tables.triangles.count));
  const int pieces = curve_pieces_of(scene);
  needs("spheres and disks", std::to_string(h.tables.quadrics.count - pieces));
  if (pieces > 0) needs("pieces of curves", std::to_string(pieces));
  if (h.tables.instances.count > 0)
    needs("instances", fmt::format("{}, of {} groups", h.tables.instances.count, h.tables.groups.count - 1));
  needs("materials", std::to_string(h.tables.materials.count - 1));
  needs("lights", std::to_string(h.tables.lights.count));
  if (h.tables.polygons.count > 0) {
    needs("polygon lights", fmt::format("{}, with {} edges", h.tables.polygons.count, edge_count(scene)));
    needs("estimator", estimator_text(h));
  }
  needs("intersector", h.intersector == INTERSECTOR_EMBREE ? "embree"
                       : (h.features & FEATURE_BVH) != 0u  ? "portable, bounding volume hierarchy"
                                                           : "portable, every primitive tested");
  if (h.integrator.photons != PHOTONS_NONE) {
    const IntegratorParameters& p = h.integrator;
    const int paths = std::max({p.surface_photons, p.caustic_photons, p.volume_photons});
    needs("photon paths", fmt::format("{} for each map", paths));
    needs("photon radii", p.photons == PHOTONS_PROGRESSIVE
                              ? fmt::format("{:.3g}, shrinking", p.surface_radius)
                              : fmt::format("{:.3g}; caustics {:.3g}", p.surface_radius, p.caustic_radius));
  }
  needs("device scene", size_text(double(scene.words.size() * 4 + sizeof h)));
  if (h.dropped_triangles > 0)
    summary.left_out.emplace_back("triangles without area", std::to_string(h.dropped_triangles));
  if (h.duplicate_lights > 0)
    summary.left_out.emplace_back("light triangles that repeat another one",
                                  std::to_string(h.duplicate_lights));
  if (const int others = lights_without_form(scene); analytic_alone(h) && others > 0)
    summary.left_out.emplace_back("lights that are not polygons", std::to_string(others));
  const auto list_uses = [&](std::span<const NamedBit> list, std::uint64_t used) {
    for (const NamedBit& feature : list) {
      auto& part = (used & feature.bit) != 0u ? summary.needs : summary.left_out;
      part.emplace_back("feature", feature.description);
    }
  };
  list_uses(kFeatures, h.features);
  list_uses(kFamilies, h.families);
  return summary;
}

}  // namespace penumbra
