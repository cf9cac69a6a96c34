// Tests `penumbra compare` from its input files to its exit code.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "kernels/host/atomic_file.h"
#include "scheduler/image/image_files.h"
#include "scheduler/image/tone_map.h"
#include "tests/scheduler/cli/moving_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Image flat(int width, int height, float value) {
  Image image;
  image.data = image.display = {0, 0, width, height};
  image.channels = {"R", "G", "B"};
  image.values.assign(image.pixels() * 3, value);
  return image;
}

/// Mean `mean`, with the variance of its values beside them, as a render has it.
Image noisy(float mean, std::uint32_t seed) {
  constexpr float kDeviation = 0.1f;
  Image image = flat(40, 40, 0);
  image.channels = {"R", "G", "B", "variance.R", "variance.G", "variance.B"};
  image.values.clear();
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(mean, kDeviation);
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    for (int c = 0; c < 3; ++c) image.values.push_back(normal(random));
    image.values.insert(image.values.end(), 3, kDeviation * kDeviation);
  }
  return image;
}

class CompareCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    write("one.exr", flat(4, 3, 1.0f));
    write("more.exr", flat(4, 3, 1.5f));
    write("small.exr", flat(2, 3, 1.0f));
    ASSERT_TRUE(write_file_atomically(folder_ / "one.png", *encode_png(flat(4, 3, 1.0f))));
    ASSERT_TRUE(write_file_atomically(folder_ / "grey.png", *encode_png(flat(4, 3, 0.5f))));
    write_text(folder_ / "text.exr", "no image");
  }
  void write(const std::string& name, const Image& image) {
    ASSERT_TRUE(write_file_atomically(folder_ / name, *encode_exr(image)));
  }
  ProgramResult compare(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "compare");
    return run_penumbra(folder_.path(), arguments);
  }
  TemporaryFolder folder_;
};

TEST_F(CompareCommand, PrintsTheMetrics) {
  const ProgramResult result = compare({"more.exr", "one.exr"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("relMSE             0.247525"), HasSubstr("MSE                    0.25"),
                    HasSubstr("SMAPE              0.199203"), HasSubstr("max |d|                 0.5"),
                    HasSubstr("R at pixel 0,0"), HasSubstr("HDR-FLIP"), HasSubstr("z-test")));
}

