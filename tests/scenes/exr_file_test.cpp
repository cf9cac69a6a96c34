// OpenEXR files of all kinds: types, names, parts, windows, levels, luminance with chroma, damage.
#include "scenes/image/exr_file.h"

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfTiledRgbaFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "scenes/image/bitmap_reader.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::exr_file_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::size_t kAny = std::size_t{1} << 30;

/// One part: channels with their values, rows from the top.
template <typename Value>
using Channels = std::map<std::string, std::vector<Value>>;

class ExrFiles : public ::testing::Test {
 protected:
  inline static const Imath::Box2i kWindow{{0, 0}, {1, 0}};  // two texels

  static Imf::Header header_of(const std::string& part, Imf::PixelType type,
                               const std::vector<std::string>& names, Imath::Box2i window = kWindow) {
    Imf::Header header(Imath::Box2i({0, 0}, {9, 9}), window);
    header.setName(part);
    header.setType(Imf::SCANLINEIMAGE);
    for (const std::string& name : names) header.channels().insert(name, Imf::Channel(type));
    return header;
  }
  template <typename Value>
  static Imf::Header header_of(const std::string& part, Imf::PixelType type,
                               const Channels<Value>& channels) {
    std::vector<std::string> names;
    for (const auto& [name, values] : channels) names.push_back(name);
    return header_of(part, type, names);
  }
  template <typename Value>
  static void write_part(Imf::MultiPartOutputFile& file, int part, Imf::PixelType type,
                         Channels<Value> channels, Imath::Box2i window = kWindow) {
    Imf::FrameBuffer buffer;
    const std::size_t width = std::size_t(window.max.x - window.min.x + 1);
    for (auto& [name, values] : channels)
      buffer.insert(name,
                    Imf::Slice::Make(type, values.data(), window, sizeof(Value), sizeof(Value) * width));
    Imf::OutputPart out(file, part);
    out.setFrameBuffer(buffer);
    out.writePixels(window.max.y - window.min.y + 1);
  }
  template <typename Value>
  std::string file_of(Imf::PixelType type, const Channels<Value>& channels) {
    const Imf::Header header = header_of("only", type, channels);
    {
      Imf::MultiPartOutputFile file(path().c_str(), &header, 1);
      write_part(file, 0, type, channels);
    }
    return file_contents(path());
  }
  std::string path() { return (folder_ / "a.exr").string(); }

  /// The texels of a bitmap of floats.
  static std::vector<float> values(const std::string& contents) {
    BitmapFindings findings;
    const auto bitmap = read_bitmap("a.exr", contents, BitmapChannels::kAll, findings);
    if (!bitmap) return ADD_FAILURE() << bitmap.error().message, std::vector<float>();
    EXPECT_EQ(bitmap->type, TexelType::kFloat);
    std::vector<float> values(bitmap->words.size());
    std::memcpy(values.data(), bitmap->words.data(), values.size() * sizeof(float));
    return values;
  }
  static std::string error(const std::string& contents) {
    const auto image = read_exr(contents, kAny);
    return image ? "no error" : image.error().message;
  }

  TemporaryFolder folder_;
};

TEST_F(ExrFiles, IntegersAreTheNumbersThatTheyAre) {
  const auto file =
      file_of<std::uint32_t>(Imf::UINT, {{"R", {5, 0}}, {"G", {14, 1}}, {"B", {70000, 4000000000u}}});
  EXPECT_THAT(values(file), ElementsAre(5, 14, 70000, 0, 1, 4e9f));
}

TEST_F(ExrFiles, NamesOfColoursMayBeLowerCaseOrWhole) {
  for (const auto& [r, g, b] : {std::tuple("r", "g", "b"), {"R", "G", "B"}, {"Red", "Green", "Blue"}})
    EXPECT_THAT(values(file_of<float>(Imf::FLOAT, {{r, {1, 2}}, {g, {3, 4}}, {b, {5, 6}}, {"a", {7, 8}}})),
                ElementsAre(1, 3, 5, 2, 4, 6));
  EXPECT_THAT(values(file_of<float>(Imf::FLOAT, {{"y", {1, 2}}, {"Z", {3, 4}}})), ElementsAre(1, 2));
  EXPECT_THAT(values(file_of<float>(Imf::FLOAT, {{"height", {1, 2}}})), ElementsAre(1, 2)) << "the only one";
}

TEST_F(ExrFiles, ThePartWithColoursIsRead) {
  const Channels<float> depth = {{"Z", {100, 200}}}, normal = {{"N.X", {7, 7}}, {"N.Y", {8, 8}}},
                        colour = {{"R", {1, 2}}, {"G", {3, 4}}, {"B", {5, 6}}};
  const auto of = [&](const std::vector<Channels<float>>& parts) {
    std::vector<Imf::Header> headers;
    for (std::size_t i = 0; i < parts.size(); ++i)
      headers.push_back(header_of("part" + std::to_string(i), Imf::FLOAT, parts[i]));
    {
      Imf::MultiPartOutputFile file(path().c_str(), headers.data(), int(headers.size()));
      for (std::size_t i = 0; i < parts.size(); ++i) write_part(file, int(i), Imf::FLOAT, parts[i]);
    }
    return file_contents(path());
  };
  EXPECT_THAT(values(of({depth, normal, colour})), ElementsAre(1, 3, 5, 2, 4, 6));
  EXPECT_THAT(values(of({colour, depth})), ElementsAre(1, 3, 5, 2, 4, 6));
  EXPECT_THAT(error(of({depth, normal})), HasSubstr("has 2 parts, none of which has colours"));
}

