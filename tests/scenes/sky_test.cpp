// Skies and suns: the sun's position, the model's own formulas, the light from the images, and a sky that
// Mitsuba 3 computed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <functional>
#include <glm/gtc/packing.hpp>
#include <numbers>

#include "scenes/scene_reader.h"
#include "scenes/sky/preetham_sky.h"
#include "scenes/sky/sky_image.h"
#include "scenes/sky/sky_parameters.h"
#include "tests/support/oracles.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using glm::dvec3;
using ::testing::HasSubstr;

constexpr double kPi = std::numbers::pi, kDegree = kPi / 180;

double luminance(const dvec3& c) { return 0.212639 * c.x + 0.715169 * c.y + 0.072192 * c.z; }

dvec3 direction(double elevation, double azimuth) {
  return {std::cos(elevation * kDegree) * std::sin(azimuth * kDegree), std::sin(elevation * kDegree),
          -std::cos(elevation * kDegree) * std::cos(azimuth * kDegree)};
}

TEST(SunPosition, IsWhereMitsubaHasIt) {
  // Its sunsky (3.9) without parameters, z up, x to the south and y to the west: Tokyo, 10 July 2010, 15:00.
  const dvec3 sun = sun_direction({});
  EXPECT_NEAR(sun.x, -0.691748, 2e-5);
  EXPECT_NEAR(sun.y, 0.720308, 2e-5);
  EXPECT_NEAR(sun.z, 0.0513851, 2e-5);
}

TEST(SunPosition, IsInTheZenithWhereItShouldBe) {
  // Astronomical facts: equinox of 20 March 2015, 22:45 UT, when it is over the equator; solstice of 21 June
  // 2014, 10:51 UT, over latitude 23.44. Noon there, with the equation of time of those days, -7.4 and -1.8
  // minutes.
  const double equinox = -15 * (22.75 - 12 - 7.4 / 60), solstice = -15 * (10.85 - 12 - 1.8 / 60);
  EXPECT_GT(sun_direction({0, equinox, 0, 2015, 3, 20, 22, 45, 0}).y, std::cos(0.2 * kDegree));
  EXPECT_GT(sun_direction({23.44, solstice, 0, 2014, 6, 21, 10, 51, 0}).y, std::cos(0.2 * kDegree));
  // In the morning it is in the east, and at noon of the northern hemisphere in the south.
  EXPECT_GT(sun_direction({50, 0, 0, 2014, 6, 21, 8, 0, 0}).x, 0.5);
  EXPECT_GT(sun_direction({50, 0, 0, 2014, 12, 21, 12, 0, 0}).z, 0.9);
}

TEST(PreethamSky, HasTheZenithsLuminance) {
  for (const double turbidity : {2.0, 3.0, 6.0})
    for (const double elevation : {5.0, 30.0, 70.0}) {
      const PreethamSky sky(direction(elevation, 40), turbidity);
      const double angle = (90 - elevation) * kDegree;
      const double candelas =
          1000 * ((4.0453 * turbidity - 4.9710) * std::tan((4.0 / 9 - turbidity / 120) * (kPi - 2 * angle)) -
                  0.2155 * turbidity + 2.4192);
      EXPECT_NEAR(luminance(sky.radiance({0, 1, 0})) * 683 * 106.857 / candelas, 1, 1e-3);
    }
}

TEST(PreethamSky, IsTheSameOnBothSidesOfTheSun) {
  const PreethamSky sky(direction(35, 0), 3);
  for (const double elevation : {1.0, 20.0, 60.0})
    for (const double azimuth : {10.0, 90.0, 150.0}) {
      const dvec3 a = sky.radiance(direction(elevation, azimuth)),
                  b = sky.radiance(direction(elevation, -azimuth));
      EXPECT_NEAR(glm::length(a - b), 0, 1e-9);
      if (elevation > 30) EXPECT_GT(a.z, 1.5 * a.x) << "blue";
    }
  EXPECT_GT(luminance(sky.radiance(direction(35, 5))), luminance(sky.radiance(direction(35, 90))));
}

TEST(SunRadiance, FallsAndReddensTowardsTheHorizon) {
  const dvec3 high = sun_radiance(1, 3), low = sun_radiance(std::sin(5 * kDegree), 3);
  EXPECT_GT(high.y, 3 * low.y);
  EXPECT_GT(low.x / low.z, 4 * high.x / high.z);
  // Mitsuba 3.9's sun, by another model, at 45 degrees: (21369, 17552, 12928).
  EXPECT_NEAR(luminance(sun_radiance(std::sqrt(0.5), 3)) / 18029, 1, 0.15);
  EXPECT_EQ(sun_radiance(0, 3), dvec3(0));
}

double texel(const Bitmap& image, int x, int y, int c) {
  return double(std::bit_cast<float>(image.words[std::size_t(3 * (y * image.width + x) + c)]));
}

