// Textures of Mitsuba's scenes: image files of every format, parameters, nesting, and texture coordinates.
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "kernels/host/device_scene.h"
#include "scenes/device/device_scene_builder.h"
#include "tests/scenes/scene_text.h"
#include "tests/support/tga_file.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class MitsubaTextures : public SceneText {
 protected:
  static std::string bitmap(const std::string& name, const std::string& inside = "") {
    return "<texture type='bitmap' name='reflectance'><string name='filename' value='" + name + "'/>" +
           inside + "</texture>";
  }
  static std::string shape(const std::string& texture, const std::string& type = "sphere",
                           const std::string& inside = "") {
    return "<shape type='" + type + "'>" + inside + "<bsdf type='diffuse'>" + texture + "</bsdf></shape>";
  }

  /// An image through OpenImageIO, its format by the name. Rows are written one by one: write_image() would
  /// start threads, and a lock that one of them holds stays locked in the copy of this process that reads
  /// images.
  template <typename Value>
  void write_image(const std::string& name, int width, int height, const std::vector<std::string>& channels,
                   OIIO::TypeDesc format, const std::vector<Value>& values) {
    const std::string path = (folder_ / name).string();
    auto output = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(output) << name;
    OIIO::ImageSpec spec(width, height, int(channels.size()), format);
    spec.channelnames = channels;
    spec.attribute("oiio:UnassociatedAlpha", 1);
    ASSERT_TRUE(output->open(path, spec)) << output->geterror();
    for (int y = 0; y < height; ++y)
      ASSERT_TRUE(output->write_scanline(y, 0, OIIO::BaseTypeFromC<Value>::value,
                                         values.data() + std::size_t(y * width) * channels.size()));
    ASSERT_TRUE(output->close());
  }
  void write_tga(const std::string& name, int width, int height, int channels,
                 const std::vector<std::uint8_t>& values) {
    write(name, tga_file(width, height, channels, values));
  }

  static std::vector<std::uint8_t> bytes_of(const Bitmap& bitmap) {
    const auto* from = reinterpret_cast<const std::uint8_t*>(bitmap.words.data());
    return {from, from + std::size_t(bitmap.width * bitmap.height * bitmap.channels) * size_of(bitmap.type)};
  }
  template <typename Value>
  static std::vector<Value> values_of(const Bitmap& bitmap) {
    const std::vector<std::uint8_t> bytes = bytes_of(bitmap);
    std::vector<Value> values(bytes.size() / sizeof(Value));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }

  template <typename Model>
  static Model model(const SceneDescription& scene, std::size_t index = 0) {
    return std::get<Model>(scene.textures.at(index).model);
  }
};

const std::vector<std::string> kRgb{"R", "G", "B"}, kRgba{"R", "G", "B", "A"}, kGrey{"Y"},
    kGreyAlpha{"Y", "A"};

