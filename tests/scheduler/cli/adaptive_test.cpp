// `penumbra render --adaptive` has the same mean as a render with equally many samples in every pixel, and
// less error.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "scheduler/image/image.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

using Arguments = std::vector<std::string>;

struct AdaptiveScene {
  const char* name;
  const char* file;  ///< of the source tree; empty: the small scene
  Arguments options;
  double most_error = 0.8;  ///< over that of equally many samples of every pixel, relative squared
};
void PrintTo(const AdaptiveScene& scene, std::ostream* out) { *out << scene.name; }

class Adaptive : public ::testing::TestWithParam<AdaptiveScene> {
 protected:
  void SetUp() override { write_small_scene(folder_ / "s.xml"); }

  ProgramResult render(Arguments options) const {
    const AdaptiveScene& scene = GetParam();
    options.insert(options.begin(),
                   {"render", *scene.file != 0 ? source_path(scene.file) : "s.xml", "-q", "--tile", "8"});
    options.insert(options.end(), scene.options.begin(), scene.options.end());
    return run_penumbra(folder_.path(), options);
  }
  [[nodiscard]] nlohmann::json statistics(const std::string& name) const {
    return nlohmann::json::parse(file_contents(folder_ / name));
  }
  /// Radiance, red, green and blue of one pixel after the other.
  std::vector<double> radiance(const std::string& name) const {
    const auto image = read_image(folder_ / name);
    EXPECT_TRUE(image);
    std::vector<double> values;
    for (int y = 0; image && y < image->data.height; ++y)
      for (int x = 0; x < image->data.width; ++x)
        for (const char* channel : {"R", "G", "B"})
          values.push_back(image->at(x, y, *image->channel(channel)));
    return values;
  }

  TemporaryFolder folder_;
};

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / double(values.size());
}

/// mean of (difference^2 / (reference^2 + .01)).
double relative_mse(const std::vector<double>& image, const std::vector<double>& reference) {
  double sum = 0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    const double difference = image[i] - reference[i];
    sum += difference * difference / (reference[i] * reference[i] + 0.01);
  }
  return sum / double(image.size());
}

TEST_P(Adaptive, HasNoBiasAndLessError) {
  ASSERT_EQ(render({"-o", "reference.exr", "--spp", "4096", "--seed", "77"}).exit_code, 0);
  const std::vector<double> reference = radiance("reference.exr");
  const double truth = mean(reference);
  constexpr int kSeeds = 24;
  double sum = 0, squares = 0, error = 0, error_of_equal = 0;
  int uneven = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Arguments options = {"--spp", "16", "--pass", "4", "--seed", std::to_string(seed)};
    Arguments adaptive = options, equal = options;
    adaptive.insert(adaptive.end(), {"-o", "a.exr", "--adaptive"});
    equal.insert(equal.end(), {"-o", "b.exr"});
    ASSERT_EQ(render(adaptive).exit_code, 0);
    ASSERT_EQ(render(equal).exit_code, 0);
    const std::vector<double> a = radiance("a.exr");
    const double difference = mean(a) - truth;
    sum += difference, squares += difference * difference;
    error += relative_mse(a, reference);
    error_of_equal += relative_mse(radiance("b.exr"), reference);
    const auto json = statistics("a.json");
    EXPECT_LE(json["samples"]["total"], 16 * a.size() / 3) << "the mean is what was asked for";
    uneven += json["samples"]["least_per_pixel"] < json["samples"]["most_per_pixel"] ? 1 : 0;
  }
  EXPECT_GT(uneven, 0);
  // Student's t with 23 degrees of freedom, two-sided, p = 0.0006. The reference's own error adds a tenth to
  // the variance.
  const double variance = (squares - sum * sum / kSeeds) / (kSeeds - 1);
  EXPECT_LT(std::abs(sum / std::sqrt(variance * kSeeds)), 4) << sum / kSeeds << " of " << truth;
  EXPECT_LT(error, GetParam().most_error * error_of_equal);
  RecordProperty("error_of_equal_over_ours", std::to_string(error_of_equal / error));
}

TEST_P(Adaptive, TheImageIsAFunctionOfTheCommandAlone) {
  const Arguments options = {"--spp", "64", "--pass", "4", "--adaptive"};
  const auto with = [&](Arguments more) {
    more.insert(more.end(), options.begin(), options.end());
    return render(more).exit_code;
  };
  ASSERT_EQ(with({"-o", "a.exr", "--workers", "1", "--threads", "1"}), 0);
  ASSERT_EQ(with({"-o", "b.exr", "--workers", "3", "--threads", "1", "--verify", "0.3"}), 0);
  EXPECT_TRUE(file_contents(folder_ / "a.exr") == file_contents(folder_ / "b.exr"));
  const auto json = statistics("a.json");
  EXPECT_THAT(json["repeat_command"].get<std::string>(),
              AllOf(HasSubstr("--adaptive"), HasSubstr("--tile 8")));
  EXPECT_EQ(json["settings"]["adaptive"], "true");
  EXPECT_TRUE(json["complete"]);
}

// The noise of a room is even: there is nothing to be won, nor more to be lost than powers of two cost.
INSTANTIATE_TEST_SUITE_P(
    Scenes, Adaptive,
    ::testing::Values(
        AdaptiveScene{"small", "", {}}, AdaptiveScene{"small_sobol", "", {"--sampler", "sobol"}},
        AdaptiveScene{"small_stratified", "", {"--sampler", "stratified"}},
        AdaptiveScene{
            "small_control_variate", "", {"--integrator", "polygon_cv", "--set", "integrator.alpha=auto"}},
        AdaptiveScene{
            "cornell_small", "scenes/cornell-small/cornell-small.xml", {"--crop", "88,0,152,48"}, 1.1}),
    [](const auto& parameter) { return parameter.param.name; });

TEST(AdaptiveOptions, WhatCannotGoTogetherIsRefused) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  for (const Arguments& other : std::vector<Arguments>{{"--target-error", "0.1"},
                                                       {"--stop-after", "2"},
                                                       {"--stop-after-units", "2"},
                                                       {"--pixel", "2,2"}}) {
    Arguments arguments = {"render", "s.xml", "--adaptive"};
    arguments.insert(arguments.end(), other.begin(), other.end());
    const ProgramResult result = run_penumbra(folder.path(), arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, AllOf(HasSubstr("--adaptive"), HasSubstr(other.front())));
  }
}

TEST(AdaptiveOptions, ATimeBudgetThatCutsItShortIsNotRepeated) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const ProgramResult result =
      run_penumbra(folder.path(), {"render", "s.xml", "-q", "--adaptive", "--tile", "8", "--pass", "4",
                                   "--spp", "4000000", "--time-budget", "0.5"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto image = read_image(folder / "s.exr");
  ASSERT_TRUE(image);
  EXPECT_TRUE(image->attribute("penumbra:nearest_command"));
  EXPECT_FALSE(image->attribute("penumbra:command"));
}

}  // namespace
}  // namespace penumbra
