#include "scheduler/outputs/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace penumbra {
namespace {

using ::testing::HasSubstr;

Image image_of(int width, int height, std::vector<float> values) {
  Image image;
  image.data = image.display = {0, 0, width, height};
  image.channels = {"R", "G", "B"};
  image.values = std::move(values);
  return image;
}

TEST(Compare, MetricsByHand) {
  // d: (1, 0, -2) and (0, 0, 0.5).
  const auto c = compare_images(image_of(2, 1, {2, 3, 1, 0, 0, 0.5f}), image_of(2, 1, {1, 3, 3, 0, 0, 0}));
  ASSERT_TRUE(c) << c.error().message;
  EXPECT_DOUBLE_EQ(c->mse, (1 + 4 + 0.25) / 6);
  EXPECT_DOUBLE_EQ(c->relative_mse, (1 / 1.01 + 4 / 9.01 + 0.25 / 0.01) / 6);
  EXPECT_DOUBLE_EQ(c->max_difference, 2);
  EXPECT_EQ(c->max_x, 0);
  EXPECT_EQ(c->max_y, 0);
  EXPECT_THAT(c->image_mean, ::testing::ElementsAre(1, 1.5, 0.75));
  EXPECT_THAT(c->reference_mean, ::testing::ElementsAre(0.5, 1.5, 1.5));
  EXPECT_DOUBLE_EQ(c->mean_ratio(0), 2);
  EXPECT_DOUBLE_EQ(c->mean_ratio(2), 0.5);
  EXPECT_EQ(c->compared_pixels, 2u);
}

TEST(Compare, TheSecondImageIsTheReference) {
  const Image dark = image_of(1, 1, {0, 0, 0}), bright = image_of(1, 1, {1, 1, 1});
  EXPECT_DOUBLE_EQ(compare_images(bright, dark)->relative_mse, 100);
  EXPECT_DOUBLE_EQ(compare_images(dark, bright)->relative_mse, 1 / 1.01);
}

TEST(Compare, EqualImagesDifferByNothing) {
  const Image image = image_of(2, 2, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
  const auto c = compare_images(image, image);
  EXPECT_EQ(c->mse, 0);
  EXPECT_EQ(c->relative_mse, 0);
  EXPECT_EQ(c->max_difference, 0);
}

TEST(Compare, LeavesOutAndCountsWhatIsNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  const auto c = compare_images(image_of(3, 1, {1, nan, 1, 2, 2, 2, infinity, 0, 0}),
                                image_of(3, 1, {1, 1, 1, 2, 2, 3, 0, 0, infinity}));
  ASSERT_TRUE(c) << c.error().message;
  EXPECT_EQ(c->compared_pixels, 1u);
  EXPECT_EQ(c->image_non_finite, 2u);
  EXPECT_EQ(c->reference_non_finite, 1u);
  EXPECT_DOUBLE_EQ(c->mse, 1.0 / 3);
  EXPECT_EQ(c->max_x, 1);
  EXPECT_THAT(comparison_text(*c), HasSubstr("2 pixels of A, 1 of B"));
  EXPECT_FALSE(compare_images(image_of(1, 1, {nan, 0, 0}), image_of(1, 1, {0, 0, 0})));
}

TEST(Compare, RefusesWhatCannotBeCompared) {
  const auto sizes =
      compare_images(image_of(2, 1, std::vector<float>(6)), image_of(1, 2, std::vector<float>(6)));
  ASSERT_FALSE(sizes);
  EXPECT_THAT(sizes.error().message, HasSubstr("2 x 1 against 1 x 2"));
  Image no_beauty = image_of(1, 1, {0, 0, 0});
  no_beauty.channels = {"normal.X", "normal.Y", "normal.Z"};
  const auto channels = compare_images(image_of(1, 1, {0, 0, 0}), no_beauty);
  ASSERT_FALSE(channels);
  EXPECT_THAT(channels.error().message, HasSubstr("normal.X, normal.Y"));
}

TEST(Compare, LayersAreComparedByNameNotByPlace) {
  Image image = image_of(1, 1, {9, 3, 2, 1});
  image.channels = {"depth.Z", "B", "G", "R"};
  EXPECT_EQ(compare_images(image, image_of(1, 1, {1, 2, 3}))->max_difference, 0);
}

TEST(Compare, JsonHasNullForUnknownRatios) {
  const auto c = compare_images(image_of(1, 1, {0, 1, 1}), image_of(1, 1, {0, 0, 2}));
  const auto json = comparison_json(*c);
  EXPECT_TRUE(json["mean_ratio"][0].is_null());
  EXPECT_TRUE(json["mean_ratio"][1].is_null());
  EXPECT_EQ(json["mean_ratio"][2], 0.5);
  EXPECT_EQ(json["mse"], 2.0 / 3);
}

}  // namespace
}  // namespace penumbra
