// Writes media as plugins of Mitsuba's.
#pragma once

#include <filesystem>
#include <vector>

#include "scenes/mitsuba/plugin_writer.h"
#include "scenes/mitsuba/scene_writer.h"

namespace penumbra::mitsuba {

/// Writes the scene's media to `xml`, and the files of their grids, which lie beside `file`, to `files`.
/// Errors: a medium that such a file cannot say.
Expected<void> write_media(const SceneDescription& scene, const std::filesystem::path& file, XmlText& xml,
                           std::vector<SceneFile>& files);

}  // namespace penumbra::mitsuba
