// How many of the public files of pbrt-v4, glTF 2.0 and meshes that the census knows load as they are.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/scenes/census/census.h"
#include "tests/scenes/scene_text.h"
#include "tests/support/measured_writer.h"

namespace penumbra {
namespace {

class FormatsCensus : public SceneText {
 protected:
  void SetUp() override {
    write("image.pfm", census::grey_image());
    write("sky.pfm", census::grey_image(2, 2));
    write("metal.spd", "400 1.5\n700 1\n");
    write("metal.bsdf", measured_fields(strange_formula()).file());
    write(
        "mesh.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  }

  /// The share of files that load, a row standing for as many as its name says: "a.ply *3".
  template <typename Read>
  void expect_share(const std::string& list, std::size_t least_rows, double least_share,
                    const Read& read_row) {
    const auto rows = census::read_rows(std::string(PENUMBRA_SOURCE_DIR) + "/tests/scenes/census/" + list);
    ASSERT_GE(rows.size(), least_rows);
    std::set<std::string> names;
    int files = 0, loaded = 0;
    for (const census::Row& row : rows) {
      SCOPED_TRACE(row.name);
      EXPECT_TRUE(names.insert(row.name).second) << "twice";
      const std::size_t star = row.name.rfind(" *");
      const int count = star == row.name.npos ? 1 : std::stoi(row.name.substr(star + 2));
      std::string text;
      const auto scene = read_row(row, text);
      census::expect_verdict(row, scene, text);
      files += count;
      loaded += scene ? count : 0;
    }
    fmt::print("{}: {} of {} files load ({:.1f} %), of {} kinds\n", list, loaded, files,
               100.0 * loaded / files, rows.size());
    EXPECT_GE(double(loaded) / files, least_share);
  }

  Expected<SceneDescription> read_as(const std::string& name, const std::string& text) {
    write(name, text);
    return read_scene(folder_ / name, {});
  }
};

TEST_F(FormatsCensus, PbrtScenesLoadUnlessTheCensusSaysWhyNot) {
  expect_share("pbrt_scenes.txt", 25, 0.90, [&](const census::Row& row, std::string& text) {
    return read_as("scene.pbrt", text = census::pbrt_text(row));
  });
}

TEST_F(FormatsCensus, GltfScenesLoadUnlessTheCensusSaysWhyNot) {
  expect_share("gltf_scenes.txt", 100, 0.99, [&](const census::Row& row, std::string& text) {
    return read_as("scene.gltf", text = census::gltf_text(row));
  });
}

TEST_F(FormatsCensus, MeshesLoad) {
  expect_share("mesh_scenes.txt", 150, 1.0, [&](const census::Row& row, std::string& text) {
    text = census::mesh_text(row);
    const bool is_obj = row.version == "OBJ";
    write(is_obj ? "facts.obj" : "facts.ply", text);
    return read(scene(fmt::format("<shape type='{0}'><string name='filename' value='facts.{0}'/></shape>",
                                  is_obj ? "obj" : "ply")));
  });
}

}  // namespace
}  // namespace penumbra
