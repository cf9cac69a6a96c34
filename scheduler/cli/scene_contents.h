// What a scene's files hold, in numbers: for `penumbra info`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/device/scene_bounds.h"
#include "scenes/scene_description.h"

namespace penumbra {

struct SceneContents {
  SceneBounds extent;
  std::map<std::string, std::size_t> geometry;  ///< meshes, spheres, …, each counted once
  std::size_t triangles = 0;                    ///< of meshes, each counted once
  std::size_t placed_triangles = 0;             ///< wherever instances place them
  std::size_t instances = 0;                    ///< those within groups counted wherever their groups are
  std::size_t textures = 0, images = 0, media = 0;
  std::uint64_t image_bytes = 0;                                       ///< in memory
  std::map<std::string, std::size_t> lights;                           ///< by kind: "area", "point", …
  std::vector<std::pair<std::filesystem::path, std::uint64_t>> files;  ///< those read, with their bytes
};

/// Errors: as of place_groups.
Expected<SceneContents> contents_of(const SceneDescription& scene);

using NamedTexts = std::vector<std::pair<std::string, std::string>>;
/// Lines for people: name and value, under a heading each.
std::vector<std::pair<std::string, NamedTexts>> contents_text(const SceneContents& contents);
/// Adds to an object: extent, geometry, instances, textures, lights_by_kind, files.
void add_contents(nlohmann::ordered_json& json, const SceneContents& contents);

}  // namespace penumbra
