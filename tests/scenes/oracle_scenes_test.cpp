// Third-party scenes, unedited.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "scenes/scene_reader.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/oracles.h"

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
    PENUMBRA_NEED_ORACLE("");
    folder_ = *find_oracle("");
  }
  fs::path folder_;
};

TEST_F(OracleScenes, CornellBox) {
  const auto scene = read_scene(folder_ / "bitterli/cornell-box/scene.xml", {});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(scene->warnings, IsEmpty());
  EXPECT_EQ(scene->shapes.size(), 8u);
  EXPECT_EQ(param::max_depth(scene->integrator), 65);
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
  EXPECT_EQ(param::max_depth(scene->integrator), 6);
  EXPECT_EQ(scene->shapes[0].radiance, glm::vec3(18.387f, 10.9873f, 2.75357f));
  EXPECT_EQ(std::get<Mesh>(scene->shapes[0].geometry).positions[0].y, 548.8 - 0.5);
}

TEST_F(OracleScenes, MediaAreRead) {
  const fs::path file = folder_ / "mitsuba/tests/scenes/participating_media/test_homo_area_light_volpath.xml";
  const auto scene = read_scene(file, {});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_TRUE(scene->integrator.is<VolpathIntegrator>());
  EXPECT_EQ(scene->media.size(), 1u);
}

TEST_F(OracleScenes, PathStandsInForTheParticleTracer) {
  const auto scene =
      read_scene(folder_ / "mitsuba/tests/scenes/various_emitters/test_various_emitters_ptracer.xml", {});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(scene->warnings, Contains(HasSubstr("path stands in for the integrator 'ptracer'")));
}

TEST_F(OracleScenes, ScenesOfManyMaterialsAreReadUnedited) {
  for (const char* file :
       {"bitterli/classroom/scene.xml", "bitterli/spaceship/scene.xml", "bitterli/veach-bidir/scene.xml",
        "mitsuba/tests/scenes/bsdf_spheres/test_arealight_path.xml",
        "mitsuba/tests/scenes/bsdf_spheres/test_normalmap_path.xml",
        "mitsuba/tests/scenes/bsdf_spheres/test_texturedprincipled1_path.xml"}) {
    const auto scene = read_scene(folder_ / file, {});
    EXPECT_TRUE(scene) << scene.error().message;
  }
}

std::size_t triangles(const Shape& shape) { return std::get<Mesh>(shape.geometry).triangles.size(); }

glm::dvec3 first_normal(const Shape& shape) {
  const Mesh& mesh = std::get<Mesh>(shape.geometry);
  const glm::uvec3 t = mesh.triangles.at(0);
  return glm::normalize(
      glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
}

TEST_F(OracleScenes, EveryTinyRenderScene) {
  using enum IntegratorKind;
  const std::map<std::string, IntegratorKind> kinds = {{"grid_analytic", kPolygonAnalytic},
                                                       {"grid_area", kPolygonArea},
                                                       {"grid_cv", kPolygonCv},
                                                       {"grid_cv_realtime", kPolygonCv},
                                                       {"mcgill_analytic_offline", kPolygonAnalytic},
                                                       {"mcgill_area_offline", kPolygonArea},
                                                       {"mcgill_cv_bonus", kPolygonCv},
                                                       {"mcgill_cv_offline", kPolygonCv},
                                                       {"mcgill_hybrid_realtime", kPolygonCv},
                                                       {"polygon_analytic_realtime", kPolygonAnalytic},
                                                       {"star_analytic_realtime", kPolygonAnalytic},
                                                       {"star_analytic_realtime_bonus", kPolygonAnalytic},
                                                       {"veach_area", kDirect},
                                                       {"veach_bsdf", kDirect},
                                                       {"veach_mis", kDirect},
                                                       {"veach_color_area_offline", kDirect},
                                                       {"veach_color_bsdf_offline", kDirect},
                                                       {"veach_color_mis_offline", kDirect}};
  std::size_t found = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "tinyrender-a4")) {
    if (entry.path().extension() != ".toml") continue;
    const std::string name = entry.path().stem().string();
    SCOPED_TRACE(name);
    const auto scene = read_scene(entry.path(), {.confine_to = folder_});
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_THAT(scene->warnings, IsEmpty());
    ASSERT_TRUE(kinds.contains(name));
    EXPECT_EQ(kind_of(scene->integrator), kinds.at(name));
    EXPECT_EQ(scene->film.width, 600);
    EXPECT_EQ(scene->film.height, 400);
    EXPECT_EQ(scene->camera.fov, 35.0);
    EXPECT_EQ(scene->camera.fov_axis, FovAxis::kY);
    EXPECT_EQ(scene->sampler.spp, name.find("_area") != name.npos && !name.starts_with("veach") ? 4u : 1u);
    EXPECT_EQ(std::ranges::count_if(scene->shapes, [](const Shape& s) { return s.radiance.has_value(); }),
              name.starts_with("veach") ? 5 : 1);
    ++found;
  }
  EXPECT_EQ(found, kinds.size());
}

TEST_F(OracleScenes, TinyRenderGrid) {
  const auto scene = read_scene(folder_ / "tinyrender-a4/grid/tinyrender/grid_area.toml", {});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_TRUE(param::trace_shadows(scene->integrator));
  ASSERT_EQ(scene->shapes.size(), 3u);
  const Shape &light = scene->shapes[0], &floor = scene->shapes[1], &grid = scene->shapes[2];
  EXPECT_EQ(light.name, "light (light)");
  EXPECT_EQ(light.radiance, glm::vec3(12));
  EXPECT_EQ(triangles(light), 2u);
  // It hangs over the floor's far end, and shines down and towards +x.
  EXPECT_NEAR(first_normal(light).x, 0.9397, 1e-4);
  EXPECT_NEAR(first_normal(light).y, -0.3420, 1e-4);
  EXPECT_EQ(triangles(floor), 2u);
  EXPECT_EQ(triangles(grid), 80u);
  for (const Shape& shape : scene->shapes) EXPECT_THAT(std::get<Mesh>(shape.geometry).normals, IsEmpty());
  EXPECT_EQ(std::get<DiffuseBsdf>(scene->bsdfs.at(std::size_t(grid.front_bsdf)).model).reflectance,
            glm::vec3(.1f, .2f, 1.f));
}

TEST_F(OracleScenes, TinyRenderVeach) {
  const auto scene = read_scene(folder_ / "tinyrender-a4/veach_test/tinyrender/veach_area.toml", {});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(param::emitter_samples(scene->integrator), 64);
  EXPECT_EQ(param::bsdf_samples(scene->integrator), 0);
  ASSERT_EQ(scene->shapes.size(), 10u);
  // Spheres of 32 x 16 faces, 64 triangles at the poles and 448 quadrilaterals.
  EXPECT_EQ(std::ranges::count_if(scene->shapes, [](const Shape& s) { return triangles(s) == 960u; }), 5);
  for (const Shape& shape : scene->shapes) {
    EXPECT_THAT(std::get<Mesh>(shape.geometry).normals, IsEmpty()) << shape.name << ": its faces are flat";
    if (shape.name != "plate1 (plate1)") continue;
    const auto& phong = std::get<PhongBsdf>(scene->bsdfs.at(std::size_t(shape.front_bsdf)).model);
    EXPECT_EQ(phong.diffuse, glm::vec3(0));
    EXPECT_EQ(phong.specular, glm::vec3(1));
    EXPECT_EQ(phong.exponent, 10000.0f);
  }
}

}  // namespace
}  // namespace penumbra
