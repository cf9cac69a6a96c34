#include "scheduler/image/image_files.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "scheduler/files/atomic_file.h"
#include "scheduler/image/tone_map.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;

/// A crop of 5 x 3 at (7, 2) of a film of 20 x 10, every value different and none representable as half
/// float.
Image layered_image() {
  Image image;
  image.data = {7, 2, 5, 3};
  image.display = {0, 0, 20, 10};
  image.channels = {"R",          "G",        "B",        "variance.R",   "variance.G",
                    "variance.B", "albedo.R", "albedo.G", "albedo.B",     "normal.X",
                    "normal.Y",   "normal.Z", "depth.Z",  "samples.count"};
  for (std::size_t i = 0; i < image.pixels() * image.channels.size(); ++i) {
    image.values.push_back(float(i) * 0.1f - 3.0f);
  }
  image.metadata = {{"penumbra:version", "0.1.0"},
                    {"penumbra:command", "penumbra render 'a b.xml' --spp 4"},
                    {"penumbra:incomplete", 1},
                    {"penumbra:defines", "a=1\nb=2"}};
  return image;
}

Image round_trip(const Expected<std::vector<std::uint8_t>>& bytes, const char* name) {
  const TemporaryFolder folder;
  if (!bytes) {
    ADD_FAILURE() << bytes.error().message;
    return {};
  }
  EXPECT_TRUE(write_file_atomically(folder / name, *bytes));
  const auto image = read_image(folder / name);
  EXPECT_TRUE(image) << image.error().message;
  return image.value_or(Image{});
}

TEST(Exr, KeepsEveryLayerBitForBit) {
  const Image written = layered_image();
  const Image read = round_trip(encode_exr(written), "a.exr");
  ASSERT_THAT(read.channels, ::testing::UnorderedElementsAreArray(written.channels));
  for (const std::string& name : written.channels) {
    const std::size_t from = *written.channel(name), to = *read.channel(name);
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < 5; ++x)
        EXPECT_EQ(read.at(x, y, to), written.at(x, y, from)) << name << x << ',' << y;
    }
  }
}

TEST(Exr, KeepsWindowsAndMetadata) {
  const Image read = round_trip(encode_exr(layered_image()), "a.exr");
  EXPECT_EQ(read.data, (PixelWindow{7, 2, 5, 3}));
  EXPECT_EQ(read.display, (PixelWindow{0, 0, 20, 10}));
  EXPECT_EQ(read.attribute("penumbra:version"), MetadataValue("0.1.0"));
  EXPECT_EQ(read.attribute("penumbra:command"), MetadataValue("penumbra render 'a b.xml' --spp 4"));
  EXPECT_EQ(read.attribute("penumbra:incomplete"), MetadataValue(1));
  EXPECT_EQ(read.attribute("penumbra:defines"), MetadataValue("a=1\nb=2"));
  EXPECT_EQ(read.attribute("compression"), MetadataValue("zip"));
  EXPECT_FALSE(read.attribute("penumbra:nothing"));
}

TEST(Exr, IsStoredAsFloat) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file_atomically(folder / "a.exr", *encode_exr(layered_image())));
  const auto input = OIIO::ImageInput::open((folder / "a.exr").string());
  ASSERT_TRUE(input);
  EXPECT_EQ(input->spec().format, OIIO::TypeDesc::FLOAT);
}

TEST(ImageFiles, AreTheSameBytesAtAnotherTime) {
  const auto exr = encode_exr(layered_image()), png = encode_png(layered_image());
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // time stamps count seconds
  ASSERT_TRUE(exr && png);
  EXPECT_EQ(*encode_exr(layered_image()), *exr);
  EXPECT_EQ(*encode_png(layered_image()), *png);
}

TEST(Png, HoldsTheToneMappedBeautyOfTheCrop) {
  const Image image = layered_image();
  const Image png = round_trip(encode_png(image), "a.png");
  EXPECT_THAT(png.channels, ElementsAre("R", "G", "B"));
  ASSERT_EQ(png.data.width, 5);
  ASSERT_EQ(png.data.height, 3);
  std::vector<float> expected;
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) {
      for (const std::size_t c : {0, 1, 2})
        expected.push_back(float(display_byte(image.at(x, y, c))) / 255.0f);
    }
  }
  EXPECT_THAT(png.values, ElementsAreArray(expected));
}

TEST(Png, NeedsABeautyLayer) {
  Image image = layered_image();
  image.channels[0] = "X";
  EXPECT_FALSE(encode_png(image));
}

}  // namespace
}  // namespace penumbra
