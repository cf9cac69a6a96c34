#include "scheduler/image/picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinite = std::numeric_limits<float>::infinity();

/// One row of pixels.
Image row(std::vector<std::string> channels, std::vector<float> values) {
  Image image;
  image.data = image.display = {0, 0, int(values.size() / channels.size()), 1};
  image.channels = std::move(channels);
  image.values = std::move(values);
  return image;
}

std::vector<int> bytes_of(const Image& image, const PictureOptions& options = {}) {
  const auto picture = picture_of(image, options);
  if (!picture) return ADD_FAILURE() << picture.error().message, std::vector<int>();
  return {picture->pixels.begin(), picture->pixels.end()};
}

/// The byte that IEC 61966-2-1 gives for linear light.
int srgb_byte(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return int(std::lround(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055)));
}

TEST(Picture, ExposureDoublesRadianceBeforeTheToneMap) {
  const Image image = row({"R", "G", "B"}, {0.1f, 0.2f, 0.9f});
  EXPECT_THAT(bytes_of(image), ElementsAre(srgb_byte(0.1), srgb_byte(0.2), srgb_byte(0.9)));
  EXPECT_THAT(bytes_of(image, {.exposure = 1}), ElementsAre(srgb_byte(0.2), srgb_byte(0.4), 255));
  EXPECT_THAT(bytes_of(image, {.exposure = -2}),
              ElementsAre(srgb_byte(0.025), srgb_byte(0.05), srgb_byte(0.225)));
  const double l = 4 * (0.2126 * 0.1 + 0.7152 * 0.2 + 0.0722 * 0.9);
  EXPECT_THAT(bytes_of(image, {.exposure = 2, .tone = ToneOperator::kReinhard}),
              ElementsAre(srgb_byte(0.4 / (1 + l)), srgb_byte(0.8 / (1 + l)), srgb_byte(3.6 / (1 + l))));
}

TEST(Picture, ASingleChannelIsGrey) {
  const Image image = row({"R", "G", "B", "visibility.Y"}, {0, 0, 0, 0.5f});
  const int grey = srgb_byte(0.5);
  EXPECT_THAT(bytes_of(image, {.layer = "visibility"}), ElementsAre(grey, grey, grey));
  EXPECT_THAT(bytes_of(image, {.layer = "visibility.Y"}), ElementsAre(grey, grey, grey));
}

TEST(Picture, NormalsAreCentredAndHaveNoTransferFunction) {
  const Image image = row({"normal.X", "normal.Y", "normal.Z"}, {0, 0, 1, -1, 0.5f, 0});
  for (const double exposure : {0.0, 3.0})
    EXPECT_THAT(bytes_of(image, {.layer = "normal", .exposure = exposure}),
                ElementsAre(128, 128, 255, 0, 191, 128));
}

TEST(Picture, DepthIsShownOverItsRange) {
  const Image image = row({"depth.Z"}, {2, 0, 10, 6, kNan, kInfinite});
  const auto picture = picture_of(image, {.layer = "depth"});
  ASSERT_TRUE(picture) << picture.error().message;
  std::vector<int> red;
  for (std::size_t i = 0; i < picture->pixels.size(); i += 3) red.push_back(picture->pixels[i]);
  // 25.5, 0, 255, and half way from 0.1 to 1; what is not finite is magenta.
  EXPECT_THAT(red, ElementsAre(26, 0, 255, 140, 255, 255));
  EXPECT_EQ(picture->pixels[4 * 3 + 1], 0);
  EXPECT_EQ(picture->non_finite, 2u);
  EXPECT_THAT(picture->remark, HasSubstr("depth from 2 (dark) to 10 (white)"));
  const auto black = picture_of(row({"depth.Z"}, {0, 0}), {.layer = "depth"});
  EXPECT_THAT(black->remark, HasSubstr("depth is 0"));
  const auto flat = picture_of(row({"samples.Y"}, {16, 16}), {.layer = "samples"});
  EXPECT_EQ(flat->pixels[0], 255);
}

