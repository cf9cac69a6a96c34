// What is read without OpenImageIO is what OpenImageIO reads.
#include "scenes/image/common_formats.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "kernels/host/module.h"
#include "scenes/image/bitmap_reader.h"
#include "scenes/image/exr_file.h"
#include "scenes/image/radiance_file.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::common_formats_test {
namespace {

class CommonFormats : public ::testing::Test {
 protected:
  struct Kind {
    const char* name;
    OIIO::TypeDesc type;
    int channels;
    std::vector<std::pair<std::string, std::string>> attributes = {};
  };

  /// The contents of an image file of random values.
  std::string written(const Kind& kind, int width, int height) {
    const auto path = folder_ / kind.name;
    auto output = OIIO::ImageOutput::create(path.string());
    OIIO::ImageSpec spec(width, height, kind.channels, kind.type);
    if (kind.channels == 1) spec.channelnames = {"Y"};
    if (kind.channels == 2) spec.channelnames = {"Y", "A"};
    spec.attribute("oiio:UnassociatedAlpha", 1);
    for (const auto& [name, value] : kind.attributes) spec.attribute(name, value);
    std::vector<float> values(std::size_t(width * height * kind.channels));
    std::uint32_t state = 1;
    for (float& value : values) {
      state = state * 1664525u + 1013904223u;
      value = float(state >> 8) * 0x1p-24f;
    }
    EXPECT_TRUE(output->open(path.string(), spec)) << output->geterror();
    EXPECT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data())) << output->geterror();
    EXPECT_TRUE(output->close());
    return file_contents(path);
  }

  Expected<ImageContents> by_oiio(const std::string& name, const std::string& contents) {
    static const Expected<const void*> reader =
        load_module("libpenumbra_image_reader.so", "penumbra_texel_reader");
    return static_cast<const TexelReader*>(reader.value())
        ->read((folder_ / name).string(), contents, kMaxBitmapBytes);
  }

  /// Nothing: left to OpenImageIO, or an error.
  static std::optional<ImageContents> without_oiio(const std::string& contents, std::size_t most_bytes) {
    Expected<ImageContents> image = fail("");
    if (is_exr(contents))
      image = read_exr(contents, most_bytes);
    else if (is_radiance(contents))
      image = read_radiance(contents, most_bytes);
    else
      return read_common_image(contents, most_bytes);
    return image ? std::optional(*std::move(image)) : std::nullopt;
  }

  /// The values of one channel.
  static std::string channel(const ImageContents& image, const std::string& name) {
    const auto found = std::ranges::find(image.channels, name);
    if (found == image.channels.end()) return "none";
    const std::size_t size = size_of(image.type), texel = size * image.channels.size();
    std::string bytes;
    for (std::size_t at = size * std::size_t(found - image.channels.begin()); at < image.bytes.size();
         at += texel)
      bytes.append(reinterpret_cast<const char*>(image.bytes.data()) + at, size);
    return bytes;
  }

  TemporaryFolder folder_;
};

TEST_F(CommonFormats, AreReadAlike) {
  const OIIO::TypeDesc byte = OIIO::TypeDesc::UINT8, two = OIIO::TypeDesc::UINT16,
                       half = OIIO::TypeDesc::HALF, single = OIIO::TypeDesc::FLOAT;
  const Kind kinds[] = {
      {"a.jpg", byte, 1},
      {"b.jpg", byte, 3},
      {"c.jpg", byte, 3, {{"Compression", "jpeg:50"}, {"jpeg:subsampling", "4:2:0"}}},
      {"d.png", byte, 1},
      {"e.png", byte, 2},
      {"f.png", byte, 3},
      {"g.png", byte, 4},
      {"h.png", two, 1},
      {"i.png", two, 3},
      {"j.png", two, 4},
      {"k.exr", half, 3},
      {"l.exr", single, 3, {{"compression", "piz"}}},
      {"m.exr", half, 4, {{"compression", "none"}}},
      {"n.exr", single, 1, {{"compression", "rle"}}},
      {"o.exr", half, 3, {{"compression", "zips"}}},
      {"p.hdr", single, 3},
  };
  for (const Kind& kind : kinds)
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(37, 21), std::pair(64, 33)}) {
      SCOPED_TRACE(fmt::format("{} {} x {}", kind.name, width, height));
      const std::string contents = written(kind, width, height);
      const auto read = without_oiio(contents, kMaxBitmapBytes);
      const auto expected = by_oiio(kind.name, contents);
      ASSERT_TRUE(read);
      ASSERT_TRUE(expected) << expected.error().message;
      EXPECT_EQ(read->width, expected->width);
      EXPECT_EQ(read->height, expected->height);
      EXPECT_EQ(read->type, expected->type);
      EXPECT_THAT(read->channels, ::testing::UnorderedElementsAreArray(expected->channels));
      for (const std::string& name : expected->channels)
        EXPECT_EQ(channel(*read, name), channel(*expected, name)) << name;
      EXPECT_FALSE(without_oiio(contents, read->bytes.size() - 1)) << "more than is allowed";
    }
}

TEST_F(CommonFormats, DamagedFilesAreNotRead) {
  for (const char* name : {"a.jpg", "b.png", "c.exr", "d.hdr"}) {
    const std::string contents = written({name, OIIO::TypeDesc::UINT8, 3}, 40, 40);
    for (const std::size_t kept : {std::size_t(3), std::size_t(20), contents.size() / 2})
      EXPECT_FALSE(without_oiio(contents.substr(0, kept), kMaxBitmapBytes)) << name << " " << kept;
    std::string damaged = contents;
    for (std::size_t i = 0; i < damaged.size(); i += 7) damaged[i] = char(damaged[i] ^ 0x55);
    EXPECT_FALSE(without_oiio(damaged, kMaxBitmapBytes)) << name;
  }
}

}  // namespace
}  // namespace penumbra::common_formats_test
