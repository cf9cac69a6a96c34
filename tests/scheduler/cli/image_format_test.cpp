// Image files as other programs read them, through OpenImageIO's tools: alpha, half floats, compression,
// attributes. Also tests which files Penumbra reads back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "scheduler/image/image.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class ImageFormat : public ::testing::Test {
 protected:
  void SetUp() override { write_small_scene(folder_ / "s.xml"); }

  void render(const std::string& out, const std::vector<std::string>& settings = {},
              const std::string& scene = "s.xml") {
    std::vector<std::string> arguments{"render", scene, "-o", out, "-q", "--no-statistics"};
    for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
    const ProgramResult result = run_penumbra(folder_.path(), arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    warned_ = result.err;
  }
  Image image(const std::string& name) {
    auto read = read_image(folder_ / name);
    EXPECT_TRUE(read) << read.error().message;
    return read.value_or(Image{});
  }
  ProgramResult shell(const std::string& line) { return run_shell(folder_.path(), line); }
  bool has_tools() { return shell("command -v oiiotool idiff").exit_code == 0; }

  TemporaryFolder folder_;
  std::string warned_;
};

TEST_F(ImageFormat, AlphaIsAChannelOfTheFileAndOfThePicture) {
  render("rgb.exr");
  render("rgba.exr", {"film.pixel_format=rgba"});
  const Image rgb = image("rgb.exr"), rgba = image("rgba.exr"), png = image("rgba.png");
  EXPECT_FALSE(rgb.channel("A"));
  ASSERT_TRUE(rgba.channel("A"));
  EXPECT_THAT(png.channels, ElementsAre("R", "G", "B", "A"));
  EXPECT_EQ(image("rgb.png").channels.size(), 3u);
  EXPECT_EQ(rgba.attribute("penumbra:film.pixel_format"), MetadataValue("rgba"));
  int partly = 0;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x) {
      for (const char* channel : {"R", "G", "B", "depth.Z", "variance.G"})
        EXPECT_EQ(rgba.at(x, y, *rgba.channel(channel)), rgb.at(x, y, *rgb.channel(channel))) << channel;
      const float alpha = rgba.at(x, y, *rgba.channel("A"));
      EXPECT_GE(alpha, 0.0f);
      EXPECT_LE(alpha, 1.0f);
      if (alpha == 0.0f) EXPECT_EQ(rgba.at(x, y, *rgba.channel("R")), 0.0f) << "premultiplied";
      EXPECT_EQ(alpha > 0, rgba.at(x, y, *rgba.channel("depth.Z")) > 0) << x << ',' << y;
      EXPECT_NEAR(png.at(x, y, 3), alpha, 0.5001 / 255);
      partly += alpha > 0 && alpha < 1 ? 1 : 0;
    }
  EXPECT_GT(partly, 10);
}

TEST_F(ImageFormat, ScenesSayItToo) {
  std::string scene = file_contents(folder_ / "s.xml");
  const std::string film = "<film type=\"hdrfilm\">";
  scene.insert(scene.find(film) + film.size(),
               "<string name=\"pixel_format\" value=\"rgba\"/>"
               "<string name=\"component_format\" value=\"float16\"/>");
  write_text(folder_ / "t.xml", scene);
  render("t.exr", {}, "t.xml");
  EXPECT_TRUE(image("t.exr").channel("A"));
  EXPECT_EQ(image("t.exr").attribute("penumbra:film.component_format"), MetadataValue("float16"));
  render("u.exr", {"film.pixel_format=rgb"}, "t.xml");
  EXPECT_FALSE(image("u.exr").channel("A"));
}

TEST_F(ImageFormat, IsRepeatedByteForByte) {
  const std::vector<std::string> settings{"film.pixel_format=rgba", "film.component_format=float16",
                                          "film.compression=piz"};
  render("a.exr", settings);
  const Image a = image("a.exr");
  EXPECT_EQ(a.attribute("compression"), MetadataValue("piz"));
  const std::string command = std::get<std::string>(a.attribute("penumbra:command").value_or("none"));
  EXPECT_EQ(shell(command + " -o b.exr -q --tile 8").exit_code, 0);
  EXPECT_EQ(file_contents(folder_ / "b.exr"), file_contents(folder_ / "a.exr"));
  EXPECT_EQ(file_contents(folder_ / "b.png"), file_contents(folder_ / "a.png"));
}

TEST_F(ImageFormat, WrongOnesAreRefused) {
  for (const char* setting :
       {"film.pixel_format=cmyk", "film.component_format=float8", "film.compression=gzip"}) {
    const ProgramResult result = run_penumbra(folder_.path(), {"render", "s.xml", "--set", setting});
    EXPECT_EQ(result.exit_code, 2) << setting;
    const std::string key = std::string(setting).substr(0, std::string(setting).find('='));
    EXPECT_THAT(result.err, HasSubstr("setting " + key)) << setting;
  }
}

