// A scene as a command needs it: read, overridden by the options, and in the form that the kernels read.
#pragma once

#include <functional>

#include "kernels/host/device_scene.h"
#include "kernels/host/error.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/scene_description.h"
#include "scheduler/cli/render_options.h"

namespace penumbra {

struct LoadedScene {
  SceneDescription description;
  DeviceScene device;
  SceneSummary summary;
  double seconds = 0;  ///< that it took
};

/// Reads the scene file and applies the overrides; `-D` and `--set` are the reader's, the others are applied
/// here.
Expected<SceneDescription> read_scene_with_options(const SceneOptions& options);

/// The description in the form that the kernels read; `adjust`, which may be empty, changes it before.
Expected<LoadedScene> load_scene(const SceneOptions& options,
                                 const std::function<void(SceneDescription&)>& adjust = {});

}  // namespace penumbra
