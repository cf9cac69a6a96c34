// Statistics of a scene's contents, for `penumbra info`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/motion/motion_facts.h"
#include "scenes/scene_bounds.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// How the camera is placed and what it sees, in scene units and degrees.
struct CameraFacts {
  Projection projection = Projection::kPerspective;
  glm::dvec3 position{0.0}, direction{0.0}, up{0.0};  ///< the latter of length 1
  /// Full angles of view across and down the whole film; of an orthographic camera the width and height of
  /// what it sees; 0 for a panorama.
  double across = 0, down = 0;
  double aperture_radius = 0, focus_distance = 0;  ///< radius 0: a pinhole
};
CameraFacts camera_facts(const CameraSettings& camera, const Film& film);

struct SceneContents {
  CameraFacts camera;
  SceneBounds extent;
  std::map<std::string, std::size_t> geometry;  ///< number of meshes, spheres, …, without instancing
  std::size_t triangles = 0;                    ///< triangles in meshes, without instancing
  std::size_t placed_triangles = 0;             ///< triangles including all instances
  std::size_t instances = 0;                    ///< nested instances count once per placement of their group
  std::optional<MotionFacts> motion = {};
  std::size_t textures = 0, images = 0, media = 0, emitting_media = 0;
  std::uint64_t image_bytes = 0;              ///< memory of images
  std::map<std::string, std::size_t> lights;  ///< keyed by kind: "area", "point", …
  /// Files that were read, with their sizes.
  std::vector<std::pair<std::filesystem::path, std::uint64_t>> files;
};

/// Errors: those of place_groups.
Expected<SceneContents> contents_of(const SceneDescription& scene);

using NamedTexts = std::vector<std::pair<std::string, std::string>>;
/// Name and value pairs under headings, for display.
std::vector<std::pair<std::string, NamedTexts>> contents_text(const SceneContents& contents);
/// Adds members to a JSON object: camera, motion if anything moves, extent, geometry, instances, textures,
/// lights_by_kind, files.
void add_contents(nlohmann::ordered_json& json, const SceneContents& contents);

}  // namespace penumbra
