// [camera] and [film] of TinyRender scenes, and the TOML file itself.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/scenes/tinyrender_text.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using TinyRenderCamera = TinyRenderText;
using TinyRenderToml = TinyRenderText;

/// Where a point is in the picture, in pixels from its upper left corner, by the pinhole formula: x runs to
/// the right and camera space's +x to the left.
glm::dvec2 pixel(const SceneDescription& scene, glm::dvec3 point) {
  const glm::dvec3 p(glm::inverse(scene.camera.to_world) * glm::dvec4(point, 1.0));
  EXPECT_EQ(scene.camera.fov_axis, FovAxis::kY);
  const double scale = 0.5 * scene.film.height / std::tan(scene.camera.fov * std::numbers::pi / 360.0);
  return {0.5 * scene.film.width - scale * p.x / p.z, 0.5 * scene.film.height - scale * p.y / p.z};
}

constexpr double kPixelTolerance = 1e-9;  // of doubles, through an inverse matrix

void expect_pixel(const SceneDescription& scene, glm::dvec3 point, glm::dvec2 expected) {
  const glm::dvec2 found = pixel(scene, point);
  EXPECT_NEAR(found.x, expected.x, kPixelTolerance);
  EXPECT_NEAR(found.y, expected.y, kPixelTolerance);
}

TEST_F(TinyRenderCamera, APointIsSeenAtItsPixel) {
  // Looking along -z from (0, 1, 5): +x is to the right, +y up. At the distance 5, half the picture's height
  // is 5 tan 20 degrees, whatever its width.
  const SceneDescription scene = good_toml(scene_with(kDirect));
  EXPECT_EQ(scene.film.width, 30);
  EXPECT_EQ(scene.film.height, 20);
  EXPECT_EQ(scene.film.crop_width, 30);
  EXPECT_EQ(scene.film.filter, FilterKind::kBox);
  EXPECT_EQ(scene.film.filter_radius, 0.5f);
  EXPECT_EQ(scene.camera.fov, 40.0);
  const double half = 5.0 * std::tan(20.0 * std::numbers::pi / 180.0);
  expect_pixel(scene, {0, 1, 0}, {15, 10});
  expect_pixel(scene, {0, 1 + half, 0}, {15, 0});
  expect_pixel(scene, {0, 1 - half, 0}, {15, 20});
  expect_pixel(scene, {half, 1, 0}, {25, 10});
  expect_pixel(scene, {-1.5 * half, 1 + 0.5 * half, 0}, {0, 5});
}

TEST_F(TinyRenderCamera, UpAndAnyDirection) {
  const SceneDescription rolled =
      good_toml(scene_with(kDirect, "eye = [0, 0, 0]\nat = [0.0, 0, -2.5]\nup = [1, 0, 1]\nfov = 90.0"));
  // Up is +x, as far as it can be; right is then -y.
  expect_pixel(rolled, {1, 0, -1}, {15, 0});
  expect_pixel(rolled, {0, -1, -1}, {25, 10});
  EXPECT_LE(rolled.camera.near_clip, 1e-3);
  EXPECT_GE(rolled.camera.far_clip, 1e6);
}

