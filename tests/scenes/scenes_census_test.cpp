// How many of the known public scenes load unedited.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/scenes/census/census.h"
#include "tests/scenes/scene_text.h"
#include "tests/scenes/sdf_writer.h"
#include "tests/scenes/serialized_writer.h"

namespace penumbra {
namespace {

class ScenesCensus : public SceneText {
 protected:
  void SetUp() override {
    write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    write("mesh.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
          "property float r\nproperty float g\nproperty float b\nelement face 1\nproperty list uchar int "
          "vertex_indices\nproperty float r\nproperty float g\nproperty float b\nend_header\n"
          "0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 0 0 1\n3 0 1 2 1 0 0\n");
    SerializedWriter serialized(4);
    serialized.add(serialized_square(0), {});
    write("mesh.serialized", serialized.file());
    write("curve.txt", "0 0 0 0.1\n1 0 0 0.1\n2 1 0 0.1\n3 1 0 0.1\n");
    write("grid.vol", sdf_file(ball_of_distances(6, 0.3)));
    write("smoke.vol", vol_of({2, 1, 2, 1, {0.0f, 0.5f, 1.0f, 0.25f}}));
    write("image.pfm", census::grey_image());
  }
};

/// With it all of them do.
TEST_F(ScenesCensus, ScenesLoadWithoutLeniencyUnlessTheCensusSaysWhyNot) {
  const auto rows =
      census::read_rows(std::string(PENUMBRA_SOURCE_DIR) + "/tests/scenes/census/mitsuba_scenes.txt");
  ASSERT_GE(rows.size(), 100u);
  std::set<std::string> names;
  int published = 0, published_loaded = 0, loaded = 0;
  for (const census::Row& row : rows) {
    SCOPED_TRACE(row.name);
    EXPECT_TRUE(names.insert(row.name).second) << "twice";
    const std::string text = census::scene_text(row);
    const auto scene = read(text);
    census::expect_verdict(row, scene, text);
    if (!scene) {
      const auto lenient = read(text, {.lenient = true});
      EXPECT_TRUE(lenient) << lenient.error().message << "\n" << text;
    }
    loaded += scene ? 1 : 0;
    published += row.fork.empty() ? 1 : 0;
    published_loaded += row.fork.empty() && scene ? 1 : 0;
  }
  const double share = double(published_loaded) / published;
  fmt::print(
      "{} of {} scenes of Mitsuba as published load ({:.1f} %), {} of {} with those of forks ({:.1f} %)\n",
      published_loaded, published, 100 * share, loaded, rows.size(), 100.0 * loaded / double(rows.size()));
  EXPECT_GE(share, 0.92);
  EXPECT_GE(loaded, int(rows.size()) * 91 / 100);
}

}  // namespace
}  // namespace penumbra
