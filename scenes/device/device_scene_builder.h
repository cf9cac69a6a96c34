// Builds the device scene: the flat arrays that the kernels read.
#pragma once

#include <filesystem>
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
  bool feature_layers = true;  ///< render albedo, normal and depth layers beside the radiance
  bool surface_uv = false;  ///< keep texture coordinates and tangents of all surfaces, even without textures
  std::filesystem::path hierarchy_cache = {};  ///< see HierarchyCache; empty: none
  MatteNames* mattes = nullptr;  ///< if not null, receives the mattes, and the kernels count them
  /// Another frame's device scene, or null. What is equal there need not be made again. The result is the
  /// same, whatever scene it is.
  const DeviceScene* earlier = nullptr;
  /// If not null, receives what moves too irregularly to be blurred exactly, see exposed_motion.
  std::vector<std::string>* warnings = nullptr;
};

/// The centre of the bounding box of what is still, or of everything if all moves. Positions in the device
/// scene are relative to it, so those of what is still are the same in all frames. What moves is at most
/// twice as far away as from the centre of everything, so it loses at most one bit of precision.
glm::dvec3 scene_center(const SceneDescription& scene);

/// Builds the device scene. Positions are in single precision relative to the scene's centre, which is
/// subtracted in double precision. Only the tables and feature bits that the scene needs are present. The
/// result is a pure function of the arguments, byte for byte. Errors: too many primitives for 32-bit offsets;
/// a transform or a vertex that is not finite in float.
Expected<DeviceScene> build_device_scene(const SceneDescription& scene, const DeviceSceneOptions& options);

/// What a scene contains and what was left out of it, as pairs (what, how much) for users.
struct SceneSummary {
  std::vector<std::pair<std::string, std::string>> needs;
  std::vector<std::pair<std::string, std::string>> left_out;
};
SceneSummary summarize(const DeviceScene& scene);

}  // namespace penumbra