TEST_F(ExrFiles, WhatHasNoColoursIsRefused) {
  EXPECT_THAT(error(file_of<float>(Imf::FLOAT,
                                   {{"diffuse.R", {1, 2}}, {"diffuse.G", {1, 2}}, {"diffuse.B", {1, 2}}})),
              HasSubstr("has 3 channels (diffuse.B, diffuse.G, diffuse.R); a texture has Y, or R, G and B"));
  EXPECT_THAT(error(file_of<float>(Imf::FLOAT, {{"X", {1, 2}}, {"Y", {1, 2}}, {"Z", {1, 2}}})),
              HasSubstr("has the channels X, Y and Z"));
  EXPECT_THAT(error(file_of<float>(Imf::FLOAT, {{"R", {1, 2}}, {"G", {1, 2}}})), HasSubstr("has 2 channels"));

  Imf::Header header = header_of("deep", Imf::HALF, {"R", "G", "B"});
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  {
    Imf::DeepScanLineOutputFile file(path().c_str(), header);
    std::vector<unsigned> counts(2, 0);
    std::vector<half*> none(2, nullptr);
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()),
                                             sizeof(unsigned), 2 * sizeof(unsigned)));
    for (const char* name : {"R", "G", "B"})
      buffer.insert(name, Imf::DeepSlice(Imf::HALF, reinterpret_cast<char*>(none.data()), sizeof(half*),
                                         2 * sizeof(half*), sizeof(half)));
    file.setFrameBuffer(buffer);
    file.writePixels(1);
  }
  EXPECT_THAT(error(file_contents(path())), HasSubstr("is a deep image"));
}

TEST_F(ExrFiles, TheDataWindowIsTheImage) {
  const Imath::Box2i window({-3, 5}, {-2, 7});
  const Channels<float> channels = {
      {"R", {0, 1, 2, 3, 4, 5}}, {"G", {0, 1, 2, 3, 4, 5}}, {"B", {0, 1, 2, 3, 4, 5}}};
  const Imf::Header header = header_of("only", Imf::FLOAT, {"R", "G", "B"}, window);
  {
    Imf::MultiPartOutputFile file(path().c_str(), &header, 1);
    write_part(file, 0, Imf::FLOAT, channels, window);
  }
  const auto image = read_exr(file_contents(path()), kAny);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, 2);
  EXPECT_EQ(image->height, 3);
  EXPECT_THAT(values(file_contents(path())),
              ElementsAre(0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4, 5, 5, 5));
}

TEST_F(ExrFiles, OfSeveralLevelsTheFinestIsRead) {
  constexpr int kSide = 8;
  {
    Imf::TiledRgbaOutputFile file(path().c_str(), kSide, kSide, 4, 4, Imf::MIPMAP_LEVELS, Imf::ROUND_DOWN);
    for (int level = 0; level < file.numLevels(); ++level) {
      const std::vector<Imf::Rgba> texels(kSide * kSide, Imf::Rgba(half(level + 1), 0, 0));
      file.setFrameBuffer(texels.data(), 1, kSide);
      file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
    }
  }
  const auto image = read_exr(file_contents(path()), kAny);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, kSide);
  half red;
  std::memcpy(&red, image->bytes.data() + image->bytes.size() - 4 * sizeof(half), sizeof red);
  EXPECT_EQ(float(red), 1);
}

TEST_F(ExrFiles, LuminanceWithChromaIsColours) {
  constexpr int kWidth = 6, kHeight = 4;
  const Imf::Rgba colour(0.75f, 0.5f, 0.25f);
  {
    Imf::RgbaOutputFile file(path().c_str(), kWidth, kHeight, Imf::WRITE_YC);
    const std::vector<Imf::Rgba> texels(kWidth * kHeight, colour);
    file.setFrameBuffer(texels.data(), 1, kWidth);
    file.writePixels(kHeight);
  }
  const auto image = read_exr(file_contents(path()), kAny);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_THAT(image->channels, ElementsAre("R", "G", "B", "A"));
  // Luminance, and chroma relative to it, are rounded to halfs each way: 4 roundings of 2^-11.
  constexpr float kRounding = 4 * 0x1p-11f;
  for (std::size_t i = 0; i < std::size_t(kWidth * kHeight); ++i) {
    Imf::Rgba texel;
    std::memcpy(&texel, image->bytes.data() + i * sizeof texel, sizeof texel);
    EXPECT_NEAR(texel.r, 0.75f, kRounding) << i;
    EXPECT_NEAR(texel.g, 0.5f, kRounding) << i;
    EXPECT_NEAR(texel.b, 0.25f, kRounding) << i;
  }
}

TEST_F(ExrFiles, EveryTruncationIsAnError) {
  const std::string whole = file_of<float>(Imf::FLOAT, {{"R", {1, 2}}, {"G", {3, 4}}, {"B", {5, 6}}});
  for (std::size_t size = 4; size < whole.size(); ++size)
    ASSERT_FALSE(read_exr(whole.substr(0, size), kAny)) << size;
}

}  // namespace
}  // namespace penumbra::exr_file_test
