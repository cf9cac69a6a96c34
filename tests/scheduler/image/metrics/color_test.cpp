// Tests colour spaces, and the colour map of heat maps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scheduler/image/metrics/color_map.h"
#include "scheduler/image/metrics/color_space.h"
#include "scheduler/image/tone_map.h"

namespace penumbra {
namespace {

// Published to four decimals: IEC 61966-2-1 and Lindbloom's table for D65.
TEST(ColorSpace, LuminanceAndPrimaries) {
  EXPECT_NEAR(luminance({1, 0, 0}), 0.2126, 5e-5);
  EXPECT_NEAR(luminance({0, 1, 0}), 0.7152, 5e-5);
  EXPECT_NEAR(luminance({0, 0, 1}), 0.0722, 5e-5);
  const Color white = relative_xyz_from_rgb({1, 1, 1});
  for (const double value : white) EXPECT_NEAR(value, 1, 1e-14);
  const Color red = lab_from_relative_xyz(relative_xyz_from_rgb({1, 0, 0}));
  EXPECT_NEAR(red[0], 53.24, 0.02);
  EXPECT_NEAR(red[1], 80.09, 0.05);
  EXPECT_NEAR(red[2], 67.20, 0.05);
}

TEST(ColorSpace, InversesInvert) {
  for (int i = 0; i <= 20; ++i) {
    const Color rgb = {i / 20.0, 1 - i / 20.0, i * i / 400.0};
    const Color xyz = relative_xyz_from_rgb(rgb);
    const Color lab_back = relative_xyz_from_lab(lab_from_relative_xyz(xyz));
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(rgb_from_relative_xyz(xyz)[c], rgb[c], 1e-13);
      EXPECT_NEAR(lab_back[c], xyz[c], 1e-13);
    }
    EXPECT_NEAR(linear_from_srgb(srgb_from_linear(i / 20.0)), i / 20.0, 1e-7);
  }
}

TEST(ColorMap, StaysInGamutAndGrowsEvenlyInLightness) {
  double last = 0;
  for (int i = 0; i <= 1000; ++i) {
    const auto color = heat_color(i / 1000.0);
    for (const float value : color) {
      EXPECT_GE(value, 0) << i;
      EXPECT_LE(value, 1) << i;
    }
    const Color lab = lab_from_relative_xyz(relative_xyz_from_rgb({color[0], color[1], color[2]}));
    EXPECT_NEAR(lab[0], 12 + 0.08 * i, 1e-3);
    EXPECT_GT(lab[0], last);
    last = lab[0];
  }
}

TEST(ColorMap, ClampsAndIsDarkPurpleThenYellow) {
  EXPECT_EQ(heat_color(-3), heat_color(0));
  EXPECT_EQ(heat_color(INFINITY), heat_color(1));
  EXPECT_EQ(heat_color(NAN), heat_color(0));
  const auto low = heat_color(0), high = heat_color(1);
  EXPECT_GT(low[2], low[1]);
  EXPECT_GT(high[0], 0.7f);
  EXPECT_GT(high[1], 0.7f);
  EXPECT_LT(high[2], 0.2f);
}

}  // namespace
}  // namespace penumbra
