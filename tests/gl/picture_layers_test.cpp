#include "gl/picture_layers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernels/host/atomic_file.h"
#include "scheduler/image/image_files.h"
#include "scheduler/image/tone_map.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using testing::ElementsAre;

std::vector<std::string> names_of(const LayeredPicture& picture) {
  std::vector<std::string> names;
  for (const PictureLayer& layer : picture.layers) names.push_back(layer.name);
  return names;
}

Image one_pixel(std::vector<std::string> channels) {
  Image image;
  image.data = {3, 4, 1, 1};
  image.display = {0, 0, 8, 8};
  for (std::size_t i = 0; i < channels.size(); ++i) image.values.push_back(float(i + 1));
  image.channels = std::move(channels);
  return image;
}

TEST(PictureLayers, ChannelsAreGroupedByName) {
  const Image image =
      one_pixel({"R", "G", "B", "A", "albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z",
                 "depth.Z", "samples.Y", "uv.U", "uv.V", "CryptoObject00.R", "CryptoObject00.G",
                 "CryptoObject00.B", "CryptoObject00.A", "view.left.R"});
  const LayeredPicture picture = layers_of(image, "a.exr");
  EXPECT_EQ(picture.width, 8);
  EXPECT_EQ(picture.area, (PixelRectangle{3, 4, 1, 1}));
  EXPECT_THAT(names_of(picture), ElementsAre("image", "A", "CryptoObject00", "albedo", "depth", "normal",
                                             "samples", "uv", "view.left"));
  EXPECT_THAT(picture.layer("image")->values, ElementsAre(1, 2, 3));
  EXPECT_THAT(picture.layer("albedo")->values, ElementsAre(5, 6, 7));
  EXPECT_THAT(picture.layer("depth")->values, ElementsAre(11, 11, 11));
  EXPECT_THAT(picture.layer("CryptoObject00")->values, ElementsAre(15, 15, 15));
  EXPECT_EQ(picture.layer("CryptoObject00")->kind, LayerKind::kIdentity);
  EXPECT_EQ(picture.layer("normal")->kind, LayerKind::kNormal);
  EXPECT_EQ(picture.layer("depth")->kind, LayerKind::kQuantity);
  EXPECT_EQ(picture.layer("missing"), nullptr);
}

TEST(PictureLayers, AGreyImageHasOneLayer) {
  EXPECT_THAT(names_of(layers_of(one_pixel({"Y"}), "")), ElementsAre("image"));
  EXPECT_THAT(names_of(layers_of(one_pixel({"normal.X", "normal.Y", "normal.Z"}), "")),
              ElementsAre("normal"));
}

TEST(PictureLayers, FilesForDisplaysBecomeLinear) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> grey{0, 128, 255};
  ASSERT_TRUE(
      write_file_atomically(folder.path() / "a.png", encode_png_bytes(1, 1, grey).value()).has_value());
  const auto image = read_linear_image(folder.path() / "a.png");
  ASSERT_TRUE(image.has_value()) << image.error().message;
  EXPECT_NEAR(srgb_from_linear(double(image->values[1])), 128 / 255.0, 1e-6);
  EXPECT_FALSE(read_linear_image(folder.path() / "b.png").has_value());
}

}  // namespace
}  // namespace penumbra
