// Scenes of pbrt-v4.
#pragma once

#include "scenes/scene_reader.h"

namespace penumbra::pbrt {

/// Reads a pbrt scene, all but `options.settings`.
Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace penumbra::pbrt
