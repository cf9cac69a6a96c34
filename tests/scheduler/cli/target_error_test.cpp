// `penumbra render --target-error`: the error of the image against a reference is the requested one.
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

using Arguments = std::vector<std::string>;

struct TargetScene {
  const char* name;
  const char* file;  ///< of the source tree; empty: the small scene
  Arguments options;
};
void PrintTo(const TargetScene& scene, std::ostream* out) { *out << scene.name; }

class TargetError : public ::testing::TestWithParam<TargetScene> {
 protected:
  void SetUp() override { write_small_scene(folder_ / "s.xml"); }

  ProgramResult render(Arguments options) const {
    const TargetScene& scene = GetParam();
    options.insert(options.begin(), {"render", *scene.file != 0 ? source_path(scene.file) : "s.xml", "-q",
                                     "--sampler", "independent", "--tile", "16"});
    options.insert(options.end(), scene.options.begin(), scene.options.end());
    return run_penumbra(folder_.path(), options);
  }
  [[nodiscard]] nlohmann::json statistics(const std::string& name) const {
    return nlohmann::json::parse(file_contents(folder_ / name));
  }
  /// sqrt(mean over pixels and channels of (difference^2 / (reference^2 + .01))), and the same without the
  /// reference's own variance.
  double error_against(const std::string& image, const std::string& reference) const {
    const auto a = read_image(folder_ / image), b = read_image(folder_ / reference);
    EXPECT_TRUE(a && b);
    if (!a || !b) return NAN;
    double sum = 0;
    for (int y = 0; y < b->data.height; ++y)
      for (int x = 0; x < b->data.width; ++x)
        for (const char* channel : {"R", "G", "B"}) {
          const double of_a = a->at(x, y, *a->channel(channel)), of_b = b->at(x, y, *b->channel(channel));
          const double variance = b->at(x, y, *b->channel(std::string("variance.") + channel));
          sum += ((of_a - of_b) * (of_a - of_b) - variance) / (of_b * of_b + 0.01);
        }
    return std::sqrt(sum / (3.0 * b->data.width * b->data.height));
  }

  TemporaryFolder folder_;
};

TEST_P(TargetError, IsComeTo) {
  ASSERT_EQ(render({"-o", "reference.exr", "--spp", "4096", "--seed", "77"}).exit_code, 0);
  for (const double target : {0.1, 0.05}) {
    const ProgramResult result =
        render({"-o", "a.exr", "--spp", "8192", "--pass", "4", "--target-error", std::to_string(target)});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto json = statistics("a.json");
    EXPECT_LT(json["samples"]["most_per_pixel"], 8192) << "it was not the number of samples that ended it";
    const double error = error_against("a.exr", "reference.exr");
    // Decisions are a quarter of the samples apart, so the error may be an eighth less than asked for; and
    // less still where the first decision's 16 samples are enough for some tiles.
    EXPECT_LT(error, 1.15 * target) << json["relative_error"];
    if (json["samples"]["most_per_pixel"] > 16) {
      EXPECT_GT(error, 0.7 * target);
    }
    EXPECT_NEAR(json["relative_error"].get<double>(), error, 0.2 * error);
    RecordProperty(std::string("error_over_target_") + std::to_string(int(1 / target)),
                   std::to_string(error / target));
  }
}

TEST_P(TargetError, TheImageIsAFunctionOfTheCommandAlone) {
  const Arguments options = {"--spp", "2048", "--pass", "4", "--target-error", "0.1"};
  const auto with = [&](Arguments more) {
    more.insert(more.end(), options.begin(), options.end());
    return render(more).exit_code;
  };
  ASSERT_EQ(with({"-o", "a.exr", "--workers", "1", "--threads", "1"}), 0);
  ASSERT_EQ(with({"-o", "b.exr", "--workers", "3", "--threads", "1"}), 0);
  EXPECT_TRUE(file_contents(folder_ / "a.exr") == file_contents(folder_ / "b.exr"));
  const auto json = statistics("a.json");
  EXPECT_THAT(json["repeat_command"].get<std::string>(),
              AllOf(HasSubstr("--target-error 0.1"), HasSubstr("--tile 16")));
  EXPECT_EQ(json["settings"]["target_error"], "0.1");
  EXPECT_TRUE(json["complete"]);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, TargetError,
    ::testing::Values(TargetScene{"small", "", {}},
                      TargetScene{"cornell", "scenes/cornell/cornell.xml", {"--crop", "180,300,276,364"}},
                      TargetScene{"cornell_by_paths_alone",
                                  "scenes/cornell/cornell.xml",
                                  {"--crop", "180,300,244,332", "--integrator", "path_ems"}}),
    [](const auto& parameter) { return parameter.param.name; });

TEST(TargetErrorOptions, WhatHasNoErrorOfItsSamplesIsRefused) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const auto sobol =
      run_penumbra(folder.path(), {"render", "s.xml", "--sampler", "sobol", "--target-error", "0.1"});
  EXPECT_EQ(sobol.exit_code, 2);
  EXPECT_THAT(sobol.err, HasSubstr("--sampler independent"));
}

TEST(TargetErrorOptions, ATimeBudgetEndsIt) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const auto result =
      run_penumbra(folder.path(), {"render", "s.xml", "--sampler", "independent", "--spp", "1000000000",
                                   "--tile", "8", "--target-error", "1e-7", "--time-budget", "1"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(file_contents(folder / "s.json"));
  EXPECT_EQ(json["complete"], false);
  EXPECT_EQ(json["ended_by"], "time_budget");
  EXPECT_LT(json["seconds"]["render"], 2.0);
  EXPECT_GT(json["samples"]["least_per_pixel"], 0);
}

}  // namespace
}  // namespace penumbra
