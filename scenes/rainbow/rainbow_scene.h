// Reads the XML scenes of Rainbow (github.com/slongle/Rainbow), a renderer whose files are Mitsuba's with
// parameters and rules of its own.
#pragma once

#include "scenes/scene_reader.h"

namespace penumbra::rainbow {

/// Whether a file is a scene of Rainbow: a <scene> without <mesh> that has a <mode>, a <hide>, or an
/// integrator with sampleNum and delta.
bool is_scene(const std::filesystem::path& file);

/// Reads such a scene by converting it to the equivalent Mitsuba objects. `options.settings` are not applied
/// here.
Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace penumbra::rainbow