TEST_F(MitsubaTextures, BytesStayBytes) {
  const std::vector<std::uint8_t> rgb{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  for (const std::string name : {"a.png", "a.tif", "a.bmp", "a.tga"}) {
    write_image(name, 2, 2, kRgb, OIIO::TypeDesc::UINT8, rgb);
    const SceneDescription s = good(shape(bitmap(name)));
    ASSERT_THAT(s.bitmaps, SizeIs(1)) << name;
    const Bitmap& b = *s.bitmaps[0];
    EXPECT_EQ(b.width, 2);
    EXPECT_EQ(b.height, 2);
    EXPECT_EQ(b.channels, 3);
    EXPECT_EQ(b.type, TexelType::kByte);
    EXPECT_EQ(b.words.size(), 3u);
    EXPECT_EQ(bytes_of(b), rgb) << name;
    EXPECT_THAT(s.warnings, IsEmpty());
  }
  // JPEG is lossy; a plain grey is near.
  write_image("a.jpg", 16, 16, kRgb, OIIO::TypeDesc::UINT8, std::vector<std::uint8_t>(3 * 256, 100));
  for (const std::uint8_t value : bytes_of(*good(shape(bitmap("a.jpg"))).bitmaps.at(0)))
    ASSERT_NEAR(value, 100, 2);
}

TEST_F(MitsubaTextures, AlphaIsLeftOutAndColoursStayAsTheyAre) {
  write_image("rgba.png", 1, 2, kRgba, OIIO::TypeDesc::UINT8,
              std::vector<std::uint8_t>{200, 100, 50, 10, 1, 2, 3, 0});
  const SceneDescription s = good(shape(bitmap("rgba.png")));
  EXPECT_THAT(bytes_of(*s.bitmaps.at(0)), ElementsAre(200, 100, 50, 1, 2, 3));
  write_image("ya.png", 1, 2, kGreyAlpha, OIIO::TypeDesc::UINT8, std::vector<std::uint8_t>{200, 100, 50, 10});
  const SceneDescription grey = good(shape(bitmap("ya.png")));
  EXPECT_EQ(grey.bitmaps.at(0)->channels, 1);
  EXPECT_THAT(bytes_of(*grey.bitmaps.at(0)), ElementsAre(200, 50));
}

TEST_F(MitsubaTextures, OneChannelMayBeChosen) {
  write_image("rgba.png", 1, 1, kRgba, OIIO::TypeDesc::UINT8, std::vector<std::uint8_t>{200, 100, 50, 10});
  const std::string names[] = {"r", "g", "b", "a"};
  const int values[] = {200, 100, 50, 10};
  std::string all;
  for (const std::string& name : names)
    all += shape(bitmap("rgba.png", "<string name='channel' value='" + name + "'/>"));
  const SceneDescription s = good(all);
  ASSERT_THAT(s.bitmaps, SizeIs(4));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(s.bitmaps[i]->channels, 1);
    EXPECT_THAT(bytes_of(*s.bitmaps[i]), ElementsAre(values[i]));
  }
  write_image("rgb.png", 1, 1, kRgb, OIIO::TypeDesc::UINT8, std::vector<std::uint8_t>{1, 2, 3});
  EXPECT_THAT(error(scene(shape(bitmap("rgb.png", "<string name='channel' value='a'/>")))),
              HasSubstr("'rgb.png' has 3 channels (R, G, B); the one that is asked for is not there"));
}

TEST_F(MitsubaTextures, BlackAndWhiteTiffsAreWhatTheyAreOrRefused) {
  // One row of eight texels of one bit, with BitsPerSample (tag 258) and without, which means 1, too.
  const auto tiff = [](bool says_bits) {
    struct Entry {
      std::uint16_t tag, type;
      std::uint32_t count, value;
    };
    static_assert(sizeof(Entry) == 12);
    std::vector<Entry> entries = {{256, 4, 1, 8}, {257, 4, 1, 1}, {259, 3, 1, 1}, {262, 3, 1, 1},
                                  {273, 4, 1, 0}, {278, 4, 1, 1}, {279, 4, 1, 1}};
    if (says_bits) entries.insert(entries.begin() + 2, {258, 3, 1, 1});
    const auto count = std::uint16_t(entries.size());
    const std::uint32_t data = 8 + 2 + count * 12u + 4;
    for (Entry& entry : entries)
      if (entry.tag == 273) entry.value = data;
    std::string file("II*\0\x08\0\0\0", 8);
    file.append(reinterpret_cast<const char*>(&count), 2);
    file.append(reinterpret_cast<const char*>(entries.data()), entries.size() * 12);
    return file + std::string(4, '\0') + '\xb1';
  };
  write("bits.tif", tiff(true));
  EXPECT_THAT(bytes_of(*good(shape(bitmap("bits.tif"))).bitmaps.at(0)),
              ElementsAre(255, 0, 255, 255, 0, 0, 0, 255));
  write("none.tif", tiff(false));
  EXPECT_THAT(error(scene(shape(bitmap("none.tif")))), HasSubstr("states no bits per sample"));
}

TEST_F(MitsubaTextures, WhatCrashesALibraryIsAnError) {
  // An icon of 0 bits a texel: OpenImageIO 2.4 divides by them.
  const std::string header("\0\0\1\0\1\0\x05\x06\0\0\1\0\0\0\x28\0\0\0\x16\0\0\0", 22);
  const std::string picture("\x28\0\0\0\x05\0\0\0\x0c\0\0\0\1\0\0\0", 16);
  write("a.ico", header + picture + std::string(200, '\0'));
  EXPECT_THAT(error(scene(shape(bitmap("a.ico")))), HasSubstr("'a.ico' cannot be read"));
}