/// Radiance times solid angle and `weight`, of bilinear texels, by quadrature in each cell.
double integral(const Bitmap& image, int c, const std::function<double(const dvec3&)>& weight) {
  double sum = 0;
  const int w = image.width, h = image.height;
  for (int y = 0; y + 1 < h; ++y) {
    const int nodes = y < 4 ? 32 : 4;  // the solid angle of cells about the pole is no line
    for (int x = 0; x < w; ++x)
      for (int i = 0; i < nodes; ++i)
        for (int k = 0; k < nodes; ++k) {
          const double s = (i + 0.5) / nodes, t = (k + 0.5) / nodes;
          const int next = (x + 1) % w;
          const double value = (1 - t) * ((1 - s) * texel(image, x, y, c) + s * texel(image, next, y, c)) +
                               t * ((1 - s) * texel(image, x, y + 1, c) + s * texel(image, next, y + 1, c));
          if (value == 0) continue;
          const double phi = 2 * kPi * (x + s + 0.5) / w, theta = kPi * (y + t) / (h - 1);
          const dvec3 d(std::sin(phi) * std::sin(theta), std::cos(theta), -std::cos(phi) * std::sin(theta));
          sum += value * weight(d) * std::sin(theta) / (nodes * nodes);
        }
  }
  return sum * (2 * kPi / w) * (kPi / (h - 1));
}

TEST(SkyImage, SunsBringTheirIrradianceAtAnyResolution) {
  for (const int width : {64, 512, 2048})
    for (const double size : {0.01, 1.0, 10.0})
      for (const double elevation : {8.0, 45.0, 89.5}) {
        SkyImage sky;
        sky.width = width;
        sky.to_sun = direction(elevation, 133);
        sky.sky_scale = 0;
        sky.sun_scale = 3;
        sky.sun_radius = size * kSunRadius;
        const Bitmap image = draw_sky(sky);
        const double solid_angle = 2 * kPi * (1 - std::cos(kSunRadius * kDegree));
        const double expected = 3 * solid_angle * sun_radiance(sky.to_sun.y, sky.turbidity).y;
        // Of quadrature, in texels of a 64th of a turn near the pole.
        EXPECT_NEAR(integral(image, 1, [](const dvec3&) { return 1.0; }) / expected, 1, 5e-3)
            << width << " " << size << " " << elevation;
        const double along = integral(image, 1, [&](const dvec3& d) { return glm::dot(d, sky.to_sun); });
        EXPECT_NEAR(along / expected, 1, width == 64 ? 2e-2 : 5e-3);
      }
}

TEST(SkyImage, StretchedSkiesReachBelowTheHorizon) {
  SkyImage sky;
  sky.width = 64;
  sky.to_sun = direction(50, 10);
  const Bitmap plain = draw_sky(sky);
  sky.stretch = 2;
  const Bitmap stretched = draw_sky(sky);
  for (int x = 0; x < 64; ++x) {
    EXPECT_EQ(texel(plain, x, 20, 1), 0) << "below the horizon";
    EXPECT_GT(texel(plain, x, 16, 1), 0) << "at it";
    EXPECT_GT(texel(stretched, x, 31, 1), 0);
  }
}

double float_texel(const Bitmap& image, int x, int y, int c) {
  if (image.type == TexelType::kFloat) return texel(image, x, y, c);
  const auto k = std::size_t(3 * (y * image.width + x) + c);
  return double(glm::unpackHalf1x16(glm::uint16(image.words[k / 2] >> k % 2 * 16 & 0xffffu)));
}

/// The sky over classroom was baked by Mitsuba 3: as its texels tell, of turbidity 3 over ground of albedo
/// 0.3, times 6, and the sun where it is brightest.
TEST(SkyImage, IsNearTheBakedSkyOfClassroom) {
  PENUMBRA_NEED_ORACLE("bitterli/classroom/textures/sunsky.exr");
  const auto scene = read_scene(*find_oracle("bitterli/classroom/scene.xml"), {});
  ASSERT_TRUE(scene) << scene.error().message;
  const Bitmap& baked = *std::get<EnvironmentMapLight>(scene->emitters.at(0)).image;
  ASSERT_TRUE(baked.channels == 3 && (baked.type == TexelType::kFloat || baked.type == TexelType::kHalf));
  SkyImage sky;
  sky.to_sun = glm::normalize(dvec3(-0.86537842, 0.41789003, -0.27656486));
  sky.turbidity = 3;
  sky.albedo = dvec3(0.3);
  sky.sky_scale = 6;
  sky.width = 256;
  const Bitmap image = draw_sky(sky);
  const auto lambert = [](const dvec3& d) { return std::max(d.y, 0.0); };
  const int w = baked.width, h = baked.height;
  for (int c = 0; c < 3; ++c) {
    double there = 0;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const double phi = 2 * kPi * (x + 0.5) / w, theta = kPi * y / (h - 1);
        const dvec3 d(std::sin(phi) * std::sin(theta), std::cos(theta), -std::cos(phi) * std::sin(theta));
        if (glm::dot(d, sky.to_sun) > std::cos(7 * kDegree)) continue;  // the sun, 5 degrees in radius there
        there += float_texel(baked, x, y, c) * lambert(d) * std::sin(theta);
      }
    there *= 2 * kPi / w * kPi / (h - 1);
    const double here = integral(image, c, [&](const dvec3& d) {
      return glm::dot(d, sky.to_sun) > std::cos(7 * kDegree) ? 0.0 : lambert(d);
    });
    // The level is for the whole sky; that about the sun is not compared, where the models differ most.
    EXPECT_NEAR(here / there, 1, 0.08) << "channel " << c;
    RecordProperty("ratio_" + std::to_string(c), std::to_string(here / there));
  }
}

