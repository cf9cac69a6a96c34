// Mitsuba's XML scene format, versions 0.4 to 3.
#pragma once

#include "scenes/scene_reader.h"

namespace penumbra::mitsuba {

/// Reads a Mitsuba XML scene. `options.settings` are not applied here.
Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace penumbra::mitsuba