TEST_F(MitsubaTextures, WiderFormatsStayToo) {
  const std::vector<std::uint16_t> shorts{0, 1, 65535, 1000, 2000, 3000};
  write_image("a.png", 2, 1, kRgb, OIIO::TypeDesc::UINT16, shorts);
  const SceneDescription s = good(shape(bitmap("a.png")));
  EXPECT_EQ(s.bitmaps.at(0)->type, TexelType::kShort);
  EXPECT_EQ(values_of<std::uint16_t>(*s.bitmaps[0]), shorts);
  EXPECT_EQ(model<BitmapTexture>(s).gamma, kSrgb);
  const std::vector<float> floats{0.0f, 0.25f, 1.0f, 0.5f, 0.125f, 0.75f};
  for (const std::string name : {"a.exr", "a.tif", "a.hdr"}) {
    write_image(name, 2, 1, kRgb, OIIO::TypeDesc::FLOAT, floats);
    const SceneDescription f = good(shape(bitmap(name)));
    EXPECT_EQ(f.bitmaps.at(0)->type, TexelType::kFloat) << name;
    EXPECT_EQ(values_of<float>(*f.bitmaps[0]), floats) << name;
  }
  write_image("half.exr", 2, 1, kRgb, OIIO::TypeDesc::HALF, floats);
  const SceneDescription h = good(shape(bitmap("half.exr")));
  EXPECT_EQ(h.bitmaps.at(0)->type, TexelType::kHalf);
  EXPECT_THAT(values_of<std::uint16_t>(*h.bitmaps[0]),
              ElementsAre(0, 0x3400, 0x3c00, 0x3800, 0x3000, 0x3a00));
  write_image("y.exr", 2, 1, kGrey, OIIO::TypeDesc::HALF, std::vector<float>{0.25f, 1.0f});
  EXPECT_EQ(good(shape(bitmap("y.exr"))).bitmaps.at(0)->channels, 1);
}

// Their values are the numbers themselves, so there is no table of those, however few texels there are.
TEST_F(MitsubaTextures, LinearBitmapsOfAnySizeCanBeRendered) {
  const std::string raw = "<boolean name='raw' value='true'/>";
  const auto can_be_rendered = [&](const std::string& file) {
    const auto built = build_device_scene(good(shape(bitmap(file, raw))), {});
    EXPECT_TRUE(built) << file << ": " << built.error().message;
  };
  for (const int side : {1, 8, 256, 361}) {
    write_image("grey.png", side, side, kGrey, OIIO::TypeDesc::UINT16,
                std::vector<std::uint16_t>(std::size_t(side) * std::size_t(side), 1000));
    can_be_rendered("grey.png");
    write_image("grey8.png", side, side, kGrey, OIIO::TypeDesc::UINT8,
                std::vector<std::uint8_t>(std::size_t(side) * std::size_t(side), 100));
    can_be_rendered("grey8.png");
  }
  write_image("rgb.png", 128, 128, kRgb, OIIO::TypeDesc::UINT16,
              std::vector<std::uint16_t>(3 * 128 * 128, 1000));
  can_be_rendered("rgb.png");
}

TEST_F(MitsubaTextures, OtherLayersThanTheColoursAreLeftOut) {
  write_image("layers.exr", 1, 1, {"R", "G", "B", "albedo.R", "depth.Z"}, OIIO::TypeDesc::FLOAT,
              std::vector<float>{0.25f, 0.5f, 0.75f, 7.0f, 9.0f});
  const SceneDescription s = good(shape(bitmap("layers.exr")));
  ASSERT_EQ(s.bitmaps.at(0)->channels, 3);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_EQ(std::bit_cast<float>(s.bitmaps[0]->words.at(c)), 0.25f * float(c + 1));
}

