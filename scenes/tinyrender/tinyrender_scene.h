// Reads TinyRender's scenes: a TOML file with the camera, the film and the renderer, and the OBJ and MTL
// files that it names.
#pragma once

#include "scenes/scene_reader.h"

namespace penumbra::tinyrender {

/// Reads a TinyRender scene. `options.settings` are not applied here.
Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace penumbra::tinyrender
