// Other people's scenes, as they are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "scenes/scene_reader.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class OracleScenes : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(folder_))
      GTEST_SKIP() << "the folder of reference scenes, " << folder_ << ", is not here";
  }
  fs::path folder_ = fs::path(PENUMBRA_SOURCE_DIR) / "../shared/oracles";
};

TEST_F(OracleScenes, CornellBox) {
  const auto scene = read_scene(folder_ / "bitterli/cornell-box/scene.xml", {});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(scene->warnings, IsEmpty());
  EXPECT_EQ(scene->shapes.size(), 8u);
  EXPECT_EQ(scene->integrator.max_depth, 65);
  EXPECT_EQ(scene->film.filter, FilterKind::kTent);
  EXPECT_EQ(scene->film.width, 1024);
  EXPECT_EQ(scene->camera.fov, 19.5);
  EXPECT_EQ(scene->shapes.back().radiance, glm::vec3(17, 12, 4));
  for (const Shape& shape : scene->shapes) EXPECT_EQ(shape.front_bsdf, shape.back_bsdf);
}

TEST_F(OracleScenes, CornellBoxOfIncludes) {
  const auto scene = read_scene(folder_ / "mitsuba/scenes/cbox/cbox-rgb.xml", {.defines = {{"res", "64"}}});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(scene->warnings, IsEmpty());
  EXPECT_EQ(scene->shapes.size(), 8u);
  EXPECT_EQ(scene->bsdfs.size(), 5u);
  EXPECT_EQ(scene->film.height, 64);
  EXPECT_EQ(scene->camera.fov_axis, FovAxis::kSmaller);
  EXPECT_EQ(scene->camera.near_clip, 10.0);
  EXPECT_EQ(scene->integrator.max_depth, 6);
  EXPECT_EQ(scene->shapes[0].radiance, glm::vec3(18.387f, 10.9873f, 2.75357f));
  EXPECT_EQ(std::get<Mesh>(scene->shapes[0].geometry).positions[0].y, 548.8 - 0.5);
}

TEST_F(OracleScenes, TheOthersAreReadLeniently) {
  const std::pair<const char*, const char*> scenes[] = {
      {"bitterli/classroom/scene.xml", "bsdf type 'roughplastic'"},
      {"bitterli/spaceship/scene.xml", "bsdf type 'roughconductor'"},
      {"bitterli/veach-bidir/scene.xml", "bsdf type 'dielectric'"},
      {"mitsuba/tests/scenes/bsdf_spheres/test_arealight_path.xml", "bsdf type 'dielectric'"},
      {"mitsuba/tests/scenes/bsdf_spheres/test_envmap_path.xml", "emitter type 'envmap'"},
      {"mitsuba/tests/scenes/bsdf_spheres/test_normalmap_path.xml", "bsdf type 'normalmap'"},
      {"mitsuba/tests/scenes/bsdf_spheres/test_texturedprincipled1_path.xml", "bsdf type 'principled'"},
      {"mitsuba/tests/scenes/instancing/test_instancing_path.xml", "shape type 'instance'"},
      {"mitsuba/tests/scenes/participating_media/test_homo_area_light_volpath.xml",
       "medium type 'homogeneous'"},
      {"mitsuba/tests/scenes/various_emitters/test_various_emitters_ptracer.xml", "emitter type 'spot'"},
  };
  for (const auto& [file, unknown] : scenes) {
    const auto strict = read_scene(folder_ / file, {});
    ASSERT_FALSE(strict) << file;
    EXPECT_THAT(strict.error().message, AllOf(HasSubstr("is not one that Penumbra reads"), HasSubstr("^")))
        << file;
    EXPECT_THAT(strict.error().message, Not(HasSubstr("has no parameter"))) << file;
    const auto lenient = read_scene(folder_ / file, {.lenient = true});
    ASSERT_TRUE(lenient) << lenient.error().message;
    EXPECT_THAT(lenient->warnings, Contains(HasSubstr(unknown))) << file;
  }
}

}  // namespace
}  // namespace penumbra
