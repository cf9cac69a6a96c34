// Media of pbrt-v4: coefficients, grids, and their boundaries.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "scenes/reader_report.h"
#include "scenes/settings.h"
#include "scenes/spectrum.h"
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

TEST_F(PbrtMedia, EmitInProportionToWhatTheyAbsorb) {
  const std::string homogeneous = "\"string type\" \"homogeneous\" \"rgb sigma_a\" [1 2 3] ";
  const ParticipatingMedium plain =
      inside(homogeneous + "\"float scale\" 10 \"rgb Le\" [1 .5 .2] \"float Lescale\" 2");
  expect_close(plain.emission, {20, 20, 12});
  EXPECT_FALSE(plain.emission_grid);
  const glm::vec3 fire = inside(homogeneous + "\"blackbody Le\" 2000").emission / glm::vec3(1, 2, 3);
  EXPECT_NEAR(0.212671f * fire.x + 0.71516f * fire.y + 0.072169f * fire.z, 1, 1e-4f);
  EXPECT_FALSE(inside(homogeneous + "\"rgb Le\" [0 0 0]").emits());
  EXPECT_FALSE(inside(homogeneous + "\"rgb Le\" [1 1 1] \"float Lescale\" 0").emits());
}

TEST_F(PbrtMedia, GridsEmitByTheirDensity) {
  const std::string two =
      "\"string type\" \"uniformgrid\" \"integer nx\" 2 \"float density\" [1 2] \"rgb sigma_a\" [1 2 3] "
      "\"rgb Le\" [1 1 2] ";
  const ParticipatingMedium scaled = inside(two + "\"float Lescale\" [3 4]");
  expect_close(scaled.emission, {1, 2, 6});
  EXPECT_TRUE(scaled.emission_by_density);
  ASSERT_TRUE(scaled.emission_grid);
  EXPECT_TRUE(scaled.emission_grid->fades);
  EXPECT_THAT(scaled.emission_grid->grid->values, ElementsAre(3, 4));
  EXPECT_EQ(scaled.emission_grid->to_world, scaled.density->to_world);
  // pbrt's grid of one strength fades, too.
  const ParticipatingMedium plain = inside(two);
  ASSERT_TRUE(plain.emission_grid);
  EXPECT_TRUE(plain.emission_grid->fades);
  EXPECT_THAT(plain.emission_grid->grid->values, ElementsAre(1));
}

/// Of a black body whose spectrum has the maximum 1: Planck's law in double, and the matching functions.
glm::dvec3 black_body(double kelvin) {
  const auto planck = [&](double nm) { return std::pow(nm, -5) / std::expm1(1.438776877e7 / (nm * kelvin)); };
  const double most = planck(2.897771955e6 / kelvin);
  glm::dvec3 sum(0);
  for (double nm = 360.05; nm < 830; nm += 0.1) sum += 0.1 * matching_rgb(nm) * planck(nm) / most;
  return glm::max(sum, 0.0);
}

TEST_F(PbrtMedia, HotGridsAreBlackBodies) {
  // The cells in the middle, of 3 along each axis, are as hot as the numbers say, without a number outside.
  const auto middle = [&](double number, const std::string& more) {
    std::string numbers;
    for (int i = 0; i < 27; ++i) numbers += fmt::format("{} ", number);
    const ParticipatingMedium m = inside(
        "\"string type\" \"uniformgrid\" \"integer nx\" 3 \"integer ny\" 3 \"integer nz\" 3 \"rgb sigma_a\" "
        "[1 2 3] \"float density\" [" +
        numbers + "] \"float temperature\" [" + numbers + "] " + more);
    EXPECT_TRUE(m.emission_grid && m.emission_by_density);
    if (!m.emission_grid) return glm::dvec3(0);
    const VolumeGrid& grid = *m.emission_grid->grid;
    EXPECT_EQ(m.emission, glm::vec3(1));
    const auto at = std::size_t(3 * ((5 * grid.ny + 5) * grid.nx + 5));
    return glm::dvec3(grid.values[at], grid.values[at + 1], grid.values[at + 2]);
  };
  const std::string strengths = [] {
    std::string text;
    for (int i = 0; i < 27; ++i) text += "0.25 ";
    return "\"float Lescale\" [" + text + "]";
  }();
  for (const double kelvin : {800.0, 1500.0, 3000.0, 6500.0, 12000.0}) {
    const glm::dvec3 truth = 0.25 * glm::dvec3(1, 2, 3) * black_body(kelvin);
    const glm::dvec3 found = middle(kelvin, strengths);
    const glm::dvec3 scaled =
        middle(kelvin / 2000 - 0.125,
               strengths + "\"float temperatureoffset\" -0.125 \"float temperaturescale\" 2000");
    for (int c = 0; c < 3; ++c) {
      // Numbers of nanometres are the steps of the reader's integral.
      EXPECT_NEAR(found[c], truth[c], 2e-4 * truth[c] + 1e-9) << kelvin;
      EXPECT_NEAR(scaled[c], truth[c], 2e-4 * truth[c] + 1e-9) << kelvin;
    }
  }
  // Between cells, temperatures are interpolated.
  const ParticipatingMedium between = inside(
      "\"string type\" \"uniformgrid\" \"integer nx\" 2 \"float density\" [1 1] \"float temperature\" [4000 "
      "12000]");
  const VolumeGrid& grid = *between.emission_grid->grid;
  ASSERT_EQ(glm::ivec3(grid.nx, grid.ny, grid.nz), glm::ivec3(8, 4, 4));
  const double at_x = 4000 * (1 - 0.125) + 12000 * 0.125, beside = 0.875 * 0.875;
  const glm::dvec3 truth = black_body(at_x * beside);
  // The fading of the strength, which is 1, at the centre of cell (2, 1, 1) of 8, 4, 4.
  const double strength = (0.3125 + 0.5) * beside;
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(double(grid.values[std::size_t(3 * ((1 * 4 + 1) * 8 + 2) + c)]), strength * truth[c],
                2e-4 * truth[c] + 1e-9);
  EXPECT_FALSE(
      inside("\"string type\" \"uniformgrid\" \"float density\" 1 \"float temperature\" 99").emits());
}

