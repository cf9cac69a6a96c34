// Expected colours are Mitsuba 3.9's (scalar_rgb), which integrates the same tables by the midpoint rule in
// steps of 1 nm. Both it and Penumbra differ from the exact integral by less than the tolerance.
#include "scenes/spectrum.h"

#include <gtest/gtest.h>

#include <vector>

namespace penumbra {
namespace {

void expect_near(glm::vec3 a, glm::vec3 b, float relative) {
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(a[i], b[i], relative * std::max(b.x, std::max(b.y, b.z))) << "channel " << i;
}

using Table = std::vector<SpectrumSample>;

TEST(Spectrum, AConstantReflectanceIsGrey) {
  const glm::vec3 rgb = reflectance_to_rgb(Table{{300, 0.25}, {900, 0.25}});
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(rgb[i], 0.25f, 1e-6f);
  EXPECT_EQ(reflectance_to_rgb(Table{{360, 1}, {830, 1}}), glm::vec3(1.0f));
}

TEST(Spectrum, AConstantEmissionIsEqualEnergyWhite) {
  expect_near(emission_to_rgb(0.5), {0.602397f, 0.474146f, 0.454458f}, 3e-4f);
  const glm::vec3 table = emission_to_rgb(Table{{300, 0.5}, {900, 0.5}});
  expect_near(table, emission_to_rgb(0.5), 1e-6f);
  // By definition its luminance is the constant.
  EXPECT_NEAR(0.2126729f * table.x + 0.7151522f * table.y + 0.0721750f * table.z, 0.5f, 1e-5f);
}

TEST(Spectrum, TabulatedReflectance) {
  expect_near(reflectance_to_rgb(Table{{400, 0.5}, {700, 0.5}}), {0.497671f, 0.499878f, 0.497455f}, 3e-3f);
  expect_near(reflectance_to_rgb(Table{{400, 0}, {500, 0.3}, {600, 0.6}, {700, 0.8}}),
              {0.702762f, 0.430392f, 0.122665f}, 3e-3f);
}

TEST(Spectrum, TabulatedEmission) {
  expect_near(emission_to_rgb(Table{{400, 0}, {500, 8}, {600, 15.6}, {700, 18.4}}),
              {20.7108f, 10.8546f, 2.77115f}, 3e-3f);
}

TEST(Spectrum, IsLinear) {
  const glm::vec3 once = emission_to_rgb(Table{{400, 1}, {500, 3}, {640, 2}});
  expect_near(emission_to_rgb(Table{{400, 10}, {500, 30}, {640, 20}}), 10.0f * once, 1e-6f);
  // A point more on the line changes nothing.
  expect_near(emission_to_rgb(Table{{400, 1}, {450, 2}, {500, 3}, {640, 2}}), once, 1e-6f);
}

TEST(Spectrum, NothingOutsideTheTableOrTheVisible) {
  EXPECT_EQ(emission_to_rgb(Table{{900, 5}, {1000, 5}}), glm::vec3(0.0f));
  EXPECT_EQ(reflectance_to_rgb(Table{{100, 1}, {200, 1}}), glm::vec3(0.0f));
}

TEST(Spectrum, ColoursAreClampedToTheGamut) {
  const glm::vec3 cyan = reflectance_to_rgb(Table{{480, 1}, {510, 1}});
  EXPECT_EQ(cyan.x, 0.0f);
  EXPECT_GT(cyan.y, 0.0f);
  EXPECT_LE(cyan.z, 1.0f);
}

/// CIE 1931 x and y of a colour in Rec. 709 (IEC 61966-2-1).
glm::dvec2 chromaticity(const glm::dvec3& c) {
  const glm::dvec3 xyz(0.4124564 * c.x + 0.3575761 * c.y + 0.1804375 * c.z,
                       0.2126729 * c.x + 0.7151522 * c.y + 0.0721750 * c.z,
                       0.0193339 * c.x + 0.1191920 * c.y + 0.9503041 * c.z);
  return {xyz.x / (xyz.x + xyz.y + xyz.z), xyz.y / (xyz.x + xyz.y + xyz.z)};
}

TEST(BlackBody, IlluminantA) {
  // Of 2848 K when c2 was 1.435e-2 m K: 2855.54 K today (CIE 015:2018, 4.1).
  const glm::dvec2 xy = chromaticity(blackbody_to_rgb(2855.54));
  EXPECT_NEAR(xy.x, 0.44758, 2e-4);
  EXPECT_NEAR(xy.y, 0.40745, 2e-4);
}

TEST(BlackBody, FreezingPlatinumIsTheCandelaOf1948) {
  // 60 cd/cm² at 2041.4 K (ITS-90), which 683 lm/W were chosen by, to some tenths of a percent.
  const glm::dvec3 c(blackbody_to_rgb(2041.4));
  const double luminance = 0.2126729 * c.x + 0.7151522 * c.y + 0.0721750 * c.z;
  constexpr double kNanometres = 106.857;  // the integral of y(lambda), by which unit power has luminance 1
  EXPECT_NEAR(683 * kNanometres * luminance, 6e5, 0.01 * 6e5);
}

TEST(Srgb, TransferFunction) {
  EXPECT_EQ(srgb_to_linear(0.0), 0.0);
  EXPECT_NEAR(srgb_to_linear(1.0), 1.0, 1e-15);
  EXPECT_NEAR(srgb_to_linear(0.5), 0.21404114, 1e-8);
  EXPECT_NEAR(srgb_to_linear(0.04), 0.04 / 12.92, 1e-15);
}

}  // namespace
}  // namespace penumbra
