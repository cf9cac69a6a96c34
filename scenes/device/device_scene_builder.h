// From a scene description to the flat arrays that the kernels read.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scenes/device/intersector.h"
#include "scenes/scene_description.h"

namespace penumbra {

struct MatteNames;

struct DeviceSceneOptions {
  IntersectorChoice intersector = IntersectorChoice::kAuto;
  bool feature_layers = true;    ///< albedo, normal and depth beside the radiance
  bool surface_uv = false;       ///< texture coordinates and tangents of surfaces, textures or not
  MatteNames* mattes = nullptr;  ///< null, or where the mattes go, which results then count
};

/// The middle of the scene's bounding box, which the device scene's positions are relative to.
glm::dvec3 scene_center(const SceneDescription& scene);

/// Everything in float about the scene's centre, which is subtracted in double; only the tables and the
/// feature bits that the scene needs. A pure function of its arguments: the same bytes every time. Errors:
/// too many primitives for 32-bit offsets, a transform or a vertex that is not finite in float.
Expected<DeviceScene> build_device_scene(const SceneDescription& scene, const DeviceSceneOptions& options);

/// What a scene needs and what was left out for it, as (what, how much) for people.
struct SceneSummary {
  std::vector<std::pair<std::string, std::string>> needs;
  std::vector<std::pair<std::string, std::string>> left_out;
};
SceneSummary summarize(const DeviceScene& scene);

}  // namespace penumbra
