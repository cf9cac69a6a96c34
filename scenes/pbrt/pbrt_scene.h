// Reads scenes of pbrt-v4.
#pragma once

#include "scenes/scene_reader.h"

namespace penumbra::pbrt {

/// Reads a pbrt scene. `options.settings` are not applied here.
Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace penumbra::pbrt