TEST_F(TinyRenderCamera, WhatIsMissingOrWrong) {
  EXPECT_THAT(toml_error(scene_with(kDirect, "eye = [0, 1, 5]")),
              AllOf(HasSubstr("scene.toml:3:2: error: [camera] needs 'at'\n  [camera]\n   ^"),
                    HasSubstr("[camera] needs 'fov'"), Not(HasSubstr("'eye'"))));
  EXPECT_THAT(toml_error(scene_with(kDirect, "eye = [0, 1]\nat = [0, 0, 0]\nfov = 40")),
              HasSubstr("scene.toml:4:7: error: [camera] eye takes 3 numbers, not 2"));
  EXPECT_THAT(toml_error(scene_with(kDirect, "eye = [0, 1, \"x\"]\nat = [0, 0, 0]\nfov = 40")),
              HasSubstr("eye must be an array of 3 numbers, not an array of other things than numbers"));
  EXPECT_THAT(
      toml_error(scene_with(kDirect, "eye = [1, 1, 1]\nat = [1, 1, 1]\nfov = 40")),
      HasSubstr("scene.toml:5:6: error: setting camera.lookat: origin and target are the same point"));
  EXPECT_THAT(toml_error(scene_with(kDirect, "eye = [0, 5, 0]\nat = [0, 1, 0]\nfov = 40")),
              HasSubstr("camera.lookat"));
  EXPECT_THAT(toml_error(scene_with(kDirect, "eye = [0, nan, 0]\nat = [0, 1, 0]\nfov = 40")),
              HasSubstr("'nan' is not a finite number"));
  EXPECT_THAT(toml_error(scene_with(kDirect, "eye = [0, 1, 5]\nat = [0, 1, 0]\nfov = 180")),
              HasSubstr("scene.toml:6:7: error: [camera] fov: 180 is not above 0 and below 180"));
  EXPECT_THAT(toml_error(scene_with(kDirect, "eye = [0, 1, 5]\nat = [0, 1, 0]\nfov = \"40\"")),
              HasSubstr("[camera] fov must be a number, not text"));
}

TEST_F(TinyRenderToml, UnknownTablesAndKeys) {
  const std::string scene = scene_with(kDirect, "eye = [0, 1, 5]\nat = [0, 1, 0]\nfov = 40\nfow = 3");
  EXPECT_THAT(toml_error(scene + "[lights]\na = 1\n"),
              AllOf(HasSubstr("scene.toml:7:1: error: [camera] has no key 'fow'; did you mean 'fov'? It has: "
                              "eye, at, up, fov\n"),
                    HasSubstr("scene.toml:13:2: error: a TinyRender scene has no table 'lights'. It has the "
                              "tables: input, camera, film, renderer")));
  EXPECT_THAT(toml_error("spp = 3\n" + scene_with(kDirect)),
              HasSubstr("scene.toml:1:1: error: a TinyRender scene has no key 'spp'"));
  EXPECT_THAT(
      toml_error(scene_with("type = \"direct\"\nbsdfSample = 3")),
      HasSubstr("scene.toml:12:1: error: [renderer] has no key 'bsdfSample'; did you mean 'bsdfSamples'?"));
  // Each name once, whether or not the scene has the key.
  for (const char* up : {"", "up = [0, 1, 0]\n"})
    EXPECT_THAT(toml_error(scene_with(
                    kDirect, fmt::format("eye = [0, 1, 5]\nat = [0, 1, 0]\n{}fov = 40\nfow = 1", up))),
                HasSubstr("[camera] has no key 'fow'; did you mean 'fov'? It has: eye, at, up, fov\n"));
  const SceneDescription lenient = good_toml(scene + "[lights]\na = 1\n", {.lenient = true});
  EXPECT_THAT(warnings(lenient), AllOf(HasSubstr("scene.toml:7:1: warning: [camera] has no key 'fow'"),
                                       HasSubstr("scene.toml:13:2: warning: a TinyRender scene has no table"),
                                       HasSubstr("it is left out")));
}

TEST_F(TinyRenderToml, MissingTables) {
  EXPECT_THAT(toml_error("# nothing\n"),
              AllOf(HasSubstr("scene.toml:1:1: error: the scene has no [input]"), HasSubstr("no [camera]"),
                    HasSubstr("no [film]"), HasSubstr("no [renderer]")));
  EXPECT_THAT(
      toml_error("[input]\n[camera]\n[film]\n[renderer]\n"),
      AllOf(HasSubstr("scene.toml:1:2: error: [input] needs 'objfile'"), HasSubstr("[film] needs 'width'"),
            HasSubstr("scene.toml:4:2: error: [renderer] needs 'type'")));
}

