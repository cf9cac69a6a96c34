// Facts about public scenes, and tiny scenes made from them: see the lists beside this.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenes/scene_reader.h"

namespace penumbra::census {

/// Of nori_scenes.txt `version` is the dialect, and `fork` says where nothing tells it.
struct Row {
  std::string name, version;
  std::string fork;     ///< what a research fork has added; empty: none
  std::string verdict;  ///< "loads", or what the error names
  std::string items;    ///< fragments filled in
};

/// Whether the row's scene loads or fails as it says, which is a failure of the test where not.
void expect_verdict(const Row& row, const Expected<SceneDescription>& scene, const std::string& text);

/// `image.pfm`: grey.
std::string grey_image(int width = 4, int height = 2);

/// The rows of the file; an empty list, and a failure of the test, for one that is not of the form.
std::vector<Row> read_rows(const std::filesystem::path& file);

/// A scene with each of the row's plugins and parameters, whose files are `mesh.obj`, `mesh.ply`,
/// `mesh.serialized`, `curve.txt`, `grid.vol`, `smoke.vol` and `image.pfm` beside it.
std::string scene_text(const Row& row);
/// The same of a row of Nori's.
std::string nori_text(const Row& row);
/// Of pbrt's, with `mesh.ply`, `image.pfm`, `sky.pfm` (square) and `metal.spd` beside it.
std::string pbrt_text(const Row& row);
/// Of glTF's, which stands alone.
std::string gltf_text(const Row& row);
/// Of meshes: a file of the row's version, OBJ or PLY.
std::string mesh_text(const Row& row);

}  // namespace penumbra::census
