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

Color grey(double x) { return {x, x, x}; }

constexpr ToneOperator kAll[] = {ToneOperator::kClamp, ToneOperator::kReinhard, ToneOperator::kFilmic,
                                 ToneOperator::kAces};

TEST(ToneOperator, ClampOnlyClamps) {
  EXPECT_EQ(tone_mapped(ToneOperator::kClamp, {0.25, 0.5, 7}), (Color{0.25, 0.5, 1}));
}

TEST(ToneOperator, ReinhardScalesByLuminanceAndKeepsHues) {
  EXPECT_DOUBLE_EQ(tone_mapped(ToneOperator::kReinhard, grey(3))[1], 0.75);
  const Color mapped = tone_mapped(ToneOperator::kReinhard, {0.1, 0.8, 0.4});
  EXPECT_DOUBLE_EQ(mapped[1] / mapped[0], 8);
  EXPECT_DOUBLE_EQ(mapped[2] / mapped[0], 4);
  EXPECT_DOUBLE_EQ(mapped[1], 0.8 / (1 + 0.2126 * 0.1 + 0.7152 * 0.8 + 0.0722 * 0.4));
}

/// Hable's own listing, ((x (A x + C B) + D E) / (x (A x + B) + D F)) - E / F, by hand for x = 1 and W
/// = 11.2.
TEST(ToneOperator, FilmicIsHablesCurveWithWhiteAt5Point6) {
  // h(2) = (2 (0.30 + 0.05) + 0.004) / (2 (0.30 + 0.50) + 0.06) - 1/15 = 0.704 / 1.66 - 1/15
  // h(11.2) = (11.2 (1.68 + 0.05) + 0.004) / (11.2 (1.68 + 0.50) + 0.06) - 1/15 = 19.38 / 24.476 - 1/15
  const double expected = (0.704 / 1.66 - 1.0 / 15) / (19.38 / 24.476 - 1.0 / 15);
  EXPECT_NEAR(tone_mapped(ToneOperator::kFilmic, grey(1))[0], expected, 1e-14);
  EXPECT_NEAR(tone_mapped(ToneOperator::kFilmic, grey(5.6))[0], 1, 1e-14);
  EXPECT_LT(tone_mapped(ToneOperator::kFilmic, grey(5.5))[0], 0.999);
}

TEST(ToneOperator, AcesIsNarkowiczsFit) {
  EXPECT_NEAR(tone_mapped(ToneOperator::kAces, grey(1))[0], 2.54 / 3.16, 1e-14);
  EXPECT_NEAR(tone_mapped(ToneOperator::kAces, grey(0.1))[0], 0.1 * 0.281 / (0.1 * 0.833 + 0.14), 1e-14);
}

TEST(ToneOperator, EachKeepsBlackNeverDecreasesAndStaysInTheDisplaysRange) {
  for (const ToneOperator tone : kAll) {
    EXPECT_NEAR(tone_mapped(tone, grey(0))[0], 0, 1e-15);
    double before = 0;
    for (double x = 1e-6; x < 1e38; x *= 1.25) {
      const double now = tone_mapped(tone, grey(x))[2];
      EXPECT_GE(now, before - 1e-15) << kToneOperatorNames[std::size_t(tone)] << " at " << x;
      EXPECT_LE(now, 1);
      before = now;
    }
    EXPECT_GT(before, 0.99);
  }
}

TEST(ToneOperator, TakesWhatIsNoRadiance) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const ToneOperator tone : kAll) {
    EXPECT_NEAR(tone_mapped(tone, grey(-1))[0], 0, 1e-15);
    EXPECT_NEAR(tone_mapped(tone, grey(std::numeric_limits<double>::quiet_NaN()))[0], 0, 1e-15);
    EXPECT_GT(tone_mapped(tone, grey(kInfinite))[0], 0.99);
  }
}

}  // namespace
}  // namespace penumbra