TEST_F(ImageFormat, HalvesAreComparedAsEver) {
  render("a.exr");
  render("h.exr", {"film.component_format=float16", "film.pixel_format=rgba"});
  const ProgramResult beauty =
      run_penumbra(folder_.path(), {"compare", "h.exr", "a.exr", "--fail-above", "relmse=1e-6"});
  EXPECT_EQ(beauty.exit_code, 0) << beauty.out << beauty.err;
  for (const char* layer : {"variance", "depth", "samples"}) {
    const ProgramResult same = run_penumbra(
        folder_.path(), {"compare", "h.exr", "a.exr", "--layer", layer, "--fail-above", "mse=0"});
    EXPECT_EQ(same.exit_code, 0) << layer << same.out << same.err;
  }
  const ProgramResult alpha =
      run_penumbra(folder_.path(), {"compare", "h.exr", "h.exr", "--layer", "A", "--fail-above", "mse=0"});
  EXPECT_EQ(alpha.exit_code, 0) << alpha.out << alpha.err;
}

TEST_F(ImageFormat, WhatHalvesCannotHoldIsSaid) {
  std::string scene = file_contents(folder_ / "s.xml");
  scene.replace(scene.find("4, 3, 2"), 7, "4e7, 3, 2");
  write_text(folder_ / "t.xml", scene);
  render("t.exr", {"film.component_format=float16"}, "t.xml");
  EXPECT_THAT(warned_, AllOf(HasSubstr("more than 16 bits hold"), HasSubstr("t.exr")));
  const Image t = image("t.exr");
  float most = 0;
  for (std::size_t i = *t.channel("R"); i < t.values.size(); i += t.channels.size())
    most = std::max(most, t.values[i]);
  EXPECT_EQ(most, 65504.0f);
}

/// What stands behind `name: ` in oiiotool's list, or nothing.
std::string attribute(const std::string& info, const std::string& name) {
  std::istringstream lines(info);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t at = line.find(name + ": ");
    if (at != std::string::npos && line.find_first_not_of(' ') == at)
      return line.substr(at + name.size() + 2);
  }
  return "";
}

TEST_F(ImageFormat, OpenImageIoReadsAttributesAndChannels) {
  if (!has_tools()) GTEST_SKIP() << "OpenImageIO's tools are not installed";
  render("a.exr", {"film.pixel_format=rgba", "film.component_format=float16", "sampler.seed=7"});
  const ProgramResult listed = shell("oiiotool --info -v a.exr");
  ASSERT_EQ(listed.exit_code, 0) << listed.err;
  EXPECT_EQ(attribute(listed.out, "chromaticities"), "0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329");
  EXPECT_EQ(attribute(listed.out, "penumbra:spp"), "8") << "a number has no quotes";
  EXPECT_EQ(attribute(listed.out, "penumbra:seed"), "7");
  EXPECT_EQ(attribute(listed.out, "penumbra:film.width"), "24");
  EXPECT_EQ(attribute(listed.out, "penumbra:samples_per_pass"), "16");
  EXPECT_EQ(attribute(listed.out, "penumbra:backend"), "\"native\"");
  EXPECT_THAT(attribute(listed.out, "worldToCamera"), Not("")) << listed.out;
  EXPECT_THAT(attribute(listed.out, "worldToNDC"), Not("")) << listed.out;
  EXPECT_THAT(listed.out, HasSubstr("R (half), G (half), B (half), A (half)"));
  EXPECT_THAT(listed.out, AllOf(HasSubstr("depth.Z (float)"), HasSubstr("albedo.R (half)")));
  EXPECT_EQ(shell("oiiotool a.exr --ch R,G,B,A -o beauty.tif && oiiotool --stats beauty.tif").exit_code, 0);
}

TEST_F(ImageFormat, IdiffFindsNoDifferenceBetweenCompressions) {
  if (!has_tools()) GTEST_SKIP() << "OpenImageIO's tools are not installed";
  render("zip.exr");
  for (const char* compression : {"none", "rle", "zips", "piz"}) {
    const std::string file = std::string(compression) + ".exr";
    render(file, {std::string("film.compression=") + compression});
    const ProgramResult same = shell("idiff zip.exr " + file);
    EXPECT_EQ(same.exit_code, 0) << compression << same.out << same.err;
  }
  render("dwaa.exr", {"film.compression=dwaa"});
  EXPECT_THAT(shell("idiff -fail 0.01 -failpercent 100 -hardfail 0.5 zip.exr dwaa.exr").out,
              HasSubstr("Mean error"));
}

/// One letter for each channel: all that tev, Nuke and Blender take for a part of a colour or of a vector.
TEST_F(ImageFormat, LayersHaveChannelsOfOneLetter) {
  render("a.exr", {"film.pixel_format=rgba"});
  for (const std::string& name : image("a.exr").channels) {
    const std::size_t dot = name.rfind('.');
    const std::string channel = dot == std::string::npos ? name : name.substr(dot + 1);
    EXPECT_EQ(channel.size(), 1u) << name;
    EXPECT_NE(std::string("RGBAXYZ").find(channel), std::string::npos) << name;
  }
}

TEST_F(ImageFormat, AutoSaysWhatRendered) {
  ASSERT_EQ(run_penumbra(folder_.path(), {"render", "s.xml", "--backend", "auto", "-q"}).exit_code, 0);
  const auto by = image("s.exr").attribute("penumbra:rendered_by");
  ASSERT_TRUE(by);
  EXPECT_THAT(std::get<std::string>(*by), testing::AnyOf("native", "opencl"));
  render("a.exr");
  EXPECT_FALSE(image("a.exr").attribute("penumbra:rendered_by")) << "the command says it";
}

}  // namespace
}  // namespace penumbra
