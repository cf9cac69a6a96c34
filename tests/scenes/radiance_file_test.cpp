// Radiance's pictures: how scanlines lie, their codes, and what is refused.
#include "scenes/image/radiance_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

namespace penumbra::radiance_file_test {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kAny = std::size_t{1} << 30;
const std::string kFormat = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";

/// A texel whose red is the letter's number, 128 and more so that it is no code.
std::string texel(char letter) { return {char(128 + letter - 'a'), 0, 0, char(128 + 8)}; }
std::string texels(const std::string& letters) {
  std::string bytes;
  for (const char letter : letters) bytes += texel(letter);
  return bytes;
}
/// The letters of a picture, rows from the top, each with a line end.
std::string letters(const ImageContents& image) {
  std::string text;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      float red;
      std::memcpy(&red, image.bytes.data() + std::size_t(y * image.width + x) * 12, sizeof red);
      text += char('a' + int(red) - 128);
    }
    text += '\n';
  }
  return text;
}
std::string read(const std::string& file) {
  const auto image = read_radiance(file, kAny);
  return image ? letters(*image) : image.error().message;
}

// Radiance's filefmts.pdf: "-Y N +X M" has rows from the top and texels from the left; the first axis is that
// along which scanlines follow each other.
TEST(RadianceFiles, AreUprightWhateverTheirScanlines) {
  const std::pair<const char*, const char*> files[] = {
      {"-Y 2 +X 3", "abcdef"}, {"-Y 2 -X 3", "cbafed"}, {"+Y 2 +X 3", "defabc"}, {"+Y 2 -X 3", "fedcba"},
      {"+X 3 -Y 2", "adbecf"}, {"-X 3 -Y 2", "cfbead"}, {"+X 3 +Y 2", "daebfc"}, {"-X 3 +Y 2", "fcebda"}};
  for (const auto& [resolution, order] : files)
    EXPECT_EQ(read(kFormat + resolution + "\n" + texels(order)), "abc\ndef\n") << resolution;
}

TEST(RadianceFiles, ValuesAreMantissaTimesAPowerOfTwo) {
  const auto image =
      read_radiance(kFormat + "-Y 1 +X 2\n" + std::string("\xff\x80\x01\x80\x40\x20\x10\0", 8), kAny);
  ASSERT_TRUE(image);
  std::vector<float> values(6);
  std::memcpy(values.data(), image->bytes.data(), image->bytes.size());
  EXPECT_EQ(values, (std::vector<float>{255 / 256.0f, 0.5f, 1 / 256.0f, 0, 0, 0})) << "exponent 0 is black";
}

TEST(RadianceFiles, BothRunLengthCodesAreRead) {
  // The older: 1, 1, 1, n repeats a texel; a second one in a row counts 256 times as much.
  const std::string run = std::string("\1\1\1", 3);
  EXPECT_EQ(read(kFormat + "-Y 1 +X 7\n" + texel('a') + run + '\4' + texels("bc")), "aaaaabc\n");
  const std::string two =
      read(kFormat + "-Y 1 +X 300\n" + texel('a') + run + '\x2a' + run + '\1' + texel('b'));
  EXPECT_EQ(two, std::string(299, 'a') + "b\n");
  // The newer, of each component: a run, n + 128 and the byte, or n and so many bytes.
  const std::string header("\2\2\0\x0a", 4), zeros("\x8a\0", 2), exponent("\x8a\x88", 2);
  const std::string red = std::string("\x88") + char(128) + std::string("\2") + char(129) + char(130);
  EXPECT_EQ(read(kFormat + "-Y 1 +X 10\n" + header + red + zeros + zeros + exponent), "aaaaaaaabc\n");
}

TEST(RadianceFiles, WhatIsWrongWithThemIsSaid) {
  const std::string line = "-Y 1 +X 2\n";
  const std::pair<std::string, const char*> files[] = {
      {"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n" + line + texels("ab"), "its FORMAT is '32-bit_rle_xyze'"},
      {"#?RADIANCE\n\n" + line + texels("ab"), "its FORMAT is ''"},
      {kFormat + "-Y 1 +Y 2\n" + texels("ab"), "its resolution line is '-Y 1 +Y 2'"},
      {kFormat + "-Y 0 +X 2\n", "its resolution line"},
      {kFormat + "-Y 1 +X -2\n", "its resolution line"},
      {kFormat + "-Y 1 +X 99999999999\n", "its resolution line"},
      {kFormat + "-Y 1\n", "its resolution line"},
      {kFormat + "-Y 100000 +X 100000\n", "has 100000 x 100000 texels"},
      {kFormat + "-Y 1 +X 2\n" + std::string("\1\1\1\1", 4) + texel('a'), "scanline 1 of 1"},
      {kFormat + "-Y 1 +X 9\n" + std::string("\2\2\0\x0a\x8a\1\x8a\1\x8a\1\x8a\1", 12), "scanline 1 of 1"},
      {kFormat + "-Y 1 +X 8\n" + std::string("\2\2\0\x08\x89\1", 6), "scanline 1 of 1"},
      {kFormat + "-Y 1 +X 8\n" + std::string("\2\2\0\x08\0\1", 6), "scanline 1 of 1"}};
  for (const auto& [file, why] : files) EXPECT_THAT(read(file), HasSubstr(why));
  const std::string whole = kFormat + "-Y 2 +X 3\n" + texels("abcdef");
  for (std::size_t size = 2; size < whole.size(); ++size)
    ASSERT_FALSE(read_radiance(whole.substr(0, size), kAny)) << size;
}

}  // namespace
}  // namespace penumbra::radiance_file_test