/// What the chromaticities of a file say is told by the closed form: with those of XYZ its numbers are X, Y,
/// Z.
TEST_F(MitsubaTextures, ColoursOfOtherPrimariesBecomeRec709) {
  const glm::dvec3 rgb(0.5, 0.25, 0.1);
  const auto xyz_of = [](const glm::dvec3& c) {  // IEC 61966-2-1, to four decimals
    return glm::vec3(0.4124 * c.x + 0.3576 * c.y + 0.1805 * c.z, 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z,
                     0.0193 * c.x + 0.1192 * c.y + 0.9505 * c.z);
  };
  const auto read_with = [&](const std::array<float, 8>& chromaticities, const glm::vec3& values) {
    OIIO::ImageSpec spec(1, 1, 3, OIIO::TypeDesc::FLOAT);
    spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), chromaticities.data());
    const auto out = OIIO::ImageOutput::create((folder_ / "c.exr").string());
    EXPECT_TRUE(out->open((folder_ / "c.exr").string(), spec) &&
                out->write_image(OIIO::TypeDesc::FLOAT, &values));
    EXPECT_TRUE(out->close());
    const SceneDescription s = good(shape(bitmap("c.exr")));
    glm::dvec3 result(0.0);
    for (int c = 0; c < 3; ++c) result[c] = std::bit_cast<float>(s.bitmaps.at(0)->words.at(std::size_t(c)));
    return result;
  };
  constexpr float kThird = 1.0f / 3.0f, kDecimals = 1e-4f;
  const glm::dvec3 of_xyz = read_with({1, 0, 0, 1, 0, 0, kThird, kThird}, xyz_of(rgb));
  const glm::dvec3 same = read_with({0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f}, rgb);
  // White of any primaries that have the white of Rec. 709 is white.
  const glm::dvec3 white =
      read_with({0.708f, 0.292f, 0.17f, 0.797f, 0.131f, 0.046f, 0.3127f, 0.329f}, glm::vec3(0.5f));
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(of_xyz[c], rgb[c], 10 * kDecimals);  // rows of the inverse add up to less than 10
    EXPECT_EQ(same[c], double(float(rgb[c])));
    EXPECT_NEAR(white[c], 0.5, 1e-6);
  }
  write_image("none.exr", 1, 1, kRgb, OIIO::TypeDesc::FLOAT, std::vector<float>(3, 0.5f));
  EXPECT_EQ(std::bit_cast<float>(good(shape(bitmap("none.exr"))).bitmaps.at(0)->words.at(0)), 0.5f);
}

TEST_F(MitsubaTextures, OtherChannelsThanATexturesAreAnError) {
  write_image("five.exr", 1, 1, {"R", "G", "X", "Z", "A"}, OIIO::TypeDesc::FLOAT,
              std::vector<float>(5, 0.5f));
  EXPECT_THAT(
      error(scene(shape(bitmap("five.exr")))),
      AllOf(HasSubstr("scene.xml:2:"),
            HasSubstr("'five.exr' has 5 channels (A, G, R, X, Z); a texture has Y, or R, G and B, each "
                      "with A or without")));
  write_image("layers.exr", 1, 1, {"a.R", "a.G", "a.B"}, OIIO::TypeDesc::FLOAT, std::vector<float>(3, 0.5f));
  EXPECT_THAT(error(scene(shape(bitmap("layers.exr")))), HasSubstr("has 3 channels (a.B, a.G, a.R)"));
}

TEST_F(MitsubaTextures, MissingAndBrokenFilesAreErrorsWithTheirPlace) {
  EXPECT_THAT(error(scene(shape(bitmap("none.png")))),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("there is no file 'none.png'")));
  write("broken.png", "\x89PNG\r\n\x1a\n and no more");
  EXPECT_THAT(error(scene(shape(bitmap("broken.png")))),
              AllOf(HasSubstr("scene.xml:2:"), HasSubstr("'broken.png' cannot be read as an image: ")));
  write("text.jpg", "not an image");
  EXPECT_THAT(error(scene(shape(bitmap("text.jpg")))), HasSubstr("'text.jpg' cannot be read as an image: "));
  write("empty.exr", "");
  EXPECT_THAT(error(scene(shape(bitmap("empty.exr")))),
              HasSubstr("'empty.exr' cannot be read as an image: "));
  std::vector<std::uint8_t> noise;
  for (std::uint32_t i = 0, n = 1; i < 64 * 64 * 3; ++i)
    noise.push_back(std::uint8_t((n = n * 1664525 + 1013904223) >> 24));
  for (const std::string name : {"cut.png", "cut.jpg", "cut.tif", "cut.bmp", "cut.tga"}) {
    write_image(name, 64, 64, kRgb, OIIO::TypeDesc::UINT8, noise);
    const std::string whole = file_contents(folder_ / name);
    write(name, whole.substr(0, whole.size() / 2));
    EXPECT_THAT(error(scene(shape(bitmap(name)))), HasSubstr("'" + name + "' cannot be read as an image: "));
  }
  EXPECT_THAT(error(scene(shape("<texture type='bitmap' name='reflectance'/>"))),
              HasSubstr("a bitmap needs a <string name=\"filename\" …>"));
  EXPECT_THAT(error(scene(shape(bitmap("../../../../../etc/hostname"))), {.confine_to = folder_.path()}),
              HasSubstr("leads outside the folder"));
}

