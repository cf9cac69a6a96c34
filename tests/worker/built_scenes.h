// Device scenes built from descriptions, for tests that inspect their tables.
#pragma once

#include <stdexcept>
#include <utility>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scenes/device/device_scene_builder.h"

namespace penumbra {

inline std::vector<Triangle> triangles_of(const DeviceScene& scene) {
  const auto all = table<Triangle>(scene, scene.header.tables.triangles);
  return {all.begin(), all.end()};
}
inline std::vector<Light> lights_of(const DeviceScene& scene) {
  const auto all = table<Light>(scene, scene.header.tables.lights);
  return {all.begin(), all.end()};
}
inline std::vector<Quadric> quadrics_of(const DeviceScene& scene) {
  const auto all = table<Quadric>(scene, scene.header.tables.quadrics);
  return {all.begin(), all.end()};
}

inline DeviceScene build(const SceneDescription& scene, bool layers = true,
                         IntersectorChoice intersector = IntersectorChoice::kPortable) {
  DeviceSceneOptions options;
  options.feature_layers = layers;
  options.intersector = intersector;
  auto built = build_device_scene(scene, options);
  if (!built) throw std::runtime_error(built.error().message);
  return std::move(*built);
}

}  // namespace penumbra
