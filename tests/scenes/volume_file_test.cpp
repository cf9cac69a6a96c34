// Mitsuba's volume files: their format, and errors in invalid ones.
#include "scenes/volume_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "tests/support/oracles.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;

VolumeGrid counted(int nx, int ny, int nz, int channels) {
  VolumeGrid grid{nx, ny, nz, channels, std::vector<float>(std::size_t(nx * ny * nz * channels))};
  std::iota(grid.values.begin(), grid.values.end(), 1.0f);
  return grid;
}

std::string wrong_volume(const std::string& bytes) {
  const auto read = read_volume_file("smoke.vol", bytes);
  EXPECT_FALSE(read);
  if (read) return "";
  EXPECT_THAT(read.error().message, ::testing::StartsWith("smoke.vol: "));
  return read.error().message;
}

/// With other bytes at a place.
template <typename T>
std::string with_number(std::string bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
  return bytes;
}

TEST(VolumeFiles, AreWhatTheyWere) {
  for (const int channels : {1, 3}) {
    VolumeGrid grid = counted(2, 3, 4, channels);
    grid.values[5] = -0.25f;
    const auto read = read_volume_file("smoke.vol", vol_of(grid, {-1, -2, -3}, {1, 2.5, 3}));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->grid.nx, 2);
    EXPECT_EQ(read->grid.ny, 3);
    EXPECT_EQ(read->grid.nz, 4);
    EXPECT_EQ(read->grid.channels, channels);
    EXPECT_EQ(read->grid.values, grid.values);
    EXPECT_EQ(read->low, glm::dvec3(-1, -2, -3));
    EXPECT_EQ(read->high, glm::dvec3(1, 2.5, 3));
  }
}

/// As Mitsuba 3.9.1's VolumeGrid.write writes the grid.
TEST(VolumeFiles, HaveMitsubasBytes) {
  const unsigned char start[] = {0x56, 0x4f, 0x4c, 0x03, 1,    0, 0,    0,    2,    0, 0,    0,    3,
                                 0,    0,    0,    4,    0,    0, 0,    1,    0,    0, 0,    0,    0,
                                 0,    0,    0,    0,    0,    0, 0,    0,    0,    0, 0,    0,    0x80,
                                 0x3f, 0,    0,    0x80, 0x3f, 0, 0,    0x80, 0x3f, 0, 0,    0x80, 0x3f,
                                 0,    0,    0,    0x40, 0,    0, 0x40, 0x40, 0,    0, 0x80, 0x40};
  const std::string bytes = vol_of(counted(2, 3, 4, 1));
  ASSERT_EQ(bytes.size(), 48u + 24u * 4u);
  EXPECT_EQ(std::memcmp(bytes.data(), start, sizeof start), 0);
}

TEST(VolumeFiles, ErrorsSayWhatIsWrong) {
  const std::string good = vol_of(counted(2, 3, 4, 1));
  EXPECT_THAT(wrong_volume(""), HasSubstr("it is no volume file"));
  EXPECT_THAT(wrong_volume(good.substr(0, 47)), HasSubstr("it is no volume file"));
  EXPECT_THAT(wrong_volume("VDB" + good.substr(3)), HasSubstr("it is no volume file"));
  EXPECT_THAT(wrong_volume(with_number(good, 3, char(2))), HasSubstr("version 3"));
  EXPECT_THAT(wrong_volume(with_number(good, 4, 2)),
              HasSubstr("encoding 2 (half precision); 1, single precision, is read"));
  EXPECT_THAT(wrong_volume(with_number(good, 4, 0)), HasSubstr("encoding 0; 1"));
  EXPECT_THAT(wrong_volume(with_number(good, 20, 2)), HasSubstr("it has 2 channels; 1 and 3 are read"));
  EXPECT_THAT(wrong_volume(with_number(good, 20, -1)), HasSubstr("-1 channels"));
  EXPECT_THAT(wrong_volume(with_number(good, 12, 0)), HasSubstr("0 points along an axis"));
  EXPECT_THAT(wrong_volume(with_number(good, 16, -5)), HasSubstr("-5 points along an axis"));
  EXPECT_THAT(wrong_volume(good.substr(0, 100)),
              HasSubstr("24 numbers take 96 bytes after 48 of others; there are 52"));
  EXPECT_THAT(wrong_volume(good + "x"), HasSubstr("there are 97"));
  EXPECT_THAT(wrong_volume(with_number(good, 20, 3)), HasSubstr("72 numbers take 288 bytes"));
  // Nothing of that size is asked for.
  EXPECT_THAT(wrong_volume(with_number(good, 8, 1 << 30)), HasSubstr("there are 96"));
  constexpr std::int32_t kHuge = std::numeric_limits<std::int32_t>::max();
  EXPECT_THAT(wrong_volume(with_number(with_number(with_number(good, 8, kHuge), 12, kHuge), 16, kHuge)),
              HasSubstr("2147483647 x 2147483647 x 2147483647 is too large"));
  EXPECT_THAT(wrong_volume(with_number(with_number(good, 48 + 4 * 15, NAN), 48 + 4 * 21, NAN)),
              HasSubstr("the number at x 1, y 1, z 2 is nan, not finite"));
  EXPECT_THAT(wrong_volume(with_number(vol_of(counted(2, 3, 4, 3)), 48 + 4 * 46,
                                       std::numeric_limits<float>::infinity())),
              HasSubstr("the number at x 1, y 1, z 2, channel 1 is inf"));
}

/// Against what Mitsuba 3.9.1 says of the same files.
TEST(VolumeFiles, OfMitsubasTests) {
  const std::string folder = "mitsuba/tests/scenes/participating_media/textures/";
  struct Known {
    const char* name;
    int channels;
    double sum;
    std::vector<float> at_15_7_3;
  };
  for (const Known& known : {Known{"sigmat.vol", 1, 2495.105580508709, {0.12370198f}},
                             Known{"albedo.vol", 3, 4940.006757993251, {0.50958544f, 0, 0}}}) {
    PENUMBRA_NEED_ORACLE(folder + known.name);
    const auto path = *find_oracle(folder + known.name);
    const auto read = read_volume_file(path.string(), file_contents(path));
    ASSERT_TRUE(read) << read.error().message;
    const VolumeGrid& grid = read->grid;
    EXPECT_EQ(grid.nx, 16);
    EXPECT_EQ(grid.ny, 16);
    EXPECT_EQ(grid.nz, 16);
    EXPECT_EQ(grid.channels, known.channels);
    EXPECT_EQ(read->low, glm::dvec3(0));
    EXPECT_EQ(read->high, glm::dvec3(1));
    EXPECT_NEAR(std::accumulate(grid.values.begin(), grid.values.end(), 0.0), known.sum, 1e-9);
    for (int c = 0; c < known.channels; ++c)
      EXPECT_EQ(grid.values[std::size_t(((3 * 16 + 7) * 16 + 15) * known.channels + c)],
                known.at_15_7_3[std::size_t(c)]);
  }
}

}  // namespace
}  // namespace penumbra