TEST_F(CompareCommand, PrintsJson) {
  for (const auto& arguments :
       std::vector<std::vector<std::string>>{{"more.exr", "one.exr", "--json"},
                                             {"more.exr", "one.exr", "--json", "-"},
                                             {"more.exr", "--json", "one.exr"},
                                             {"--json", "-", "more.exr", "one.exr"}}) {
    const ProgramResult result = compare(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const auto report = json::parse(result.out);
    EXPECT_DOUBLE_EQ(report["relmse"], 0.25 / 1.01);
    EXPECT_EQ(report["mse"], 0.25);
    EXPECT_EQ(report["per_channel"]["bias"], (std::vector<double>{0.5, 0.5, 0.5}));
    EXPECT_EQ(report["mean_ratio"], (std::vector<double>{1.5, 1.5, 1.5}));
    EXPECT_EQ(report["compared_pixels"], 12);
    EXPECT_EQ(report["image"], "more.exr");
    EXPECT_EQ(report["passed"], true);
  }
}

TEST_F(CompareCommand, WritesJsonBesideTheTable) {
  const ProgramResult result =
      compare({"more.exr", "one.exr", "--json", "out.json", "--fail-above", "max=0.4"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.out, HasSubstr("relMSE"));
  const auto report = json::parse(file_contents(folder_ / "out.json"));
  EXPECT_EQ(report["passed"], false);
  EXPECT_EQ(report["limits"][0],
            (json{{"metric", "max"}, {"limit", 0.4}, {"value", 0.5}, {"exceeded", true}}));
}

TEST_F(CompareCommand, ReadsOtherFormats) {
  EXPECT_EQ(json::parse(compare({"grey.png", "one.png", "--json"}).out)["flip"]["kind"], "LDR");
  EXPECT_EQ(json::parse(compare({"grey.png", "one.png", "--json", "--flip", "hdr"}).out)["flip"]["kind"],
            "HDR");
  const double far =
      json::parse(compare({"grey.png", "one.png", "--json", "--ppd", "30"}).out)["flip"]["pixels_per_degree"];
  EXPECT_EQ(far, 30);
}

TEST_F(CompareCommand, AnExrAndAPngAreComparedAsSrgb) {
  const ProgramResult mixed = compare({"one.png", "one.exr"});
  EXPECT_EQ(mixed.exit_code, 2);
  EXPECT_THAT(mixed.err, AllOf(HasSubstr("cannot compare one.png with one.exr"), HasSubstr("--ldr")));
  // A gradient beyond white, with and without alpha, against the PNG that a render writes of it.
  for (const bool alpha : {false, true}) {
    Image image = flat(64, 2, 0);
    if (alpha) image.channels.emplace_back("A");
    image.values.clear();
    for (int pixel = 0; pixel < 128; ++pixel) {
      const float x = float(pixel) / 100, covered = alpha ? float(pixel % 7) / 6 : 1;
      image.values.insert(image.values.end(), {x * covered, 0.5f * x * covered, x * x * covered});
      if (alpha) image.values.push_back(covered);
    }
    write("g.exr", image);
    ASSERT_TRUE(write_file_atomically(folder_ / "g.png", *encode_png(image)));
    const ProgramResult same = compare({"g.exr", "g.png", "--ldr", "--json", "--fail-above", "max=0"});
    EXPECT_EQ(same.exit_code, 0) << same.err;
    const auto report = json::parse(same.out);
    EXPECT_EQ(report["max"], 0);
    EXPECT_EQ(report["flip"]["kind"], "LDR");
    EXPECT_EQ(report["verdict"], "agree");
    EXPECT_EQ(compare({"g.png", "g.exr", "--ldr", "--fail-above", "max=0"}).exit_code, 0);
  }
  // 0.5 is 188 of 255 in sRGB.
  const auto half = json::parse(compare({"grey.png", "one.exr", "--ldr", "--json"}).out);
  EXPECT_NEAR(half["max"], 67.0 / 255, 1e-6);
  EXPECT_EQ(half["verdict"], "inconclusive");
  EXPECT_THAT(half["verdict_reason"], HasSubstr("8-bit images have no variances"));
  EXPECT_EQ(compare({"one.png", "one.exr", "--ldr", "--z-test"}).exit_code, 2);
}

TEST_F(CompareCommand, LimitsDecideTheExitCode) {
  EXPECT_EQ(compare({"more.exr", "one.exr", "--tolerance", "0.25"}).exit_code, 0);
  const ProgramResult result = compare({"more.exr", "one.exr", "--tolerance", "0.24"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("relmse 0.247525 is above the limit 0.24"));
  EXPECT_EQ(compare({"more.exr", "one.exr", "--fail-above", "mse=0.25", "--fail-above", "max=0.5"}).exit_code,
            0);
  const ProgramResult both =
      compare({"more.exr", "one.exr", "--fail-above", "mse=0.2", "--fail-above", "max=0.4"});
  EXPECT_EQ(both.exit_code, 1);
  EXPECT_THAT(both.err, AllOf(HasSubstr("mse 0.25"), HasSubstr("max 0.5")));
  EXPECT_EQ(compare({"one.exr", "one.exr", "--fail-above", "mse=0", "--fail-above", "flip=0"}).exit_code, 0);
}

TEST_F(CompareCommand, NonFinitePixelsFailAnyLimit) {
  Image image = flat(4, 3, 1.0f);
  image.values[5] = std::numeric_limits<float>::quiet_NaN();
  write("nan.exr", image);
  const ProgramResult plain = compare({"nan.exr", "one.exr"});
  EXPECT_EQ(plain.exit_code, 0);
  EXPECT_THAT(plain.out, HasSubstr("1 pixels of A, 0 of B; 11 of 12 compared"));
  for (const auto& [a, b] : {std::pair("nan.exr", "one.exr"), std::pair("one.exr", "nan.exr")}) {
    const ProgramResult limited = compare({a, b, "--fail-above", "mse=1"});
    EXPECT_EQ(limited.exit_code, 1);
    EXPECT_THAT(limited.err, HasSubstr("pixels that are NaN or infinite"));
  }
}

TEST_F(CompareCommand, TheZTestTellsNoiseFromDifference) {
  write("a.exr", noisy(1.0f, 1));
  write("b.exr", noisy(1.0f, 2));
  write("c.exr", noisy(1.02f, 3));
  const ProgramResult same = compare({"a.exr", "b.exr", "--z-test"});
  EXPECT_EQ(same.exit_code, 0) << same.out;
  EXPECT_THAT(same.out, HasSubstr("verdict: the images agree within their noise, at significance 0.01: "));
  const ProgramResult other = compare({"a.exr", "c.exr", "--z-test"});
  EXPECT_EQ(other.exit_code, 1) << other.out;
  EXPECT_THAT(other.err, HasSubstr("the images differ by more than their noise"));
  EXPECT_EQ(compare({"a.exr", "c.exr", "--fail-above", "mean_z=20"}).exit_code, 0);
  const auto report = json::parse(compare({"a.exr", "b.exr", "--json", "--block", "8"}).out)["z_test"];
  EXPECT_EQ(report["consistent"], true);
  EXPECT_TRUE(report["image_samples"].is_null());
  EXPECT_GT(report["visible_image_difference"], 0.001);
  EXPECT_LT(report["visible_image_difference"], 0.1);
  EXPECT_EQ(report["blocks"], 3 * 25);
  // Of deviation 0.1 in a file of its own, instead of 0.1 sqrt(2) from both: noise is then too large.
  write("variance.exr", flat(40, 40, 0.005f));
  EXPECT_EQ(compare({"a.exr", "b.exr", "--variance", "variance.exr", "--reference-variance", "variance.exr",
                     "--z-test"})
                .exit_code,
            1);
  // Whether it is a difference is not known, so it is no success either.
  write("plain.exr", flat(40, 40, 1.1f));
  const ProgramResult unknown = compare({"a.exr", "plain.exr", "--z-test"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.err,
              AllOf(HasSubstr("is inconclusive: B has no variances"), HasSubstr("--exact-reference")));
  EXPECT_EQ(compare({"a.exr", "plain.exr"}).exit_code, 0);
  EXPECT_THAT(compare({"a.exr", "plain.exr", "--z-test", "--exact-reference"}).err,
              HasSubstr("the images differ"));
  // Errors of the command, not findings.
  const ProgramResult none = compare({"one.exr", "one.exr", "--z-test"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, AllOf(HasSubstr("neither image has a variance"), HasSubstr("--variance")));
  EXPECT_EQ(compare({"one.exr", "one.exr", "--fail-above", "max_z=4"}).exit_code, 2);
}

TEST_F(CompareCommand, SeveralImagesAreComparedWithTheLast) {
  const ProgramResult text = compare({"more.exr", "one.exr", "one.exr"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out,
              AllOf(HasSubstr("more.exr against one.exr\n"), HasSubstr("\none.exr against one.exr\n")));
  const ProgramResult result =
      compare({"more.exr", "one.exr", "one.exr", "--fail-above", "relmse=0.01", "--json"});
  EXPECT_EQ(result.exit_code, 1);
  const auto json = nlohmann::json::parse(result.out);
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0]["image"], "more.exr");
  EXPECT_GT(json[0]["relmse"], 0.01);
  EXPECT_EQ(json[0]["passed"], false);
  EXPECT_EQ(json[1]["relmse"], 0);
  EXPECT_EQ(json[1]["passed"], true);
  EXPECT_EQ(compare({"more.exr", "missing.exr", "one.exr"}).exit_code, 2);
  EXPECT_THAT(compare({"more.exr", "one.exr", "one.exr", "--heatmap", "h.png"}).err,
              HasSubstr("--heatmap is of one image"));
  for (const char* image : {"more.exr", "other.exr", "one.exr"}) {
    std::filesystem::copy_file(folder_ / "more.exr", folder_ / "other.exr",
                               std::filesystem::copy_options::overwrite_existing);
    const std::string before = file_contents(folder_ / image);
    const ProgramResult refused = compare({"more.exr", "other.exr", "one.exr", "--json", image});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_EQ(refused.out, "");
    EXPECT_THAT(refused.err, HasSubstr("is an input of this command"));
    EXPECT_EQ(file_contents(folder_ / image), before);
  }
}

TEST_F(CompareCommand, ASecondReferenceRemovesNoise) {
  write("a.exr", noisy(1.0f, 1));
  write("b.exr", noisy(1.0f, 2));
  write("c.exr", noisy(1.0f, 3));
  const double one = json::parse(compare({"a.exr", "b.exr", "--json"}).out)["mse"];
  const auto two = json::parse(compare({"a.exr", "b.exr", "--second-reference", "c.exr", "--json"}).out);
  // 4800 products of deviation below 0.02.
  EXPECT_NEAR(one, 0.02, 4 * 0.02 * std::sqrt(2.0 / 4800));
  EXPECT_NEAR(two["mse"], 0.01, 4 * 0.02 / std::sqrt(4800.0));
  EXPECT_EQ(two["references"], 2);
}

TEST_F(CompareCommand, HeatMapsAreImages) {
  Image image = flat(4, 3, 1.0f);
  image.values[3 * 5] = 4;  // pixel 1,1
  write("spot.exr", image);
  const ProgramResult result =
      compare({"spot.exr", "one.exr", "--heatmap", "map.png", "--map", "abs", "--range", "0,1"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("map.png: abs from 0 (dark) to 1 (yellow)"));
  const auto picture = read_image(folder_ / "map.png");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->data.width, 240) << "wide enough for the numbers of the bar";
  EXPECT_GT(picture->data.height, 3);
  EXPECT_GT(picture->at(1, 1, 0), 0.8f);  // yellow
  EXPECT_GT(picture->at(1, 1, 1), 0.8f);
  EXPECT_LT(picture->at(0, 0, 1), 0.2f);  // dark purple
  EXPECT_EQ(compare({"spot.exr", "one.exr", "--heatmap", "map.exr", "--json"}).exit_code, 0);
  const auto values = read_image(folder_ / "map.exr");
  ASSERT_TRUE(values);
  EXPECT_NEAR(values->at(1, 1, *values->channel("relmse.Y")), 9 / 1.01 / 3, 1e-6);
  EXPECT_EQ(values->at(0, 0, *values->channel("relmse.Y")), 0);
  EXPECT_EQ(values->data.height, 3) << "its values need no bar";
  EXPECT_EQ(compare({"spot.exr", "one.exr", "--heatmap", "flip.png", "--map", "flip"}).exit_code, 0);
}

TEST_F(CompareCommand, HeatMapsHaveTheSamePixelsInBothFormats) {
  Image image = flat(300, 3, 1.0f);
  for (std::size_t i = 0; i < image.values.size(); i += 7) image.values[i] += 0.001f * float(i);
  write("spots.exr", image);
  write("flat.exr", flat(300, 3, 1.0f));
  for (const std::vector<std::string>& scale : {std::vector<std::string>{}, {"--log-colors"}}) {
    for (const char* file : {"map.png", "map.exr"}) {
      std::vector<std::string> arguments = {"spots.exr", "flat.exr", "--heatmap", file};
      arguments.insert(arguments.end(), scale.begin(), scale.end());
      const ProgramResult result = compare(arguments);
      EXPECT_EQ(result.exit_code, 0) << result.err;
      EXPECT_EQ(result.out.find("logarithmic") != std::string::npos, !scale.empty());
    }
    const auto picture = read_image(folder_ / "map.png"), values = read_image(folder_ / "map.exr");
    ASSERT_TRUE(picture && values);
    ASSERT_EQ(picture->data.width, 300);
    const auto beauty = *values->beauty_channels();
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 300; ++x)
        for (std::size_t c = 0; c < 3; ++c)
          ASSERT_EQ(std::lround(255 * picture->at(x, y, c)), display_byte(values->at(x, y, beauty[c])));
  }
}

TEST_F(CompareCommand, LayersAreChosenByName) {
  Image a = flat(2, 2, 1.0f), b = a;
  a.channels = b.channels = {"R", "G", "depth.Z"};
  b.values[2] = 3;
  write("a.exr", a);
  write("b.exr", b);
  const auto report = json::parse(compare({"a.exr", "b.exr", "--layer", "depth", "--json"}).out);
  EXPECT_EQ(report["max"], 2);
  EXPECT_EQ(report["channels"], std::vector<std::string>{"depth.Z"});
  const ProgramResult wrong = compare({"a.exr", "b.exr", "--layer", "deep"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("no layer 'deep'; it has depth"));
}

TEST_F(CompareCommand, WhatCannotBeComparedIsCode2) {
  Image moved = flat(4, 3, 1.0f);
  moved.data.x = 3;
  moved.display.width = 7;
  write("moved.exr", moved);
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"small.exr", "cannot compare small.exr with one.exr: the sizes differ: 2 x 3 against 4 x 3"},
      {"moved.exr", "4 x 3 pixels from 3,0 against 4 x 3 pixels from 0,0"},
      {"text.exr", "text.exr"},
      {"none.exr", "none.exr: no such file"}};
  for (const auto& [name, message] : cases) {
    const ProgramResult result = compare({name, "one.exr"});
    EXPECT_EQ(result.exit_code, 2) << name;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
}

TEST_F(CompareCommand, MistakesAreFoundBeforeTheWorkAndWriteNothing) {
  const auto before = folder_.names();
  const std::vector<std::pair<std::vector<std::string>, std::string>> mistakes = {
      {{"--fail-above", "foo=1"}, "there is no metric 'foo'; there are relmse"},
      {{"--fail-above", "mse"}, "'mse' is not of the form METRIC=VALUE"},
      {{"--heatmap", "map.jpg"}, "a heat map is a .png or an .exr"},
      {{"--heatmap", "one.exr"}, "is an input of this command; it is not overwritten"},
      {{"--json", "./one.exr"}, "is an input of this command; it is not overwritten"},
      {{"--heatmap", "one.exr/map.png"}, "one.exr is not a folder"},
      {{"--heatmap", "a.png", "--json", "a.png"}, "two outputs in one file"},
      {{"--map", "z"}, "--heatmap"},
      {{"--heatmap", "a.png", "--map", "foo"}, "foo"},
      {{"--heatmap", "a.png", "--map", "z"}, "no map of z: neither image has a variance"},
      {{"--heatmap", "a.png", "--range", "1,1"}, "'1,1' is not LOW,HIGH"},
      {{"--log-colors"}, "--heatmap"},
      {{"--heatmap", "a.png", "--log-colors", "--range", "0,1"}, "--log-colors needs a range above 0"},
      {{"--flip", "sdr"}, "sdr"},
      {{"--ppd", "0"}, "--ppd"},
      {{"--block", "0"}, "--block"},
      {{"--significance", "0"}, "--significance"},
      {{"--epsilon", "-1"}, "--epsilon"}};
  for (const auto& [arguments, message] : mistakes) {
    std::vector<std::string> all = {"more.exr", "one.exr"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const ProgramResult result = compare(all);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_THAT(result.out, IsEmpty());
  }
  std::vector<std::string> visible;
  for (const std::string& name : folder_.names()) {
    if (!name.starts_with(".")) visible.push_back(name);  // hidden: the output of the program under test
  }
  EXPECT_EQ(visible, before);
}

/// Three frames of a scene that moves, noisy and with less noise.
class CompareShots : public CompareCommand {
 protected:
  void SetUp() override {
    write_moving_scene(folder_ / "s.xml");
    for (const auto& [name, spp] : {std::pair("a.####.exr", "4"), {"b.####.exr", "64"}}) {
      const ProgramResult rendered =
          run_penumbra(folder_.path(), {"render", "s.xml", "--frames", "1-3", "--spp", spp, "--layers",
                                        "motion", "--seed-per-frame", "frame", "-o", name, "-q"});
      ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
    }
  }
};

TEST_F(CompareShots, HaveALineForEachFrame) {
  const ProgramResult result = compare({"a.####.exr", "b.####.exr", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json all = json::parse(result.out);
  ASSERT_EQ(all["frames"].size(), 3U);
  const json single = json::parse(compare({"a.0002.exr", "b.0002.exr", "--json"}).out);
  EXPECT_EQ(all["frames"][1]["relmse"], single["relmse"]);
  EXPECT_EQ(all["frames"][1]["flip"], single["flip"]["mean"]);
  EXPECT_TRUE(all["frames"][0]["flicker"].is_null());
  EXPECT_GT(all["frames"][1]["flicker"], 0.0);
  EXPECT_NEAR(all["mean"]["flicker"].get<double>(),
              (all["frames"][1]["flicker"].get<double>() + all["frames"][2]["flicker"].get<double>()) / 2,
              1e-9);
  const ProgramResult text = compare({"a.####.exr", "b.####.exr"});
  EXPECT_THAT(text.out, AllOf(HasSubstr("frame      relmse"), HasSubstr("\n    3 "), HasSubstr("\n mean ")));
  EXPECT_EQ(compare({"b.####.exr", "b.####.exr", "--fail-above", "relmse=0"}).exit_code, 0);
  const ProgramResult beyond = compare({"a.####.exr", "b.####.exr", "--fail-above", "relmse=0"});
  EXPECT_EQ(beyond.exit_code, 1);
  EXPECT_THAT(beyond.err, HasSubstr("a.0003.exr is not within the limits"));
}

TEST_F(CompareShots, SayWhatIsMissing) {
  std::filesystem::remove(folder_ / "b.0002.exr");
  const ProgramResult gap = compare({"a.####.exr", "b.####.exr"});
  EXPECT_EQ(gap.exit_code, 2);
  EXPECT_THAT(gap.err, AllOf(HasSubstr("frame 2"), HasSubstr("b.0002.exr")));
  EXPECT_THAT(gap.out, HasSubstr("\n    3 ")) << "the others are compared";
  EXPECT_THAT(compare({"a.####.exr", "none.####.exr"}).err, HasSubstr("none.0001.exr"));
  EXPECT_THAT(compare({"no.####.exr", "none.####.exr"}).err, HasSubstr("there are no frames no.####.exr"));
  EXPECT_THAT(compare({"a.####.exr", "b.####.exr", "--heatmap", "x.png"}).err,
              HasSubstr("--heatmap is of images"));
  EXPECT_THAT(compare({"a.0001.exr", "b.0001.exr", "--plot", "x"}).err, HasSubstr("--plot is of shots"));
}

TEST_F(CompareShots, HaveAPlot) {
  const ProgramResult result = compare({"a.####.exr", "b.####.exr", "--plot", "plots/errors"});
  if (result.err.find("plots need gnuplot") != std::string::npos) GTEST_SKIP() << result.err;
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(file_contents(folder_ / "plots/errors.svg"), HasSubstr("flicker"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "plots/errors.png"));
}

}  // namespace
}  // namespace penumbra
