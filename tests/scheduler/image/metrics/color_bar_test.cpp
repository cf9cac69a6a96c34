// The colour bar: its numbers are where the map has those values, and the image above it is unchanged.
#include "scheduler/image/metrics/color_bar.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "scheduler/image/metrics/color_map.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> labels(const MapRange& range, int most) {
  std::vector<std::string> texts;
  for (const BarTick& tick : bar_ticks(range, most)) texts.push_back(tick.label);
  return texts;
}

TEST(ColorBar, TicksAreRoundNumbersInTheRange) {
  EXPECT_THAT(labels({0, 1}, 5), ElementsAre("0", "0.2", "0.4", "0.6", "0.8", "1"));
  EXPECT_THAT(labels({0, 0.26}, 3), ElementsAre("0", "0.1", "0.2"));
  EXPECT_THAT(labels({-3, 4}, 4), ElementsAre("-2", "0", "2", "4"));
  EXPECT_THAT(labels({1e-4, 1, true}, 5), ElementsAre("0.0001", "0.001", "0.01", "0.1", "1"));
  EXPECT_THAT(labels({2e-9, 3e-1, true}, 3), ElementsAre("1e-08", "1e-05", "0.01"));
  EXPECT_THAT(labels({2, 6, true}, 4), ElementsAre("2", "3", "4", "5", "6"));
}

TEST(ColorBar, TicksAreWhereTheMapHasTheirValues) {
  for (const MapRange& range : {MapRange{0, 0.26}, MapRange{3e-5, 0.7, true}, MapRange{-1, 5}}) {
    const auto ticks = bar_ticks(range, 4);
    ASSERT_GE(ticks.size(), 2u);
    for (const BarTick& tick : ticks) {
      EXPECT_NEAR(tick.position, range.position(std::stod(tick.label)), 1e-3) << tick.label;
      EXPECT_GE(tick.position, 0);
      EXPECT_LE(tick.position, 1);
    }
  }
}

TEST(ColorBar, LogarithmicScaleHasEqualStepsForEqualRatios) {
  const MapRange range = MapRange{0, 10}.on_logarithmic_scale();
  EXPECT_DOUBLE_EQ(range.low, 1e-3);
  EXPECT_NEAR(range.position(1e-1), 0.5, 1e-12);
  EXPECT_NEAR(range.position(10), 1, 1e-12);
  EXPECT_LT(range.position(0), 0) << "zero has no logarithm and is as dark as LOW";
  const Image picture = heat_map_image({"abs", {0, 0, 3, 1}, {0, 0.1f, 20}}, range);
  for (const auto& [pixel, t] : {std::pair{0, 0.0}, {1, 0.5}, {2, 1.0}})
    EXPECT_NEAR(picture.at(pixel, 0, 1), heat_color(t)[1], 1e-5) << pixel;
}

/// A map of 320 × 2 pixels, with values from 0 to 1 and the last pixel NaN.
Image sample_map(const MapRange& range, int width) {
  ErrorMap map{"abs", {5, 6, width, 2}, {}};
  for (int i = 0; i < 2 * width; ++i) map.values.push_back(float(i) / float(2 * width));
  map.values.back() = std::nanf("");
  return heat_map_image(map, range);
}

TEST(ColorBar, LeavesThePixelsOfTheMapAlone) {
  for (const int width : {4, 320, 1500}) {
    const Image map = sample_map({0, 1}, width), image = with_color_bar(map, {0, 1}, "abs");
    EXPECT_EQ(image.data.width, std::max(width, 240));
    EXPECT_GT(image.data.height, map.data.height);
    ASSERT_EQ(image.values.size(), image.pixels() * image.channels.size());
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < width; ++x)
        for (std::size_t c = 0; c < 4; ++c) {
          const float before = map.at(x, y, c), after = image.at(x, y, c);
          EXPECT_TRUE(before == after || (std::isnan(before) && std::isnan(after))) << x << "," << y;
        }
    EXPECT_TRUE(std::isnan(image.at(10, 30, 3))) << "the bar has no values";
  }
}

/// Columns of the image that have a black pixel in these rows.
std::vector<int> black_columns(const Image& image, int top, int bottom) {
  std::vector<int> columns;
  for (int x = 0; x < image.data.width; ++x)
    for (int y = top; y < bottom; ++y)
      if (image.at(x, y, 0) == 0 && image.at(x, y, 1) == 0 && image.at(x, y, 2) == 0) {
        columns.push_back(x);
        break;
      }
  return columns;
}

TEST(ColorBar, TickMarksStandAtTheColoursOfTheirNumbers) {
  const MapRange range{0.001, 10, true};
  const Image image = with_color_bar(sample_map(range, 320), range, "relmse");
  // At a scale of 2: the map, a gap of 8, the bar of 20, ticks of 6 in the rows below its frame.
  const int bar = 2 + 8 + 10, ticks = 2 + 8 + 20 + 3;
  std::vector<int> marks;  // left column of each mark
  for (const int x : black_columns(image, ticks, ticks + 1))
    if (marks.empty() || x > marks.back() + 1) marks.push_back(x);
  const auto wanted = bar_ticks(range, 2);
  ASSERT_EQ(marks.size(), wanted.size());
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const auto color = heat_color(wanted[i].position);
    const int x = std::clamp(marks[i] + 1, 24, 320 - 25);  // the bar's inset is 24
    // The bar has 272 columns; a step of one column changes a channel by less than 0.03.
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(image.at(x, bar, c), color[c], 0.03) << wanted[i].label;
  }
}

TEST(ColorBar, NumbersAreInkBelowTheTicks) {
  const Image image = with_color_bar(sample_map({0, 1}, 320), {0, 1}, "abs");
  const int labels_at = 2 + 8 + 20 + 6 + 2;
  EXPECT_GT(black_columns(image, labels_at, labels_at + 14).size(), 10u);
  EXPECT_GT(black_columns(image, labels_at + 14 + 8, labels_at + 14 + 8 + 14).size(), 10u) << "the name";
  const auto other = with_color_bar(sample_map({0, 1}, 320), {0, 2}, "abs");
  EXPECT_NE(black_columns(image, labels_at, labels_at + 14), black_columns(other, labels_at, labels_at + 14));
}

}  // namespace
}  // namespace penumbra