TEST_F(TinyRenderToml, WhatIsNotToml) {
  const std::string error = toml_error("[input]\nobjfile = m.obj\n");
  EXPECT_THAT(error, AllOf(HasSubstr("scene.toml:2:11: error: not TOML: "),
                           HasSubstr("\n  objfile = m.obj\n            ^")));
  EXPECT_THAT(toml_error("[input\n"), HasSubstr("scene.toml:1:7: error: not TOML"));
  EXPECT_THAT(toml_error(scene_with(kDirect) + "type = \"path\"\n"), HasSubstr("scene.toml:12:"));
  EXPECT_THAT(toml_error("[input]\nobjfile = \"\xFF\"\n"), HasSubstr("not TOML"));
  EXPECT_THAT(toml_error("[input]\nobjfile = \"" + std::string(1, '\0') + "\"\n"), HasSubstr("not TOML"));
  EXPECT_THAT(toml_error("a = " + std::string(10000, '[')), HasSubstr("not TOML"));
}

TEST_F(TinyRenderToml, KeysHaveADepth) {
  const auto repeated = [](std::string_view text, int times) {
    std::string result;
    for (int i = 0; i < times; ++i) result += text;
    return result;
  };
  const std::string deep = repeated("a.", 200000) + "a";
  const auto too_deep = HasSubstr("error: a key of more than 8 parts");
  EXPECT_THAT(toml_error(deep + " = 1\n"), too_deep);
  EXPECT_THAT(toml_error("# a.b.c.d.e.f.g.h.i\n[" + deep + "]\n"),
              HasSubstr("scene.toml:2:2: error: a key of"));
  EXPECT_THAT(toml_error("[[" + deep + "]]\n"), too_deep);
  EXPECT_THAT(toml_error("x = [{" + deep + " = 1}]\n"), HasSubstr("scene.toml:1:7: error: a key of"));
  EXPECT_THAT(toml_error("y = 1\n  a.b. c .\"d.e\".'f'.g.h.i.j = 1\n"),
              HasSubstr("scene.toml:2:3: error: a key of"));
  // As deep as keys and values may be together.
  const std::string part = "{a.b.c.d.e.f.g.h = ";
  EXPECT_THAT(toml_error("x = " + repeated(part, 250) + "1" + repeated("}", 250) + "\n"),
              AllOf(Not(too_deep), HasSubstr("a TinyRender scene has no")));
  EXPECT_THAT(toml_error("x = " + repeated("[", 100000) + repeated("]", 100000) + "\n"),
              HasSubstr("not TOML"));
  EXPECT_THAT(toml_error("x = " + repeated(part, 100000) + "1" + repeated("}", 100000) + "\n"),
              HasSubstr("not TOML"));
}

TEST_F(TinyRenderToml, DotsInTextMakeNoKeyDeep) {
  const std::string dots = "a.b.c.d.e.f.g.h.i.j", lines = R"("""a.b.c.d.e.f.g.h.i.j
"" a.b.c.d.e.f.g.h.i.j \""" a.b.c.d.e.f.g.h.i.j""""")";
  const std::string literal = "'''\n" + dots + "''''";
  for (const std::string& text :
       {"# " + dots, "x = \"" + dots + '"', "x = '" + dots + "'", "x = \"\\\"" + dots + '"', "x = " + lines,
        "x = " + literal, "x = \"\" # " + dots, '"' + dots + "\" = 1",
        std::string("x = [1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 8.5, 9.5, 1.5]")}) {
    const auto result = read_toml(text + "\n" + scene_with(kDirect), {.lenient = true});
    EXPECT_TRUE(result) << text << "\n" << result.error().message;
  }
}

