// A scene loaded for a command: the description with the options applied, and the device scene.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "kernels/host/device_scene.h"
#include "kernels/host/error.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/matte_names.h"
#include "scenes/scene_description.h"
#include "scheduler/cli/render_options.h"

namespace penumbra {

struct LoadedScene {
  SceneDescription description;
  DeviceScene device;
  SceneSummary summary;
  MatteNames mattes;                          ///< only with --cryptomatte
  std::map<int, std::string> boundary_names;  ///< see boundary_names()
  std::uint32_t asked_spp = 0;    ///< samples per pixel before a preview changed them; 0: it did not
  bool sampler_replaced = false;  ///< the scene's independent sampler, by sobol
  double seconds = 0;             ///< load time
  glm::dvec3 center{0.0};         ///< see scene_center; set by load_scene
};

/// Frees the description's shapes except polygon_lights_of it. Meshes and images are also in the device
/// scene, and two copies of the largest scenes would not fit into memory.
void reduce(LoadedScene& scene);

/// Reads the scene file and applies the options. The reader applies `-D` and `--set`; the others are applied
/// here.
Expected<SceneDescription> read_scene_with_options(const SceneOptions& options);

/// Reads the scene and builds its device scene. `adjust`, which may be empty, changes the description before.
Expected<LoadedScene> load_scene(const SceneOptions& options,
                                 const std::function<void(SceneDescription&)>& adjust = {});

}  // namespace penumbra