class SkyReader : public testing::Test {
 protected:
  Expected<SceneDescription> read(const std::string& emitter, const char* version = "0.6.0") {
    const auto file = folder_.path() / "sky.xml";
    std::ofstream(file) << "<scene version='" << version << "'><sensor type='perspective'/>" << emitter
                        << "</scene>";
    return read_scene(file, {});
  }
  std::string error(const std::string& emitter) {
    const auto scene = read(emitter);
    return scene ? "" : scene.error().message;
  }
  TemporaryFolder folder_;
};

TEST_F(SkyReader, SkiesAreEnvironmentMaps) {
  for (const std::string type : {"sky", "sun", "sunsky"}) {
    const auto scene =
        read("<emitter type='" + type +
             "'><vector name='sunDirection' x='0' y='1' z='1'/><float name='turbidity' value='4'/>"
             "<integer name='resolution' value='64'/></emitter>");
    ASSERT_TRUE(scene) << scene.error().message;
    ASSERT_EQ(scene->emitters.size(), 1u);
    const auto& map = std::get<EnvironmentMapLight>(scene->emitters[0]);
    EXPECT_EQ(map.image->width, 64);
    EXPECT_EQ(map.to_world, glm::dmat4(1.0));
    // South is in the middle of the image's width; the sun is half-way up.
    EXPECT_EQ(texel(*map.image, 5, 8, 1) > 0, type != "sun");
    const double at_sun = texel(*map.image, 31, 8, 1);
    if (type != "sky") EXPECT_GT(at_sun, 10);
  }
}

TEST_F(SkyReader, FilesOfVersion3HaveZUp) {
  const auto scene =
      read("<emitter type='sunsky'><vector name='sun_direction' x='1' y='0' z='1'/></emitter>", "3.0.0");
  ASSERT_TRUE(scene) << scene.error().message;
  const auto& map = std::get<EnvironmentMapLight>(scene->emitters[0]);
  // Its x is to the south and its y to the west, so it is mirrored; skies are the same on both sides of the
  // sun.
  const glm::dvec4 up = map.to_world * glm::dvec4(0, 1, 0, 0), south = map.to_world * glm::dvec4(0, 0, 1, 0);
  EXPECT_EQ(up, glm::dvec4(0, 0, 1, 0));
  EXPECT_EQ(south, glm::dvec4(1, 0, 0, 0));
  EXPECT_GT(texel(*map.image, 255, 64, 1), 10) << "the sun in the south";
}

TEST_F(SkyReader, ASunWithoutADiskIsDirectional) {
  const auto scene = read(
      "<emitter type='sun'><vector name='sunDirection' x='0' y='3' z='4'/>"
      "<float name='sunRadiusScale' value='0'/><float name='scale' value='2'/></emitter>");
  ASSERT_TRUE(scene) << scene.error().message;
  const auto& sun = std::get<DirectionalLight>(scene->emitters.at(0));
  EXPECT_NEAR(sun.direction.y, -0.6, 1e-12);
  const double solid_angle = 2 * kPi * (1 - std::cos(kSunRadius * kDegree));
  EXPECT_NEAR(double(sun.irradiance.y) / (2 * solid_angle * sun_radiance(0.6, 3).y), 1, 1e-5);
}

TEST_F(SkyReader, SaysWhatIsWrong) {
  const auto wrong = [&](const std::string& inside) {
    return error("<emitter type='sky'>" + inside + "</emitter>");
  };
  EXPECT_THAT(wrong("<float name='turbidity' value='0.5'/>"), HasSubstr("turbidity must be"));
  EXPECT_THAT(wrong("<float name='turbidity' value='-3'/>"), HasSubstr("turbidity must be"));
  EXPECT_THAT(wrong("<vector name='sunDirection' x='0' y='0' z='0'/>"), HasSubstr("a length above 0"));
  EXPECT_THAT(wrong("<float name='latitude' value='91'/>"),
              HasSubstr("latitude must be a number in [-90, 90], not 91"));
  EXPECT_THAT(wrong("<float name='month' value='13'/>"), HasSubstr("month must be"));
  EXPECT_THAT(wrong("<float name='stretch' value='3'/>"), HasSubstr("stretch must be"));
  EXPECT_THAT(wrong("<integer name='resolution' value='2'/>"), HasSubstr("resolution must be"));
  EXPECT_THAT(error("<emitter type='sky'/><emitter type='sunsky'/>"), HasSubstr("a scene has one"));
  const auto night = read("<emitter type='sky'><float name='hour' value='2'/></emitter>");
  ASSERT_TRUE(night);
  ASSERT_FALSE(night->warnings.empty());
  EXPECT_THAT(night->warnings[0], HasSubstr("below the horizon"));
}

}  // namespace
}  // namespace penumbra
