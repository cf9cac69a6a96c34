// How many of the known public Nori scenes load unedited, and as which dialect.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/scenes/census/census.h"
#include "tests/scenes/scene_text.h"

namespace penumbra {
namespace {

class NoriCensus : public SceneText {
 protected:
  void SetUp() override {
    write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    write("image.pfm", census::grey_image());
  }
};

TEST_F(NoriCensus, ScenesLoadAsTheirDialectUnlessTheCensusSaysWhyNot) {
  const auto rows =
      census::read_rows(std::string(PENUMBRA_SOURCE_DIR) + "/tests/scenes/census/nori_scenes.txt");
  ASSERT_GE(rows.size(), 30u);
  std::set<std::string> names;
  int loaded = 0, decided = 0;
  for (const census::Row& row : rows) {
    SCOPED_TRACE(row.name);
    EXPECT_TRUE(names.insert(row.name).second) << "twice";
    const std::string text = census::nori_text(row);
    auto scene = read(text);
    census::expect_verdict(row, scene, text);
    loaded += scene ? 1 : 0;
    if (!scene) scene = read(text, {.lenient = true});
    ASSERT_TRUE(scene) << scene.error().message << "\n" << text;
    EXPECT_TRUE(scene->dialect.starts_with(row.version + " (")) << scene->dialect;
    EXPECT_EQ(scene->dialect.find("nothing in it tells") != std::string::npos, row.fork == "undecided")
        << scene->dialect;
    decided += row.fork.empty() ? 1 : 0;
  }
  fmt::print("{} of {} public scenes of Nori load; {} tell their dialect\n", loaded, rows.size(), decided);
  EXPECT_GE(loaded, int(rows.size()) * 85 / 100);
}

}  // namespace
}  // namespace penumbra
