// Writes a scene as a file for Mitsuba 3.
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

/// The files of a scene: the grids of its media, STEM-0.vol ..., and its meshes as binary PLY files,
/// STEM-0.ply ..., and last the scene file itself, `file`, after which they are named. Images are referred to
/// where they are. Parameters with default values are left out, so that Mitsuba 3 accepts the file as far as
/// it supports the scene's features. Features that only Penumbra has are written with their names here;
/// `refused`, if given, gets a sentence for each of them,
/// and for what is approximate.
/// What moves has keys as in Mitsuba 0.6, and the shutter opens and closes as exposure_of says. Numbers with
/// keys and meshes that deform are as at the time that the scene shows. Reading the file again gives a scene
/// with the same light, materials and geometry, except for what was left out when the original was read.
/// Errors: features that a Mitsuba file cannot represent.
Expected<std::vector<SceneFile>> scene_files(const SceneDescription& scene, const std::filesystem::path& file,
                                             std::vector<std::string>* refused = nullptr);

}  // namespace penumbra::mitsuba
