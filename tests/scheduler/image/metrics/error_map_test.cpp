#include "scheduler/image/metrics/error_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "scheduler/image/metrics/color_map.h"
#include "scheduler/image/metrics/error_metrics.h"
#include "scheduler/image/metrics/z_test.h"
#include "tests/scheduler/image/metrics/small_images.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::FloatEq;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(ErrorMap, ByHand) {
  const ImagePair pair = pair_of(image_of(2, 1, {2, 3, 1, 0, 0, 0.5f}), image_of(2, 1, {1, 3, 3, 0, 0, 0}));
  EXPECT_THAT(relative_error_map(pair, 0.01).values,
              ElementsAre(FloatEq(float((1 / 1.01 + 4 / 9.01) / 3)), FloatEq(float(25 / 3.0))));
  EXPECT_THAT(absolute_error_map(pair).values, ElementsAre(1, FloatEq(0.5f / 3)));
  const std::vector<float> variance = {1, 1, 0.25f, 0, 0, 0};
  EXPECT_THAT(z_map(pair, z_values(pair, {variance, {}}, {})).values,
              ElementsAre(FloatEq(4), std::numeric_limits<float>::infinity()));
}

TEST(ErrorMap, MeansAreTheMetrics) {
  std::vector<float> a, b;
  for (std::uint64_t i = 0; i < 3 * 200; ++i) {
    a.push_back(float(hashed(i, 1)));
    b.push_back(float(hashed(i, 2)));
  }
  const ImagePair pair = pair_of(image_of(20, 10, a), image_of(20, 10, b));
  double sum = 0;
  for (const float value : relative_error_map(pair, kRelativeEpsilon).values) sum += value;
  EXPECT_NEAR(sum / 200, relative_mse(pair).overall, 1e-6 * sum / 200);
}

TEST(ErrorMap, RangesIgnoreFireflies) {
  ErrorMap map{"relmse", {0, 0, 1000, 1}, std::vector<float>(1000, 1.0f)};
  map.values[5] = 1e6f;
  map.values[6] = kNan;
  EXPECT_EQ(default_range(map).high, 1);
  std::ranges::fill(map.values, 0.0f);
  EXPECT_EQ(default_range(map).high, 1);  // nothing differs
  map.values[5] = 7;
  EXPECT_EQ(default_range(map).high, 7);
  map.name = "flip";
  EXPECT_EQ(default_range(map).high, 1);
  map.name = "z";
  EXPECT_EQ(default_range(map).high, 5);
}

TEST(ErrorMap, PictureHoldsColoursAndValues) {
  const ErrorMap map{"abs", {3, 4, 4, 1}, {0, 1, 4, kNan}};
  const Image image = heat_map_image(map, {0, 2});
  EXPECT_EQ(image.data, map.window);
  EXPECT_THAT(image.channels, ElementsAre("R", "G", "B", "abs.Y"));
  const auto color = [&](int x) {
    return std::array{image.at(x, 0, 0), image.at(x, 0, 1), image.at(x, 0, 2)};
  };
  EXPECT_EQ(color(0), heat_color(0));
  EXPECT_EQ(color(1), heat_color(0.5));
  EXPECT_EQ(color(2), heat_color(1));
  EXPECT_EQ(color(3), kNoValueColor);
  EXPECT_EQ(image.at(2, 0, 3), 4);
}

}  // namespace
}  // namespace penumbra
