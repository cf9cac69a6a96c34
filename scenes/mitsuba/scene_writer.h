// A scene as a file of Mitsuba 3, in the spelling of its version 3.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

struct SceneFile {
  std::filesystem::path path;
  std::string contents;
};

/// The scene as `file`, the last, and beside it its meshes, as binary PLY files named after it: STEM-0.ply
/// ..., and the grids of its media, STEM-0.vol ... Images are named where they are. What has its default is
/// left out, so that Mitsuba 3 reads whatever it has too; what only Penumbra has is written under its name
/// there. Read again, the scene has the same light, materials and geometry, but for what was left out when it
/// was read. Errors: what a file of Mitsuba cannot say.
Expected<std::vector<SceneFile>> scene_files(const SceneDescription& scene,
                                             const std::filesystem::path& file);

}  // namespace penumbra::mitsuba
