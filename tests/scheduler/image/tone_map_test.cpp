#include "scheduler/image/tone_map.h"

#include <gtest/gtest.h>

#include <cmath>
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
