// Tests `penumbra render --layers`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "scheduler/image/image.h"
#include "tests/scheduler/cli/killed_render.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class LayersOfRender : public ::testing::Test {
 protected:
  void SetUp() override { write_small_scene(folder_ / "s.xml"); }

  void succeed(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"render", "s.xml"});
    const ProgramResult result = run_penumbra(folder_.path(), arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
  }
  Image image(const std::string& name) {
    auto read = read_image(folder_ / name);
    EXPECT_TRUE(read) << read.error().message;
    return read.value_or(Image{});
  }
  std::string error(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "render");
    const ProgramResult result = run_penumbra(folder_.path(), arguments);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    return result.err;
  }

  TemporaryFolder folder_;
};

constexpr const char* kAllLayers = "position,uv,geometric_normal,shape,direct,indirect";

TEST_F(LayersOfRender, AreThoseThatAreAskedFor) {
  succeed({"--layers", "shape,uv", "-o", "a.exr"});
  succeed({"-o", "plain.exr"});
  EXPECT_THAT(image("a.exr").channels,
              AllOf(Contains("uv.U"), Contains("uv.V"), Contains("shape.ID"), Not(Contains("position.X"))));
  EXPECT_EQ(image("a.exr").channels.size(), image("plain.exr").channels.size() + 3);
  // The record repeats it, in one spelling.
  EXPECT_THAT(std::get<std::string>(*image("a.exr").attribute("penumbra:command")),
              HasSubstr("--layers uv,shape"));
  EXPECT_THAT(std::get<std::string>(*image("plain.exr").attribute("penumbra:command")),
              Not(HasSubstr("layers")));
}

TEST_F(LayersOfRender, DoNotDependOnWorkersAndTiles) {
  succeed({"--layers", kAllLayers, "-o", "a.exr"});
  succeed({"--layers", kAllLayers, "-o", "b.exr", "--workers", "3", "--threads", "1", "--tile", "8"});
  EXPECT_EQ(image("b.exr").values, image("a.exr").values);
  succeed({"--layers", kAllLayers, "-o", "passes.exr", "--pass", "3"});
  const Image passes = image("passes.exr"), whole = image("a.exr");
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x)
      for (std::size_t c = 0; c < whole.channels.size(); ++c)
        ASSERT_NEAR(passes.at(x, y, c), whole.at(x, y, c), 2e-6 * (1 + std::abs(whole.at(x, y, c))))
            << whole.channels[c];
  // Both are there: the floor and the lamp.
  const std::size_t shape = *whole.channel("shape.ID");
  int seen[3] = {};
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x) ++seen[int(whole.at(x, y, shape))];
  EXPECT_GT(seen[0], 20);
  EXPECT_GT(seen[1], 20);
}

TEST_F(LayersOfRender, WithAdaptiveSamplingTheyDoNotDependOnWorkers) {
  const std::vector<std::string> adaptive = {"--layers", kAllLayers, "--adaptive", "--spp",
                                             "16",       "--tile",   "8",          "-o"};
  auto one = adaptive, three = adaptive;
  one.insert(one.end(), {"a.exr"});
  three.insert(three.end(), {"b.exr", "--workers", "3", "--threads", "1"});
  succeed(one);
  succeed(three);
  EXPECT_EQ(image("b.exr").values, image("a.exr").values);
  const Image adapted = image("a.exr");
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x) {
      const float shape = adapted.at(x, y, *adapted.channel("shape.ID"));
      ASSERT_TRUE(shape == 0 || shape == 1 || shape == 2) << shape;
    }
}

TEST_F(LayersOfRender, SurviveAnInterruption) {
  const std::vector<std::string> options = {"--layers", kAllLayers, "--spp", "4096"};
  auto killed = kManyUnits, whole = options;
  killed.insert(killed.begin(), options.begin(), options.end());
  killed.insert(killed.begin(), {"s.xml"});
  killed.insert(killed.begin(), {"render"});
  killed.insert(killed.end(), {"-o", "a.exr"});
  kill_after(folder_.path(), killed, "a.exr.checkpoint", std::chrono::milliseconds(20));
  const ProgramResult resumed = run_penumbra(folder_.path(), killed);
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  whole.insert(whole.end(), {"--pass", "32", "-o", "b.exr"});
  succeed(whole);
  EXPECT_EQ(image("a.exr").values, image("b.exr").values);
}

TEST_F(LayersOfRender, OfAMitsubaSceneAreThoseOfItsAov) {
  std::string text = file_contents(folder_ / "s.xml");
  const std::string path = "<integrator type=\"path\"/>";
  text.replace(text.find(path), path.size(),
               "<integrator type=\"aov\"><string name=\"aovs\" value=\"dd.y:depth, nn:sh_normal, "
               "pos:position, id:shape_index\"/>" +
                   path + "</integrator>");
  write_text(folder_ / "s.xml", text);
  succeed({"-o", "a.exr"});
  EXPECT_THAT(image("a.exr").channels, AllOf(Contains("depth.Z"), Contains("position.Y"),
                                             Contains("shape.ID"), Not(Contains("uv.U"))));
  succeed({"-o", "b.exr", "--layers", "none"});
  EXPECT_THAT(image("b.exr").channels, Not(Contains("position.Y")));
  const ProgramResult info = run_penumbra(folder_.path(), {"info", "s.xml"});
  EXPECT_THAT(info.out, HasSubstr("position,shape"));
}

TEST_F(LayersOfRender, AJobFileHasThem) {
  write_text(folder_ / "j.toml",
             "[[render]]\nscene = \"s.xml\"\nspp = 1\nout = \"a.exr\"\nlayers = \"uv,direct\"\n");
  const ProgramResult result = run_penumbra(folder_.path(), {"render", "j.toml", "-q"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(image("a.exr").channels, AllOf(Contains("uv.V"), Contains("direct.R")));
}

TEST_F(LayersOfRender, WhatCannotWorkIsSaid) {
  EXPECT_THAT(error({"s.xml", "--layers", "posiion"}),
              AllOf(HasSubstr("film.layers"), HasSubstr("'posiion' is not one of: position, uv"),
                    HasSubstr("did you mean 'position'")));
  EXPECT_THAT(error({"s.xml", "--layers", "uv,,shape"}), HasSubstr("film.layers"));
  EXPECT_THAT(
      error({"s.xml", "--layers", "direct", "--integrator", "whitted"}),
      AllOf(HasSubstr("s.xml"), HasSubstr("integrator 'whitted' does not tell direct from indirect")));
  EXPECT_THAT(error({"s.xml", "--layers", "uv", "--set", "film.layers=shape"}), HasSubstr("contradict"));
}

}  // namespace
}  // namespace penumbra