TEST_F(TinyRenderToml, ByteOrderMarks) {
  const std::string mark = "\xEF\xBB\xBF";
  write("m.obj", mark + kModel);
  write("m.mtl", mark + kMaterials);
  const SceneDescription scene = good_toml(mark + scene_with(kDirect));
  EXPECT_EQ(scene.shapes.size(), 2u);
  EXPECT_THAT(scene.warnings, IsEmpty());
  EXPECT_THAT(toml_error(mark + "[input\n"), HasSubstr("scene.toml:1:7: error: "));
  write("m.mtl", mark + "Kd .5 .5 .5\n");
  EXPECT_THAT(toml_error(scene_with(kDirect)), HasSubstr("m.mtl:1:1: error: Kd before any newmtl"));
  const std::string utf16("\xFF\xFEn\0e\0w\0", 8);
  write("m.mtl", utf16);
  EXPECT_THAT(toml_error(scene_with(kDirect)), HasSubstr("m.mtl' is UTF-16 text; save it as UTF-8"));
  write("m.obj", std::string("\xFE\xFF\0v", 4));
  EXPECT_THAT(toml_error(scene_with(kDirect)), HasSubstr("m.obj' is UTF-16 text; save it as UTF-8"));
  EXPECT_THAT(toml_error(utf16), HasSubstr("scene.toml' is UTF-16 text; save it as UTF-8"));
  EXPECT_THAT(toml_error(std::string("\xFF\xFE\0\0[\0\0\0", 8)),
              HasSubstr("scene.toml' is UTF-32 text; save it as UTF-8"));
}

TEST_F(TinyRenderToml, ColumnsAreOfCodePoints) {
  EXPECT_THAT(toml_error(scene_with("type = \"dïrëct\"\n\"schön\" = 1")),
              HasSubstr("scene.toml:11:8: error: renderer type 'dïrëct'"));
  EXPECT_THAT(toml_error(scene_with("type = \"direct\"\n\"schön\" = true # é") + "x\"é\" = 1"),
              HasSubstr("scene.toml:13:2: error: not TOML"));
}

TEST_F(TinyRenderToml, FormatIsToldByNameOrContent) {
  write("m.obj", kModel);
  write("m.mtl", kMaterials);
  for (const std::string head :
       {"", "  \n\n", "# a comment [\n\n  # <another>\r\n\t", "\xEF\xBB\xBF", "\xEF\xBB\xBF#\n", "#\n#\n"}) {
    for (const char* name : {"a", "a.TOML", "a.scene"}) {
      write(name, head + scene_with(kDirect));
      const auto scene = read_scene(folder_ / name, {});
      ASSERT_TRUE(scene) << scene.error().message;
      EXPECT_EQ(scene->shapes.size(), 2u);
      EXPECT_EQ(scene->source, (folder_ / name).string());
    }
  }
}

TEST_F(TinyRenderToml, SettingsAndDefines) {
  const SceneDescription scene =
      good_toml(scene_with(kDirect),
                {.settings = {{"integrator.type", "path"}, {"film.width", "64"}, {"camera.fov", "10"}}});
  EXPECT_EQ(kind_of(scene.integrator), IntegratorKind::kPath);
  EXPECT_EQ(scene.film.crop_width, 64);
  EXPECT_EQ(scene.camera.fov, 10.0);
  EXPECT_THAT(toml_error(scene_with(kDirect), {.defines = {{"a", "1"}}}),
              HasSubstr("-D a: a TinyRender scene has no variables"));
  // Settings may put right what the file has wrong about them together.
  EXPECT_TRUE(read_toml(scene_with("type = \"direct\"\nemitterSamples = 0\nbsdfSamples = 0"),
                        {.settings = {{"integrator.emitter_samples", "2"}}}));
}

TEST_F(TinyRenderToml, FilesAreConfined) {
  const std::string inside = folder_.path().string();
  EXPECT_TRUE(read_toml(scene_with(kDirect), {.confine_to = inside}));
  std::string outside = scene_with(kDirect);
  outside.replace(outside.find("m.obj"), 5, "../m.obj");
  EXPECT_THAT(toml_error(outside, {.confine_to = inside}), HasSubstr("'../m.obj' leads outside the folder"));
  use("mtllib /etc/passwd\n");
  EXPECT_THAT(toml_error(scene_with(kDirect), {.confine_to = inside}),
              HasSubstr("m.obj:1:8: error: '/etc/passwd' leads outside the folder"));
}

}  // namespace
}  // namespace penumbra
