// `penumbra compare`, from files to exit code.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "scheduler/outputs/atomic_file.h"
#include "scheduler/outputs/image_files.h"
#include "tests/cli/program.h"
#include "tests/outputs/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Image flat(int width, int height, float value) {
  Image image;
  image.data = image.display = {0, 0, width, height};
  image.channels = {"R", "G", "B"};
  image.values.assign(image.pixels() * 3, value);
  return image;
}

class CompareCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(write_file_atomically(folder_ / "one.exr", *encode_exr(flat(4, 3, 1.0f))));
    ASSERT_TRUE(write_file_atomically(folder_ / "more.exr", *encode_exr(flat(4, 3, 1.5f))));
    ASSERT_TRUE(write_file_atomically(folder_ / "small.exr", *encode_exr(flat(2, 3, 1.0f))));
    ASSERT_TRUE(write_file_atomically(folder_ / "one.png", *encode_png(flat(4, 3, 1.0f))));
    write_text(folder_ / "text.exr", "no image");
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
  EXPECT_THAT(result.out, AllOf(HasSubstr("relMSE       0.247525"), HasSubstr("MSE          0.25"),
                                HasSubstr("max |d|      0.5"), HasSubstr("1.500000")));
}

TEST_F(CompareCommand, PrintsJson) {
  const ProgramResult result = compare({"more.exr", "one.exr", "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_DOUBLE_EQ(json["relative_mse"], 0.25 / 1.01);
  EXPECT_EQ(json["mse"], 0.25);
  EXPECT_EQ(json["mean_ratio"], (std::vector<double>{1.5, 1.5, 1.5}));
  EXPECT_EQ(json["compared_pixels"], 12);
}

TEST_F(CompareCommand, ReadsOtherFormats) {
  const ProgramResult result = compare({"one.png", "one.exr", "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["mse"], 0.0);
}

TEST_F(CompareCommand, ToleranceDecidesTheExitCode) {
  EXPECT_EQ(compare({"more.exr", "one.exr", "--tolerance", "0.25"}).exit_code, 0);
  const ProgramResult result = compare({"more.exr", "one.exr", "--tolerance", "0.24"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("above the tolerance"));
}

TEST_F(CompareCommand, WhatCannotBeComparedIsCode2) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"small.exr", "2 x 3 against 4 x 3"}, {"text.exr", "text.exr"}, {"none.exr", "none.exr: no such file"}};
  for (const auto& [name, message] : cases) {
    const ProgramResult result = compare({name, "one.exr"});
    EXPECT_EQ(result.exit_code, 2) << name;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
}

}  // namespace
}  // namespace penumbra
