#include "scheduler/image/metrics/image_pair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/scheduler/image/metrics/small_images.h"

namespace penumbra::image_pair_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::string pair_error(const Image& image, const Image& reference, std::string_view layer = {}) {
  const auto pair = pair_images(image, reference, nullptr, layer);
  return pair ? "no error" : pair.error().message;
}

TEST(ImagePair, CountsWhatIsNotFinite) {
  const ImagePair pair = pair_of(image_of(4, 1, {1, kNan, 1, 2, 2, 2, kInfinity, 0, 0, 1, 1, 1}),
                                 image_of(4, 1, {1, 1, 1, 2, 2, 3, 0, 0, -kInfinity, 1, 1, kNan}));
  EXPECT_EQ(pair.compared_pixels, 1u);
  EXPECT_EQ(pair.image_non_finite, 2u);
  EXPECT_EQ(pair.reference_non_finite, 2u);
  EXPECT_THAT(pair.finite, ElementsAre(0, 1, 0, 0));
  EXPECT_THAT(pair_error(image_of(1, 1, {kNan, 0, 0}), image_of(1, 1, {0, 0, 0})),
              HasSubstr("no pixel is finite in all images: 1 of 1"));
}

TEST(ImagePair, RefusesOtherSizesAndCropsNamingBoth) {
  const Image wide = image_of(2, 1, std::vector<float>(6)), high = image_of(1, 2, std::vector<float>(6));
  EXPECT_THAT(pair_error(wide, high), HasSubstr("2 x 1 against 1 x 2"));
  Image moved = wide;
  moved.data.x = 5;
  EXPECT_THAT(pair_error(wide, moved), AllOf(HasSubstr("2 x 1 pixels from 0,0"), HasSubstr("from 5,0")));
  EXPECT_TRUE(pair_images(moved, moved));
  const auto second = pair_images(wide, wide, &high);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("the second reference"));
}

TEST(ImagePair, FindsLayersByNameNotByPlace) {
  const Image image = image_of(1, 1, {9, 3, 2, 1, 0.3f, 0.1f, 0.2f, 5},
                               {"depth.Z", "B", "G", "R", "albedo.B", "albedo.R", "albedo.G", "n"});
  EXPECT_THAT(pair_of(image, image_of(1, 1, {1, 2, 3})).image, ElementsAre(1, 2, 3));
  const auto albedo = pair_images(image, image, nullptr, "albedo");
  ASSERT_TRUE(albedo);
  EXPECT_THAT(albedo->image, ElementsAre(0.1f, 0.2f, 0.3f));
  EXPECT_THAT(albedo->channels, ElementsAre("albedo.R", "albedo.G", "albedo.B"));
  EXPECT_THAT(pair_images(image, image, nullptr, "depth")->image, ElementsAre(9));
  EXPECT_THAT(pair_images(image, image, nullptr, "albedo.G")->image, ElementsAre(0.2f));
  EXPECT_THAT(pair_images(image, image, nullptr, "n")->image, ElementsAre(5));
  EXPECT_THAT(pair_error(image, image, "dep"),
              AllOf(HasSubstr("the image has no layer 'dep'"), HasSubstr("beauty, depth, albedo, n")));
  EXPECT_THAT(pair_error(image, image_of(1, 1, {1, 2, 3}), "albedo"),
              HasSubstr("the reference has no layer"));
  const Image other = image_of(1, 1, {1, 2}, {"albedo.X", "albedo.Y"});
  EXPECT_THAT(pair_error(image, other, "albedo"),
              HasSubstr("albedo.R, albedo.G, albedo.B against albedo.X, albedo.Y"));
  EXPECT_THAT(pair_error(image_of(1, 1, {1, 2}, {"normal.X", "normal.Y"}), image),
              HasSubstr("normal.X, normal.Y"));
}

TEST(ImagePair, GreyComparesWithColour) {
  const Image grey = grey_image(1, 1, {2}), colour = image_of(1, 1, {1, 2, 3});
  EXPECT_THAT(pair_of(grey, grey).image, ElementsAre(2));
  EXPECT_THAT(pair_of(grey, colour).image, ElementsAre(2, 2, 2));
  EXPECT_THAT(pair_of(colour, grey).reference, ElementsAre(2, 2, 2));
  const auto mixed = pair_images(grey, grey, &colour);
  ASSERT_TRUE(mixed);
  EXPECT_THAT(mixed->image, ElementsAre(2, 2, 2));
  EXPECT_THAT(mixed->reference, ElementsAre(2, 2, 2));
  EXPECT_THAT(mixed->second_reference, ElementsAre(1, 2, 3));
}

TEST(BlockMeans, ByHand) {
  // Three columns from x = -1, two rows from y = 3: blocks of 2 x 2 in film coordinates part them everywhere.
  Image image = image_of(3, 2, {1, 2, 4, 3, 6, 8}, {"Y"}),
        reference = image_of(3, 2, {0, 1, 1, 1, 3, 3}, {"Y"});
  for (Image* each : {&image, &reference}) each->data.x = each->display.x = -1;
  for (Image* each : {&image, &reference}) each->data.y = each->display.y = 3;
  const ImagePair blocks = block_means(pair_images(image, reference, &image).value(), 2);
  EXPECT_EQ(blocks.window.x, -1);
  EXPECT_EQ(blocks.window.y, 1);
  EXPECT_EQ(blocks.window.width, 2);
  EXPECT_EQ(blocks.window.height, 2);
  EXPECT_THAT(blocks.image, ::testing::ElementsAre(1, 3, 3, 7));
  EXPECT_THAT(blocks.reference, ::testing::ElementsAre(0, 1, 1, 3));
  EXPECT_THAT(blocks.second_reference, ::testing::ElementsAre(1, 3, 3, 7));
  EXPECT_EQ(blocks.compared_pixels, 4u);
}

TEST(BlockMeans, LeaveOutBlocksThatAreNotFinite) {
  const ImagePair pair = pair_of(image_of(4, 1, {1, NAN, 2, 4}, {"Y"}), image_of(4, 1, {0, 0, 0, 0}, {"Y"}));
  const ImagePair blocks = block_means(pair, 2);
  EXPECT_THAT(blocks.finite, ::testing::ElementsAre(0, 1));
  EXPECT_EQ(blocks.compared_pixels, 1u);
  EXPECT_EQ(blocks.image[1], 3);
}

TEST(BlockMeans, OfOnePixelAreThePixels) {
  const ImagePair pair = pair_of(image_of(2, 2, {1, 2, 3, 4}, {"Y"}), image_of(2, 2, {0, 5, 0, 1}, {"Y"}));
  const ImagePair blocks = block_means(pair, 1);
  EXPECT_EQ(blocks.image, pair.image);
  EXPECT_EQ(blocks.reference, pair.reference);
}

}  // namespace
}  // namespace penumbra::image_pair_test