TEST(Picture, DifferencesAreCentredOnGrey) {
  const Image image = row({"difference.R", "difference.G", "difference.B"}, {0, -0.25f, 0.25f});
  const double size = 1.055 * std::pow(0.5, 1 / 2.4) - 0.055;
  EXPECT_THAT(bytes_of(image, {.layer = "difference", .exposure = 1}),
              ElementsAre(128, int(std::lround(255 * (0.5 - 0.5 * size))),
                          int(std::lround(255 * (0.5 + 0.5 * size)))));
}

TEST(Picture, WhatIsNotFiniteIsMagentaAndCounted) {
  const Image image = row({"R", "G", "B", "A"}, {0.5f, kNan, 0.5f, 1, 0, 0, 0, 0, kInfinite, 0, 0, 0.5f});
  const auto picture = picture_of(image);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->non_finite, 2u);
  EXPECT_THAT(bytes_of(image), ElementsAre(255, 0, 255, 255, 0, 0, 0, 0, 255, 0, 255, 255));
}

TEST(Picture, SignalsOfADisplayStayTheyAreWithoutExposure) {
  Image image = row({"R", "G", "B"}, {10 / 255.0f, 128 / 255.0f, 250 / 255.0f});
  image.metadata = {{"oiio:ColorSpace", "sRGB"}};
  EXPECT_THAT(bytes_of(image), ElementsAre(10, 128, 250));
  const Image linear = *linear_image(image, "");
  EXPECT_NEAR(linear.values[1], std::pow((128 / 255.0 + 0.055) / 1.055, 2.4), 1e-6);
  EXPECT_FALSE(is_display_image(linear));
}

TEST(Picture, OfWhatIsNoPictureIsAnError) {
  const Image image = row({"R", "G", "B", "uv.U", "uv.V", "CryptoObject00.R"}, {0, 0, 0, 0, 0, 0});
  const auto said = [&](const std::string& layer) {
    const auto picture = picture_of(image, {.layer = layer});
    return picture ? std::string("a picture") : picture.error().message;
  };
  EXPECT_THAT(said("uv"), HasSubstr("has 2 channels, of which there is no picture; choose one, as in uv.U"));
  EXPECT_THAT(said("CryptoObject00"), HasSubstr("IDs"));
  EXPECT_THAT(said("albedo"), HasSubstr("has no layer 'albedo'; it has beauty, uv, CryptoObject00"));
}

TEST(LinearImage, OfALayerHasItsChannelsAlone) {
  Image image = row({"R", "G", "B", "albedo.B", "albedo.G", "albedo.R", "normal.X", "normal.Y", "normal.Z"},
                    {1, 2, 3, 4, 5, 6, 7, 8, 9});
  image.metadata = {{"penumbra:seed", 3}, {"cryptomatte/1/name", "CryptoObject"}};
  image.chromaticities = kRec709;
  const Image albedo = *linear_image(image, "albedo");
  EXPECT_THAT(albedo.channels, ElementsAre("R", "G", "B"));
  EXPECT_THAT(albedo.values, ElementsAre(6, 5, 4));
  EXPECT_EQ(albedo.attribute("penumbra:seed"), MetadataValue(3));
  EXPECT_EQ(albedo.attribute("penumbra:layer"), MetadataValue("albedo"));
  EXPECT_FALSE(albedo.attribute("cryptomatte/1/name"));
  EXPECT_EQ(albedo.chromaticities, kRec709);
  EXPECT_THAT(linear_image(image, "normal")->channels, ElementsAre("normal.X", "normal.Y", "normal.Z"));
  EXPECT_EQ(linear_image(image, "")->values, image.values);
  EXPECT_FALSE(linear_image(image, "depth"));
}

}  // namespace
}  // namespace penumbra
