// Writes a scene into a test's folder as a Mitsuba 3 file.
#pragma once

#include "scenes/mitsuba/scene_writer.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {

inline Expected<void> write_scene(const SceneDescription& scene, const std::filesystem::path& path) {
  const auto files = mitsuba::scene_files(scene, path);
  if (!files) return std::unexpected(files.error());
  for (const mitsuba::SceneFile& file : *files) write_text(file.path, file.contents);
  return {};
}

}  // namespace penumbra