TEST_F(MitsubaTextures, LenientlyACheckerboardStandsInForThem) {
  write("broken.png", "no");
  const SceneDescription s = good(shape(bitmap("none.png")) + shape(bitmap("broken.png")), {.lenient = true});
  ASSERT_THAT(s.textures, SizeIs(2));
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(model<CheckerboardTexture>(s, i).color0, glm::vec3(0.8f, 0.2f, 0.8f));
  EXPECT_THAT(
      s.warnings,
      ::testing::UnorderedElementsAre(
          AllOf(HasSubstr("no file 'none.png'"), HasSubstr("; a magenta checkerboard stands in")),
          AllOf(HasSubstr("broken.png' cannot be read"), HasSubstr("; a magenta checkerboard stands in"))));
}

TEST_F(MitsubaTextures, SizesBeyondReasonAreErrorsBeforeTheyAreRead) {
  // A header alone: nothing may be allocated on its word.
  std::string huge = tga_file(60000, 60000, 3, {});
  write("huge.tga", huge);
  EXPECT_THAT(error(scene(shape(bitmap("huge.tga")))),
              HasSubstr("'huge.tga' has 60000 x 60000 texels of 3 channels, 10.1 GiB; 2 GiB are the most"));
  write("none.tga", tga_file(0, 0, 3, {}));
  EXPECT_THAT(error(scene(shape(bitmap("none.tga")))), HasSubstr("'none.tga' "));
}

TEST_F(MitsubaTextures, ValuesThatAreNoneAreCountedAndBlack) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const std::vector<float> values{0.5f, 0.5f, 0.5f, 0.5f, nan, 0.5f, inf, -inf, 0.25f};
  for (const bool half : {false, true}) {
    write_image("bad.exr", 3, 1, kRgb, half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT, values);
    const SceneDescription s = good(shape(bitmap("bad.exr")));
    ASSERT_THAT(s.warnings, SizeIs(1));
    EXPECT_THAT(s.warnings[0],
                AllOf(HasSubstr("bad.exr' has 3 values that are not finite, the first at texel "
                                "(1, 0); 0 stands in for them")));
    if (half)
      EXPECT_THAT(values_of<std::uint16_t>(*s.bitmaps.at(0)),
                  ElementsAre(0x3800, 0x3800, 0x3800, 0x3800, 0, 0x3800, 0, 0, 0x3400));
    else
      EXPECT_THAT(values_of<float>(*s.bitmaps.at(0)),
                  ElementsAre(0.5f, 0.5f, 0.5f, 0.5f, 0.0f, 0.5f, 0.0f, 0.0f, 0.25f));
  }
  write_image("bright.exr", 1, 1, kRgb, OIIO::TypeDesc::FLOAT, std::vector<float>{0.5f, 1.5f, -1.0f});
  EXPECT_THAT(good(shape(bitmap("bright.exr"))).warnings,
              ElementsAre(HasSubstr("has 2 values outside [0, 1]")));
  EXPECT_THAT(good(shape(bitmap("bright.exr", "<boolean name='raw' value='true'/>"))).warnings, IsEmpty());
}

