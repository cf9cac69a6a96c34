// Media of pbrt-v4: coefficients, grids, and their boundaries.
#include <gmock/gmock.h>

#include "scenes/reader_report.h"
#include "scenes/settings.h"
#include "scenes/volume_file.h"
#include "tests/scenes/pbrt_text.h"

namespace penumbra::pbrt_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class PbrtMedia : public PbrtText {
 protected:
  static constexpr const char* kBall =
      "AttributeBegin\nMaterial \"interface\"\nMediumInterface \"m\" \"\"\nShape \"sphere\"\nAttributeEnd\n";
  /// Of the only shape's inside.
  ParticipatingMedium inside(std::string_view medium) {
    const SceneDescription scene =
        good_pbrt(std::string("MakeNamedMedium \"m\" ") + std::string(medium) + "\n" + kBall);
    if (scene.shapes.size() != 1 || scene.shapes[0].interior < 0) return {};
    return scene.media.at(std::size_t(scene.shapes[0].interior));
  }
};

void expect_close(const glm::vec3& a, const glm::vec3& b) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-6f);
}

TEST_F(PbrtMedia, AreSumsOfWhatIsScatteredAndAbsorbed) {
  const ParticipatingMedium medium = inside(
      "\"string type\" \"homogeneous\" \"rgb sigma_s\" [1 2 3] \"rgb sigma_a\" [1 0 0] \"float scale\" 10 "
      "\"float g\" -0.5");
  expect_close(medium.extinction, {20, 20, 30});
  expect_close(medium.albedo, {0.5f, 1, 1});
  EXPECT_THAT(medium.phase, ElementsAre(PhaseLobe{PHASE_HG, -0.5f, 1.0f}));
  EXPECT_FALSE(medium.density);
}

TEST_F(PbrtMedia, MissingCoefficientsAreOne) {
  const ParticipatingMedium plain = inside("\"string type\" \"homogeneous\"");
  expect_close(plain.extinction, glm::vec3(2.0f));
  expect_close(plain.albedo, glm::vec3(0.5f));
  const ParticipatingMedium clear = inside("\"string type\" \"homogeneous\" \"rgb sigma_a\" [0 0 0]");
  expect_close(clear.extinction, glm::vec3(1.0f));
}

TEST_F(PbrtMedia, PresetsAreMeasured) {
  // Jensen et al. 2001, figure 5; Narasimhan et al. 2006.
  const ParticipatingMedium milk =
      inside("\"string type\" \"homogeneous\" \"string preset\" \"Wholemilk\" \"float scale\" 2");
  expect_close(milk.extinction, 2.0f * glm::vec3(2.5511f, 3.2124f, 3.784f));
  const ParticipatingMedium coffee = inside("\"string type\" \"homogeneous\" \"string preset\" \"Espresso\"");
  expect_close(coffee.extinction, glm::vec3(0.72378f + 4.7984f, 0.84557f + 6.5751f, 1.0247f + 8.8493f));
}

