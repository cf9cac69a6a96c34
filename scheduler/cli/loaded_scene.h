// A scene as a command needs it: read, overridden by the options, and in the form that the kernels read.
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
  MatteNames mattes;                          ///< with --cryptomatte
  std::map<int, std::string> boundary_names;  ///< see there
  double seconds = 0;                         ///< that it took
  glm::dvec3 center{0.0};                     ///< see scene_center; once it is reduced
};

/// Of the description's shapes polygon_lights_of it remain: meshes and images are in the device scene, and
/// two copies of the largest would take all of the memory.
void reduce(LoadedScene& scene);

/// Reads the scene file and applies the overrides; `-D` and `--set` are the reader's, the others are applied
/// here.
Expected<SceneDescription> read_scene_with_options(const SceneOptions& options);

/// The description in the form that the kernels read; `adjust`, which may be empty, changes it before.
Expected<LoadedScene> load_scene(const SceneOptions& options,
                                 const std::function<void(SceneDescription&)>& adjust = {});

}  // namespace penumbra