TEST_F(MitsubaTextures, EqualFilesAreReadAndShippedOnce) {
  const std::vector<std::uint8_t> values(3 * 16 * 16, 7);
  write_tga("a.tga", 16, 16, 3, values);
  write_tga("copy.tga", 16, 16, 3, values);
  write_tga("grey.tga", 16, 16, 1, std::vector<std::uint8_t>(256, 9));
  const std::string turned = "<transform name='to_uv'><scale value='2'/></transform>";
  const std::string all =
      shape(bitmap("a.tga")) + shape(bitmap("./a.tga", turned)) + shape(bitmap("copy.tga")) +
      shape(bitmap("a.tga", "<boolean name='raw' value='true'/>")) + shape(bitmap("grey.tga"));
  const SceneDescription s = good(all);
  EXPECT_THAT(s.bitmaps, SizeIs(2));
  EXPECT_THAT(s.textures, SizeIs(5));
  EXPECT_THAT(s.files, SizeIs(4)) << "the scene and three files";
  const auto built = build_device_scene(s, {});
  ASSERT_TRUE(built) << built.error().message;
  // Two bitmaps, what bytes count by sRGB and linearly, and a word at the end.
  EXPECT_EQ(built->header.tables.texels.count, 3 * 16 * 16 / 4 + 16 * 16 / 4 + 2 * 256 + 1);
  const auto nodes = table<TextureNode>(*built, built->header.tables.textures);
  EXPECT_EQ(nodes[0].texels, nodes[1].texels);
  EXPECT_EQ(nodes[0].texels, nodes[3].texels);
  EXPECT_EQ(nodes[0].decoding, nodes[4].decoding);
  EXPECT_NE(nodes[0].decoding, nodes[3].decoding);
  EXPECT_EQ(nodes[1].u_by_u, 2.0f);
}

TEST_F(MitsubaTextures, ThoseThatNothingShowsAreNotShipped) {
  write_tga("a.tga", 4, 4, 1, std::vector<std::uint8_t>(16, 7));
  write_tga("b.tga", 2, 2, 1, std::vector<std::uint8_t>(4, 9));
  const auto unused = [](const std::string& name) {
    return "<texture type='bitmap' id='" + name + "'><string name='filename' value='" + name +
           "'/></texture>";
  };
  const SceneDescription s =
      good(unused("a.tga") + unused("b.tga") +
           shape("<texture type='scale' name='reflectance'>" + std::string("<ref id='b.tga'/></texture>")));
  EXPECT_THAT(s.textures, SizeIs(3));
  const auto built = build_device_scene(s, {});
  ASSERT_TRUE(built) << built.error().message;
  EXPECT_EQ(built->header.tables.textures.count, 2);
  EXPECT_EQ(built->header.tables.texels.count, 256 + 1 + 1);
  const auto nodes = table<TextureNode>(*built, built->header.tables.textures);
  EXPECT_EQ(nodes[0].width, 2);
  EXPECT_EQ(nodes[1].texture0, 0);
  EXPECT_EQ(table<Material>(*built, built->header.tables.materials)[1].diffuse_texture, 1);
  const auto without = build_device_scene(good(unused("a.tga") + shape("")), {});
  ASSERT_TRUE(without);
  EXPECT_EQ(without->header.tables.texels.count, 0);
  EXPECT_EQ(without->header.features & (FEATURE_TEXTURES | FEATURE_UV), 0u);
}

TEST_F(MitsubaTextures, FilesAreAPartOfTheScenesHash) {
  write_tga("a.tga", 1, 1, 1, {1});
  const std::uint64_t before = good(shape(bitmap("a.tga"))).contents_hash;
  EXPECT_EQ(good(shape(bitmap("a.tga"))).contents_hash, before);
  write_tga("a.tga", 1, 1, 1, {2});
  EXPECT_NE(good(shape(bitmap("a.tga"))).contents_hash, before);
}

