#include "scheduler/image/tone_map.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace penumbra {
namespace {

/// The inverse as IEC 61966-2-1 states it.
double linear_from_srgb(double signal) {
  return signal <= 0.04045 ? signal / 12.92 : std::pow((signal + 0.055) / 1.055, 2.4);
}

TEST(ToneMap, InvertsTheStandardsDecodingOfEveryByte) {
  for (int byte = 0; byte <= 255; ++byte) {
    EXPECT_EQ(display_byte(float(linear_from_srgb(byte / 255.0))), byte);
  }
}

TEST(ToneMap, KnownValues) {
  EXPECT_NEAR(srgb_from_linear(0.5), 0.735356983052449, 1e-12);
  EXPECT_NEAR(srgb_from_linear(0.18), 0.461356129500442, 1e-12);
  EXPECT_DOUBLE_EQ(srgb_from_linear(0.001), 0.01292);
  EXPECT_NEAR(srgb_from_linear(1.0), 1.0, 1e-15);
  EXPECT_EQ(display_byte(0.5f), 188);
  EXPECT_EQ(display_byte(0.18f), 118);
}

TEST(ToneMap, IsTheStandardsRoundedForEveryNumber) {
  const auto check = [](std::uint32_t bits) {
    const float linear = std::bit_cast<float>(bits);
    ASSERT_EQ(display_byte(linear), std::lround(255.0 * srgb_from_linear(linear))) << linear;
  };
  const std::uint32_t one = std::bit_cast<std::uint32_t>(1.0f);
  constexpr std::uint32_t kStride = 2003, kNear = 100;
  for (std::uint32_t bits = 0; bits < one; bits += kStride) check(bits);
  // Around the numbers where a byte ends and the next begins.
  for (int byte = 0; byte < 255; ++byte) {
    const auto middle = std::bit_cast<std::uint32_t>(float(linear_from_srgb((byte + 0.5) / 255.0)));
    for (std::uint32_t bits = middle - kNear; bits <= middle + kNear; ++bits) check(bits);
  }
}

TEST(ToneMap, ClampsWhatADisplayCannotShow) {
  EXPECT_EQ(display_byte(1.0f), 255);
  EXPECT_EQ(display_byte(1e30f), 255);
  EXPECT_EQ(display_byte(std::numeric_limits<float>::infinity()), 255);
  EXPECT_EQ(display_byte(0.0f), 0);
  EXPECT_EQ(display_byte(-1.0f), 0);
  EXPECT_EQ(display_byte(-std::numeric_limits<float>::infinity()), 0);
  EXPECT_EQ(display_byte(std::numeric_limits<float>::quiet_NaN()), 0);
}

}  // namespace
}  // namespace penumbra
