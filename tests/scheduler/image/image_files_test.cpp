#include "scheduler/image/image_files.h"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <thread>

#include "kernels/host/atomic_file.h"
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
  image.channels = {"R",          "G",        "B",        "variance.R", "variance.G",
                    "variance.B", "albedo.R", "albedo.G", "albedo.B",   "normal.X",
                    "normal.Y",   "normal.Z", "depth.Z",  "samples.Y"};
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

/// How the file stores each channel.
std::map<std::string, Imf::PixelType> stored_types(const std::vector<std::uint8_t>& bytes) {
  const TemporaryFolder folder;
  EXPECT_TRUE(write_file_atomically(folder / "a.exr", bytes));
  const Imf::InputFile file((folder / "a.exr").c_str());
  std::map<std::string, Imf::PixelType> types;
  const Imf::ChannelList& channels = file.header().channels();
  for (auto channel = channels.begin(); channel != channels.end(); ++channel)
    types[channel.name()] = channel.channel().type;
  return types;
}

TEST(Exr, IsStoredAsFloat) {
  const auto types = stored_types(*encode_exr(layered_image()));
  EXPECT_EQ(types.size(), layered_image().channels.size());
  for (const auto& [name, type] : types) EXPECT_EQ(type, Imf::FLOAT) << name;
}

TEST(Exr, KeepsCameraColoursAndNumbers) {
  Image written = layered_image();
  EXPECT_FALSE(round_trip(encode_exr(written), "a.exr").camera);
  EXPECT_FALSE(round_trip(encode_exr(written), "a.exr").chromaticities);
  written.chromaticities = kRec709;
  RowMatrix& to_film = written.camera.emplace().world_to_ndc.emplace();
  for (std::size_t i = 0; i < 16; ++i) {
    written.camera->world_to_camera[i] = 0.1f * float(i);
    to_film[i] = -0.3f * float(i);
  }
  written.metadata.emplace_back("penumbra:seed", 4e9);
  written.metadata.emplace_back("penumbra:number", 0.1f);
  const Image read = round_trip(encode_exr(written), "a.exr");
  EXPECT_EQ(read.camera, written.camera);
  EXPECT_EQ(read.chromaticities, written.chromaticities);
  EXPECT_EQ(read.attribute("penumbra:seed"), MetadataValue(4e9));
  EXPECT_EQ(read.attribute("penumbra:number"), MetadataValue(0.1f));
}

TEST(Exr, HalfIsOfColoursAlone) {
  Image written = layered_image();
  written.channels[12] = "A";
  written.channels[10] = "depth.Z";
  written.values[0] = 1e6f;
  written.values[1] = -1e6f;
  written.values[3] = 1e6f;  // a variance
  EXPECT_EQ(values_beyond_half(written), 2u);
  const auto bytes = encode_exr(written, {.half = true});
  ASSERT_TRUE(bytes);
  const auto types = stored_types(*bytes);
  EXPECT_EQ(types.size(), written.channels.size());
  for (const auto& [name, type] : types) {
    const bool whole = name.starts_with("variance") || name == "depth.Z" || name == "samples.Y";
    EXPECT_EQ(type, whole ? Imf::FLOAT : Imf::HALF) << name;
  }
  const Image read = round_trip(bytes, "a.exr");
  EXPECT_EQ(read.at(0, 0, *read.channel("R")), 65504.0f);
  EXPECT_EQ(read.at(0, 0, *read.channel("G")), -65504.0f);
  for (const std::string& name : written.channels)
    for (int x = 1; x < 5; ++x) {
      const float value = written.at(x, 1, *written.channel(name));
      // Halves have 11 bits.
      const float rounding = is_half_channel(name) ? std::abs(value) * 0x1p-11f : 0.0f;
      EXPECT_NEAR(read.at(x, 1, *read.channel(name)), value, rounding) << name;
    }
}

TEST(Exr, EveryCompressionIsReadBack) {
  using enum ExrCompression;
  const Image written = layered_image();
  const std::pair<ExrCompression, const char*> names[] = {
      {kNone, "none"},   {kRle, "rle"}, {kZips, "zips"}, {kZip, "zip"},   {kPiz, "piz"},
      {kPxr24, "pxr24"}, {kB44, "b44"}, {kB44a, "b44a"}, {kDwaa, "dwaa"}, {kDwab, "dwab"}};
  for (const auto& [compression, name] : names) {
    const auto bytes = encode_exr(written, {.compression = compression});
    ASSERT_TRUE(bytes) << name;
    EXPECT_EQ(*bytes, *encode_exr(written, {.compression = compression})) << name;
    const Image read = round_trip(bytes, "a.exr");
    const auto said = read.attribute("compression");
    ASSERT_TRUE(said) << name;
    EXPECT_TRUE(std::get<std::string>(*said).starts_with(name)) << std::get<std::string>(*said);
    if (compression >= kPxr24) continue;
    for (const std::string& channel : written.channels)
      for (int x = 0; x < 5; ++x)
        EXPECT_EQ(read.at(x, 2, *read.channel(channel)), written.at(x, 2, *written.channel(channel))) << name;
  }
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

TEST(Png, WithAlphaHasTheColoursOfWhatCovers) {
  Image image;
  image.data = image.display = {0, 0, 4, 1};
  image.channels = {"R", "G", "B", "A"};
  image.values = {0.5f, 0.25f, 0, 1, 0.125f, 0.0625f, 0, 0.25f, 0, 0, 0, 0, 0.5f, 0, 0, 1.001f};
  const Image png = round_trip(encode_png(image), "a.png");
  ASSERT_THAT(png.channels, ElementsAre("R", "G", "B", "A"));
  const auto byte = [&](int x, std::size_t c) { return std::lround(255 * png.at(x, 0, c)); };
  EXPECT_EQ(byte(0, 3), 255);
  EXPECT_EQ(byte(1, 3), 64);
  EXPECT_EQ(byte(2, 3), 0);
  EXPECT_EQ(byte(3, 3), 255);
  EXPECT_EQ(byte(0, 0), display_byte(0.5f));
  // OpenImageIO multiplies by alpha again, in the signal.
  EXPECT_NEAR(byte(1, 0), display_byte(0.5f) * 0.25, 1);
}

TEST(Png, NeedsABeautyLayer) {
  Image image = layered_image();
  image.channels[0] = "X";
  EXPECT_FALSE(encode_png(image));
}

}  // namespace
}  // namespace penumbra