TEST_F(PbrtMedia, GridsFillTheirBox) {
  const SceneDescription scene = good_pbrt(
      "AttributeBegin\nTranslate 10 0 0\nMakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer "
      "nx\" 2 "
      "\"integer ny\" 1 \"integer nz\" 3 \"point3 p0\" [4 2 1] \"point3 p1\" [1 1 1.5] \"float density\" [1 "
      "2 3 4 5 "
      "6] \"rgb sigma_s\" [0 1 3] \"float scale\" 0.5\nAttributeEnd\n" +
      std::string(kBall));
  const ParticipatingMedium& medium = scene.media.at(0);
  expect_close(medium.extinction, {0.5f, 1, 2});
  expect_close(medium.albedo, {0, 0.5f, 0.75f});
  ASSERT_TRUE(medium.density);
  EXPECT_EQ(medium.density->grid->nz, 3);
  EXPECT_THAT(medium.density->grid->values, ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_TRUE(medium.density->fades) << "the grid is 0 outside";
  expect_near(medium.density->to_world * glm::dvec4(0, 0, 0, 1), {11, 1, 1});
  expect_near(medium.density->to_world * glm::dvec4(1, 1, 1, 1), {14, 2, 1.5});
}

TEST_F(PbrtMedia, GridsOfColoursHaveTwo) {
  const ParticipatingMedium medium = inside(
      "\"string type\" \"rgbgrid\" \"integer nx\" 2 \"rgb sigma_s\" [1 1 1 0 3 0] \"rgb sigma_a\" [1 0 3 0 1 "
      "0] "
      "\"float scale\" 4");
  EXPECT_EQ(medium.extinction, glm::vec3(4.0f));
  EXPECT_EQ(medium.albedo, glm::vec3(1.0f));
  // Cells a fourth as large. pbrt interpolates both coefficients, towards 0 outside of the grid.
  const VolumeGrid& density = *medium.density->grid;
  const VolumeGrid& albedo = *medium.albedo_grid->grid;
  ASSERT_EQ(glm::ivec3(density.nx, density.ny, density.nz), glm::ivec3(8, 4, 4));
  const auto weight = [](int fine, int cell) {
    return std::max(0.0, 1.0 - std::abs((fine + 0.5) / 4 - (cell + 0.5)));
  };
  for (int z = 0; z < 4; ++z)
    for (int x = 0; x < 8; ++x) {
      const double others = weight(1, 0) * weight(z, 0), first = others * weight(x, 0),
                   second = others * weight(x, 1);
      const auto at = std::size_t(3 * (8 * (4 * z + 1) + x));
      EXPECT_NEAR(density.values[at], 2 * first, 1e-6);
      EXPECT_NEAR(density.values[at + 1], first + 4 * second, 1e-6);
      EXPECT_NEAR(albedo.values[at + 1], (first + 3 * second) / (first + 4 * second), 1e-6);
    }
}

TEST_F(PbrtMedia, AreBetweenSurfacesThatPartTwo) {
  const SceneDescription scene = good_pbrt(
      std::string(kBall) +
          "MediumInterface \"m\" \"fog\"\nReverseOrientation\nShape \"sphere\"\nMediumInterface \"fog\" "
          "\"fog\"\nShape \"sphere\"\nMediumInterface \"fog\"\nShape \"sphere\"\n"
          "MakeNamedMedium \"m\" \"string type\" \"homogeneous\"\n",
      "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"float scale\" 0.1\nMediumInterface \"\" "
      "\"fog\"\n"
      "Camera \"perspective\"\nMediumInterface \"\" \"\"");
  ASSERT_EQ(scene.shapes.size(), 4u);
  ASSERT_EQ(scene.media.size(), 2u);
  const auto name = [&](int medium) { return medium < 0 ? "" : scene.media.at(std::size_t(medium)).name; };
  EXPECT_EQ(name(scene.camera_medium), "fog");
  EXPECT_EQ(name(scene.shapes[0].interior), "m") << "which is made later";
  EXPECT_EQ(name(scene.shapes[0].exterior), "");
  EXPECT_EQ(std::get<MaskBsdf>(front(scene, 0)).opacity.value, 0.0f);
  EXPECT_EQ(name(scene.shapes[1].interior), "m") << "behind the front, which is inside of the sphere";
  EXPECT_EQ(name(scene.shapes[1].exterior), "fog");
  EXPECT_TRUE(scene.shapes[1].flip_normals);
  for (const std::size_t i : {2u, 3u}) {
    EXPECT_EQ(scene.shapes[i].interior, kNoMedium) << "no boundary";
    EXPECT_EQ(scene.shapes[i].exterior, kNoMedium);
  }
  EXPECT_EQ(print_setting(scene, "integrator.type"), "volpath");
  EXPECT_EQ(print_setting(scene, "integrator.max_depth"), "6");
}

TEST_F(PbrtMedia, AreInObjectsToo) {
  const SceneDescription scene =
      good_pbrt("MakeNamedMedium \"m\" \"string type\" \"homogeneous\"\nObjectBegin \"o\"\n" +
                std::string(kBall) + "ObjectEnd\nObjectInstance \"o\"\n");
  ASSERT_EQ(scene.groups.size(), 1u);
  EXPECT_EQ(scene.groups[0].shapes.at(0).interior, 0);
}

TEST_F(PbrtMedia, ThePathIntegratorPassesThrough) {
  const SceneDescription scene =
      good_pbrt("MakeNamedMedium \"m\" \"string type\" \"homogeneous\"\n" + std::string(kBall),
                "Camera \"perspective\"\nIntegrator \"path\"");
  EXPECT_EQ(print_setting(scene, "integrator.type"), "path_mis");
  EXPECT_THAT(warnings(scene), HasSubstr("passes through media"));
}

TEST_F(PbrtMedia, PhotonMapsFollowLightThroughThem) {
  const SceneDescription scene =
      good_pbrt("MakeNamedMedium \"m\" \"string type\" \"homogeneous\"\n" + std::string(kBall),
                "Camera \"perspective\"\nIntegrator \"sppm\"");
  EXPECT_TRUE(scene.integrator.is<ProgressivePhotonIntegrator>());
  EXPECT_THAT(warnings(scene), HasSubstr("pbrt's sppm passes through them"));
}

TEST_F(PbrtMedia, WhatIsWrongIsSaidWithItsPlace) {
  const auto of = [&](std::string_view medium) {
    return wrong(std::string("MakeNamedMedium \"m\" ") + std::string(medium));
  };
  EXPECT_THAT(of(""), HasSubstr("needs a \"string type\""));
  EXPECT_THAT(of("\"string type\" \"homogenous\""), HasSubstr("did you mean 'homogeneous'"));
  EXPECT_THAT(of("\"string type\" \"homogeneous\" \"float g\" 1"), HasSubstr("g must be in (-1, 1), not 1"));
  EXPECT_THAT(of("\"string type\" \"homogeneous\" \"float scale\" -1"), HasSubstr("at least 0, not -1"));
  EXPECT_THAT(of("\"string type\" \"homogeneous\" \"rgb Le\" [1 1 1]"), HasSubstr("media that emit light"));
  EXPECT_THAT(of("\"string type\" \"homogeneous\" \"string preset\" \"Milk\""), HasSubstr("Wholemilk"));
  EXPECT_THAT(of("\"string type\" \"uniformgrid\""), HasSubstr("needs \"float density\""));
  EXPECT_THAT(of("\"string type\" \"uniformgrid\" \"integer nx\" 2 \"float density\" [1 2 3]"),
              HasSubstr("has 3 numbers; nx ny nz cells have 2"));
  EXPECT_THAT(of("\"string type\" \"uniformgrid\" \"float density\" [-1]"), HasSubstr("'density' holds -1"));
  EXPECT_THAT(of("\"string type\" \"uniformgrid\" \"float density\" 1 \"point3 p1\" [1 0 1]"),
              HasSubstr("is flat"));
  EXPECT_THAT(of("\"string type\" \"rgbgrid\""), HasSubstr("needs \"rgb sigma_s\""));
  EXPECT_THAT(of("\"string type\" \"nanovdb\" \"string filename\" \"none.nvdb\""), HasSubstr("none.nvdb"));
  EXPECT_THAT(wrong(kBall), HasSubstr("there is no medium 'm'"));
  EXPECT_THAT(
      wrong("MakeNamedMedium \"m\" \"string type\" \"homogeneous\"\nMakeNamedMedium \"m\" \"string type\" "
            "\"homogeneous\""),
      HasSubstr("scene.pbrt:4:1: error: the medium 'm' is there twice"));
}

TEST_F(PbrtMedia, CloudsAreDenseBelowAndThinAbove) {
  const SceneDescription scene = good_pbrt(
      "MakeNamedMedium \"m\" \"string type\" \"cloud\" \"float density\" 2 \"point3 p1\" [0.5 1 0.25]\n" +
      std::string(kBall));
  const ParticipatingMedium& medium = scene.media.at(0);
  expect_close(medium.extinction, glm::vec3(2.0f));
  const VolumeGrid& grid = *medium.density->grid;
  EXPECT_EQ(grid.nx, 64);
  EXPECT_EQ(grid.ny, 128);
  EXPECT_EQ(grid.nz, 32);
  std::vector<double> means(4, 0.0);
  for (std::size_t i = 0; i < grid.values.size(); ++i) {
    ASSERT_TRUE(grid.values[i] >= 0.0f && grid.values[i] <= 1.0f);
    means[i / 64 % 128 / 32] += double(grid.values[i]) / (64 * 32 * 32);
  }
  EXPECT_GE(means[0], 0.75) << "twice 0.5 - y, and the noise";
  for (int i = 0; i < 3; ++i) EXPECT_GT(means[std::size_t(i)], means[std::size_t(i + 1)]);
  EXPECT_GT(means[2], 0.1);
  EXPECT_THAT(warnings(scene), HasSubstr("noise of pbrt's kind"));
}

TEST_F(PbrtMedia, GridsOfFilesAreWhereTheFileSays) {
  VolumeGrid grid{2, 1, 1, 1, {1, 3}};
  write("smoke.vdb", vol_of(grid, {1, 2, 3}, {2, 4, 6}));  // of which kind a file is, its contents say
  const SceneDescription scene = good_pbrt(
      "AttributeBegin\nTranslate 10 0 0\nMakeNamedMedium \"m\" \"string type\" \"nanovdb\" \"string "
      "filename\" "
      "\"smoke.vdb\" \"float scale\" 0.5 \"float Lescale\" 0\nAttributeEnd\n" +
      std::string(kBall));
  const ParticipatingMedium& medium = scene.media.at(0);
  expect_close(medium.extinction, glm::vec3(1.0f));
  expect_close(medium.albedo, glm::vec3(0.5f));
  ASSERT_TRUE(medium.density);
  EXPECT_THAT(medium.density->grid->values, ElementsAre(1, 3));
  expect_near(medium.density->to_world * glm::dvec4(0, 0, 0, 1), {11, 2, 3});
  expect_near(medium.density->to_world * glm::dvec4(1, 1, 1, 1), {12, 4, 6});
}

TEST_F(PbrtMedia, NanoVdbFilesSayWhatReadsThem) {
  write("cloud.nvdb", std::string("NanoVDB0") + std::string(64, '\0'));
  const std::string medium =
      "MakeNamedMedium \"m\" \"string type\" \"nanovdb\" \"string filename\" \"cloud.nvdb\" "
      "\"float scale\" 4\n" +
      std::string(kBall);
  EXPECT_THAT(wrong(medium),
              AllOf(HasSubstr("'cloud.nvdb' is a file of NanoVDB"), HasSubstr("nanovdb_convert")));
  const SceneDescription scene = good_pbrt(medium, "Camera \"perspective\"", {.lenient = true});
  EXPECT_EQ(scene.media.at(0).extinction, glm::vec3(8.0f));
  EXPECT_EQ(scene.media[0].albedo, kUnreadColour);
}

}  // namespace
}  // namespace penumbra::pbrt_test