TEST_F(MitsubaTextures, BitmapsHaveTheParametersOfBothVersions) {
  write_tga("a.tga", 1, 1, 1, {1});
  const BitmapTexture plain = model<BitmapTexture>(good(shape(bitmap("a.tga"))));
  EXPECT_EQ(plain.filter, BitmapFilter::kBilinear);
  EXPECT_EQ(plain.wrap_u, WRAP_REPEAT);
  EXPECT_EQ(plain.gamma, kSrgb);
  const SceneDescription s =
      good(shape(bitmap("a.tga",
                        "<string name='filterType' value='nearest'/><string name='wrapMode' value='mirror'/>"
                        "<string name='wrapModeV' value='one'/><float name='gamma' value='2.2'/>"
                        "<float name='uscale' value='2'/><float name='vscale' value='3'/>"
                        "<float name='uoffset' value='.5'/><float name='voffset' value='.25'/>"
                        "<float name='maxAnisotropy' value='8'/><boolean name='cache' value='true'/>")));
  const BitmapTexture set = model<BitmapTexture>(s);
  EXPECT_EQ(set.filter, BitmapFilter::kNearest);
  EXPECT_EQ(set.wrap_u, WRAP_MIRROR);
  EXPECT_EQ(set.wrap_v, WRAP_ONE);
  EXPECT_EQ(set.gamma, 2.2f);
  EXPECT_EQ(s.textures[0].to_uv * glm::dvec3(1, 1, 1), glm::dvec3(2.5, 3.25, 1));
  EXPECT_EQ(model<BitmapTexture>(good(shape(bitmap("a.tga", "<boolean name='raw' value='true'/>")))).gamma,
            1.0f);
  EXPECT_THAT(good(shape(bitmap("a.tga", "<string name='filter_type' value='ewa'/>"))).warnings,
              ElementsAre(HasSubstr("its filter is bilinear")));
  EXPECT_THAT(error(scene(shape(bitmap("a.tga", "<string name='wrap_mode' value='tile'/>")))),
              HasSubstr("repeat, mirror, clamp, zero, one"));
  EXPECT_THAT(error(scene(shape(bitmap("a.tga", "<float name='gamma' value='0'/>")))),
              HasSubstr("above 0, or -1 for sRGB"));
  EXPECT_THAT(error(scene(shape(bitmap("a.tga",
                                       "<float name='gamma' value='2'/><boolean name='raw' "
                                       "value='true'/>")))),
              HasSubstr("give one of both"));
}

TEST_F(MitsubaTextures, ScaleHoldsATexture) {
  const std::string board = "<texture type='checkerboard'/>";
  const SceneDescription s = good(shape("<texture type='scale' name='reflectance'>" + board +
                                        "<float name='scale' value='.5'/></texture>"));
  ASSERT_THAT(s.textures, SizeIs(2));
  EXPECT_EQ(model<ScaleTexture>(s, 1).scale.value, glm::vec3(0.5f));
  EXPECT_EQ(model<ScaleTexture>(s, 1).texture, 0);
  EXPECT_THAT(error(scene(shape("<texture type='scale' name='reflectance'/>"))),
              HasSubstr("a scale texture holds the texture that it scales"));
  EXPECT_THAT(error(scene("<texture type='scale' id='a'><ref id='b'/></texture>"
                          "<texture type='scale' id='b'><ref id='a'/></texture>")),
              HasSubstr("holds itself, through its references"));
}

TEST_F(MitsubaTextures, NoiseHasItsRows) {
  const SceneDescription s = good(shape(
      "<texture type='noise' name='reflectance'><integer name='octaves' value='3'/><integer name='seed' "
      "value='9'/><float name='persistence' value='.25'/><rgb name='color1' value='1 0 0'/></texture>"));
  const auto noise = model<NoiseTexture>(s);
  EXPECT_EQ(noise.octaves, 3);
  EXPECT_EQ(noise.seed, 9);
  EXPECT_EQ(noise.persistence, 0.25f);
  EXPECT_EQ(noise.color1.value, glm::vec3(1, 0, 0));
  const auto wrong = [&](const std::string& inside) {
    return error(scene(shape("<texture type='noise' name='reflectance'>" + inside + "</texture>")));
  };
  EXPECT_THAT(wrong("<integer name='octaves' value='11'/>"), HasSubstr("octaves must be"));
  EXPECT_THAT(wrong("<integer name='octaves' value='0'/>"), HasSubstr("octaves must be"));
  EXPECT_THAT(wrong("<texture type='checkerboard' name='color0'/>"),
              HasSubstr("must be colours, not textures"));
}