TEST_F(PbrtMedia, GridsOfColoursEmitColours) {
  const ParticipatingMedium m = inside(
      "\"string type\" \"rgbgrid\" \"rgb sigma_a\" [1 2 3] \"rgb Le\" [1 .5 .25] \"float scale\" 4 \"float "
      "Lescale\" 0.5");
  ASSERT_TRUE(m.emission_grid);
  EXPECT_FALSE(m.emission_by_density);
  EXPECT_EQ(m.emission, glm::vec3(1));
  // At the centre of a fine cell both numbers have faded by 7/8 along each axis. The spectra are multiples of
  // the illuminant, whose luminance pbrt does not divide by here.
  const double faded = std::pow(0.875, 6);
  const std::size_t at = 3 * ((1 * 4 + 1) * 4 + 1);
  const glm::dvec3 truth = 4 * 0.5 * luminance_of_unit_power() * faded * glm::dvec3(1, 1, 0.75);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(double(m.emission_grid->grid->values[at + c]), truth[int(c)], 1e-6 * truth.x);
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
  EXPECT_THAT(of("\"string type\" \"homogeneous\" \"rgb Le\" [1 -1 1]"),
              HasSubstr("'Le': numbers must be in"));
  EXPECT_THAT(of("\"string type\" \"homogeneous\" \"rgb Le\" [1 1 1] \"float Lescale\" -2"),
              HasSubstr("'Lescale' must be at least 0, not -2"));
  EXPECT_THAT(of("\"string type\" \"homogeneous\" \"float temperature\" 1000"), HasSubstr("temperature"));
  const std::string cell = "\"string type\" \"uniformgrid\" \"float density\" 1 ";
  EXPECT_THAT(of(cell + "\"rgb Le\" [1 1 1] \"float temperature\" 900"),
              HasSubstr("\"temperature\", not both"));
  EXPECT_THAT(of(cell + "\"rgb Le\" [1 1 1] \"float Lescale\" [1 2]"), HasSubstr("'Lescale' has 2 numbers"));
  EXPECT_THAT(of(cell + "\"float temperature\" [1 2]"), HasSubstr("'temperature' has 2 numbers"));
  EXPECT_THAT(of("\"string type\" \"rgbgrid\" \"rgb sigma_s\" [1 1 1] \"rgb Le\" [1 1 1]"),
              HasSubstr("needs \"rgb sigma_a\""));
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

TEST_F(PbrtMedia, DamagedNanoVdbFilesSaySo) {
  write("cloud.nvdb", std::string("NanoVDB0") + std::string(64, '\0'));
  const std::string medium =
      "MakeNamedMedium \"m\" \"string type\" \"nanovdb\" \"string filename\" \"cloud.nvdb\" "
      "\"float scale\" 4\n" +
      std::string(kBall);
  EXPECT_THAT(wrong(medium), AllOf(HasSubstr("cloud.nvdb"), HasSubstr("NanoVDB")));
  const SceneDescription scene = good_pbrt(medium, "Camera \"perspective\"", {.lenient = true});
  EXPECT_EQ(scene.media.at(0).extinction, glm::vec3(8.0f));
  EXPECT_EQ(scene.media[0].albedo, kUnreadColour);
}

}  // namespace
}  // namespace penumbra::pbrt_test
