// glTF 2.0 scenes, .gltf and .glb.
#pragma once

#include "scenes/scene_reader.h"

namespace penumbra::gltf {

/// Reads a glTF scene. `options.settings` are not applied here.
Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace penumbra::gltf