TEST_F(MitsubaTextures, MeshesBringColours) {
  write("a.ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property float r\nproperty float g\nproperty float b\nelement face 2\nproperty list uchar int "
        "vertex_indices\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
        "0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 0 0 1\n2 0 0 0 0 0\n3 0 1 3 9 9 9\n3 0 1 2 255 0 51\n");
  const auto attribute = [](const std::string& name) {
    return "<texture type='mesh_attribute' name='reflectance'><string name='name' value='" + name +
           "'/></texture>";
  };
  const std::string file = "<string name='filename' value='a.ply'/>";
  const SceneDescription s = good(shape(attribute("vertex_color"), "ply", file) +
                                  shape(attribute("face_color"), "ply", file) + shape("", "sphere"));
  const Mesh& mesh = std::get<Mesh>(s.shapes.at(0).geometry);
  EXPECT_THAT(mesh.colours,
              ElementsAre(glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1), glm::vec3(0)));
  ASSERT_THAT(mesh.face_colours, SizeIs(1)) << "the first triangle has no area";
  EXPECT_EQ(mesh.face_colours[0].x, 1.0f);
  EXPECT_NEAR(mesh.face_colours[0].z, 0.0331048, 1e-6) << "whole numbers are sRGB";
  const auto built = build_device_scene(s, {});
  ASSERT_TRUE(built) << built.error().message;
  EXPECT_EQ(built->header.tables.triangle_colours.count, 2);
  ASSERT_EQ(built->header.tables.vertex_colours.count, 4);
  const auto colours = table<VertexColours>(*built, built->header.tables.vertex_colours);
  EXPECT_EQ(colours[0].c1.y, 1.0f);
  EXPECT_EQ(colours[1].c1.x, 1.0f);
  const auto restored = DeviceScene::deserialize(built->serialize());
  EXPECT_TRUE(restored) << restored.error().message;

  write("a.obj", "v 0 0 0 1 .5 .25\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n");
  const SceneDescription obj = good(shape("<texture type='vertexcolors' name='reflectance'/>", "obj",
                                          "<string name='filename' value='a.obj'/>"));
  EXPECT_EQ(std::get<Mesh>(obj.shapes.at(0).geometry).colours.at(0), glm::vec3(1, 0.5f, 0.25f));

  EXPECT_THAT(error(scene(shape(attribute("vertex_color")))),
              HasSubstr("a texture shows 'vertex_color' of the shape"));
  EXPECT_THAT(good(shape(attribute("vertex_color")), {.lenient = true}).warnings,
              ElementsAre(HasSubstr("which has none; it is black")));
  EXPECT_THAT(error(scene(shape(attribute("vertex_weight"), "ply", file))),
              HasSubstr("shows 'vertex_weight' of the shape"));
}

TEST_F(MitsubaTextures, MeshesWithoutCoordinatesAreWarnedOf) {
  write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string file = "<string name='filename' value='a.obj'/>";
  const std::string board = "<texture type='checkerboard' name='reflectance'/>";
  EXPECT_THAT(good(shape(board, "obj", file)).warnings,
              ElementsAre(AllOf(HasSubstr("scene.xml:2:"), HasSubstr("no texture coordinates"))));
  EXPECT_THAT(good(shape("", "obj", file)).warnings, IsEmpty());
  EXPECT_THAT(good(shape(board, "rectangle")).warnings, IsEmpty());
}

TEST_F(MitsubaTextures, SpheresAndDisksTurnTheirFrames) {
  const SceneDescription s = good(
      "<shape type='sphere'><transform name='to_world'><rotate z='1' angle='90'/><scale "
      "value='3'/></transform>"
      "</shape><shape type='sphere'><transform name='to_world'><scale x='-1'/></transform></shape>"
      "<shape type='disk'><transform name='to_world'><scale x='2' y='-2'/></transform></shape>");
  const auto near = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::distance(a, b) < 1e-12; };
  const Sphere& turned = std::get<Sphere>(s.shapes.at(0).geometry);
  EXPECT_TRUE(near(turned.x_axis, {0, 1, 0}) && near(turned.y_axis, {-1, 0, 0}));
  const Sphere& mirrored = std::get<Sphere>(s.shapes.at(1).geometry);
  EXPECT_TRUE(near(mirrored.x_axis, {-1, 0, 0}) && near(mirrored.y_axis, {0, 1, 0}) &&
              near(mirrored.z_axis, {0, 0, 1}));
  const Disk& disk = std::get<Disk>(s.shapes.at(2).geometry);
  EXPECT_TRUE(near(disk.x_axis, {1, 0, 0}) && near(disk.y_axis, {0, -1, 0}));
}

}  // namespace
}  // namespace penumbra
