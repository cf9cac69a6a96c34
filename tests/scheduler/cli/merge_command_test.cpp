// Tests `penumbra merge` with renders of a small scene.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scheduler/image/image.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::merge_command_test {
namespace {

using ::testing::HasSubstr;

using Arguments = std::vector<std::string>;

class MergeCommand : public ::testing::Test {
 protected:
  MergeCommand() { write_small_scene(folder_ / "s.xml"); }
  ProgramResult run(Arguments arguments) { return run_penumbra(folder_.path(), arguments); }
  void render(const std::string& out, const Arguments& more) {
    Arguments arguments = {"render", "s.xml", "-q", "-o", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult done = run(arguments);
    ASSERT_EQ(done.exit_code, 0) << done.err;
  }
  Image read(const std::string& name) {
    auto image = read_image(folder_ / name);
    EXPECT_TRUE(image) << image.error().message;
    return image.value_or(Image{});
  }
  TemporaryFolder folder_;
};

/// Renders of one sample are samples, whose variance everybody can compute.
TEST_F(MergeCommand, OfSingleSamplesHasTheirMeanAndVarianceInAnyOrder) {
  std::vector<Image> samples;
  Arguments files;
  for (const char* seed : {"1", "2", "3", "4"}) {
    const std::string file = std::string(seed) + ".exr";
    render(file, {"--seed", seed, "--spp", "1"});
    samples.push_back(read(file));
    files.push_back(file);
  }
  std::string bytes;
  for (const auto& order : {std::array{0, 1, 2, 3}, {3, 2, 1, 0}, {1, 3, 0, 2}, {2, 0, 3, 1}}) {
    Arguments arguments = {"merge", "-o", "m.exr"};
    for (const int k : order) arguments.push_back(files[std::size_t(k)]);
    const ProgramResult done = run(arguments);
    ASSERT_EQ(done.exit_code, 0) << done.err;
    EXPECT_EQ(done.out, "wrote m.exr, m.png, m.json: 4 images of seeds 1, 2, 3, 4, 4 samples per pixel\n");
    if (bytes.empty()) bytes = file_contents(folder_ / "m.exr");
    ASSERT_TRUE(file_contents(folder_ / "m.exr") == bytes) << "another order";
  }
  const Image merged = read("m.exr");
  const std::size_t variance = *merged.channel("variance.R"), counts = *merged.channel("samples.Y");
  for (int y = 0; y < merged.data.height; ++y)
    for (int x = 0; x < merged.data.width; ++x) {
      long double mean = 0, squares = 0;
      for (const Image& sample : samples) mean += sample.at(x, y, *sample.channel("R")) / 4.0L;
      for (const Image& sample : samples)
        squares += std::pow(sample.at(x, y, *sample.channel("R")) - mean, 2.0L);
      ASSERT_NEAR(merged.at(x, y, *merged.channel("R")), mean, mean * 0x1p-23L);
      ASSERT_NEAR(merged.at(x, y, variance), squares / 3 / 4, squares * 0x1p-23L);
      ASSERT_EQ(merged.at(x, y, counts), 4);
    }
  const auto json = nlohmann::json::parse(file_contents(folder_ / "m.json"));
  EXPECT_EQ(json["samples"]["total"], 4 * 24 * 20);
  EXPECT_EQ(json["merged"][3]["file"], "4.exr");
  EXPECT_EQ(json["merged"][3]["seeds"], nlohmann::json::array({4}));
  EXPECT_EQ(json["complete"], true);
}

/// With the same samples in both, a merged image and one render have equal means up to noise.
TEST_F(MergeCommand, IsComparedLikeAnyRender) {
  render("a.exr", {"--seed", "1", "--spp", "128"});
  render("b.exr", {"--seed", "2", "--spp", "64", "--stop-after", "40"});
  render("c.exr", {"--seed", "3", "--spp", "256"});
  ASSERT_EQ(run({"merge", "a.exr", "b.exr", "-o", "new/m.exr"}).exit_code, 0);
  const ProgramResult compared = run({"compare", "new/m.exr", "c.exr", "--z-test"});
  EXPECT_EQ(compared.exit_code, 0) << compared.out << compared.err;
  EXPECT_EQ(read("new/m.exr").at(3, 3, *read("new/m.exr").channel("samples.Y")), 168);
  EXPECT_EQ(read("new/m.exr").attribute("penumbra:seeds"), MetadataValue("1, 2"));
}

TEST_F(MergeCommand, KeepsEveryLayerAndTheFormat) {
  const Arguments layers = {"--spp",         "3",
                            "--cryptomatte", "--denoise=layers",
                            "--set",         "film.pixel_format=rgba",
                            "--set",         "film.compression=zips",
                            "--crop",        "4,4,20,16"};
  Arguments first = layers, second = layers;
  first.insert(first.end(), {"--seed", "8"});
  second.insert(second.end(), {"--seed", "9", "--backend", "native", "--tile", "32"});
  render("a.exr", first);
  render("b.exr", second);
  const ProgramResult done = run({"merge", "b.exr", "a.exr", "-o", "m.exr", "--no-statistics"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(done.err, "");
  const Image a = read("a.exr"), b = read("b.exr"), m = read("m.exr");
  EXPECT_EQ(m.channels, a.channels);
  EXPECT_EQ(m.data, a.data);
  EXPECT_EQ(m.display, a.display);
  EXPECT_EQ(m.camera, a.camera);
  EXPECT_EQ(m.attribute("compression"), MetadataValue("zips"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "m.json"));
  for (const char* mean : {"A", "albedo.G", "normal.Y", "depth.Z"}) {
    const std::size_t c = *m.channel(mean);
    for (int x = 0; x < m.data.width; ++x) {
      const double expected = (double(a.at(x, 5, c)) + b.at(x, 5, c)) / 2;
      EXPECT_NEAR(m.at(x, 5, c), expected, std::abs(expected) * 0x1p-23) << mean;
    }
  }
}

TEST_F(MergeCommand, WhatDoesNotBelongTogetherIsRefusedAndLeavesNothing) {
  render("a.exr", {"--seed", "1", "--spp", "2"});
  render("same.exr", {"--seed", "1", "--spp", "4"});
  render("depth.exr", {"--seed", "2", "--spp", "2", "--set", "integrator.max_depth=2"});
  render("define.exr", {"--seed", "2", "--spp", "2", "-D", "albedo=0.25"});
  render("crop.exr", {"--seed", "2", "--spp", "2", "--crop", "0,0,8,8"});
  const std::vector<std::string> before = folder_.names();
  for (const auto& [other, why] :
       {std::pair("same.exr", "both have the samples of seed 1"),
        std::pair("a.exr", "both have the samples of seed 1"),
        std::pair("depth.exr", "differ in integrator.max_depth: a.exr has -1, depth.exr has 2"),
        std::pair("define.exr", "differ in defines: a.exr has none, define.exr has albedo=0.25"),
        std::pair("crop.exr", "differ in crop"),
        std::pair("a.png", "cannot be merged without the channels variance.R"),
        std::pair("none.exr", "none.exr: no such file"), std::pair("s.xml", "cannot be read as an image")}) {
    const ProgramResult done = run({"merge", "a.exr", other, "-o", "new/m.exr"});
    EXPECT_EQ(done.exit_code, 2) << other;
    EXPECT_THAT(done.err, HasSubstr(why));
    EXPECT_EQ(folder_.names(), before);
  }
  EXPECT_THAT(run({"merge", "a.exr", "-o", "m.exr"}).err, HasSubstr("two images or more"));
  EXPECT_THAT(run({"merge", "a.exr", "crop.exr", "-o", "a.exr"}).err, HasSubstr("a.exr is an input"));
  EXPECT_THAT(run({"merge", "a.exr", "crop.exr", "-o", "m.tif"}).err, HasSubstr("must end in .exr or .png"));
  EXPECT_EQ(run({"merge", "a.exr", "crop.exr"}).exit_code, 2) << "-o is needed";
}

}  // namespace
}  // namespace penumbra::merge_command_test
