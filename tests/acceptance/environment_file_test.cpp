// A scene lit by an environment map from a file, end to end: planes reflect what quadrature of the texels in
// double gives. The map has a sun of one texel that is a million times as bright as the sky.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/render_scene.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using glm::dvec3;

constexpr double kPi = std::numbers::pi, kReflectance = 0.5, kSignificance = 0.01;
constexpr int kWidth = 1024, kHeight = 512, kSunX = 333, kSunY = 120;

/// Grey; rows from the top.
float texel(int x, int y) {
  if (x % kWidth == kSunX && y == kSunY) return 1e6f;
  return 0.5f + 0.25f * float(std::sin(0.02 * (x % kWidth)) * std::cos(0.05 * y)) +
         float(kHeight - y) / kHeight;
}

dvec3 direction(double x, double y) {
  const double longitude = 2 * kPi * (x + 0.5) / kWidth, polar = kPi * y / (kHeight - 1);
  return {std::sin(longitude) * std::sin(polar), std::cos(polar), -std::cos(longitude) * std::sin(polar)};
}

/// Of a plane, by `parts` x `parts` midpoints in each cell between texels.
double irradiance(const dvec3& normal, int parts) {
  const double size = kPi / (kHeight - 1) * (2 * kPi / kWidth) / (parts * parts);
  double sum = 0;
  for (int y = 0; y < kHeight - 1; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double corners[] = {texel(x, y), texel(x + 1, y), texel(x, y + 1), texel(x + 1, y + 1)};
      for (int i = 0; i < parts * parts; ++i) {
        const double s = (i % parts + 0.5) / parts, t = (i / parts + 0.5) / parts;
        const double cosine = glm::dot(normal, direction(x + s, y + t));
        const double radiance =
            (1 - t) * ((1 - s) * corners[0] + s * corners[1]) + t * ((1 - s) * corners[2] + s * corners[3]);
        sum += radiance * std::max(cosine, 0.0) * std::sin(kPi * (y + t) / (kHeight - 1)) * size;
      }
    }
  return sum;
}

void write_map(const std::filesystem::path& path) {
  auto output = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(output);
  ASSERT_TRUE(output->open(path.string(), OIIO::ImageSpec(kWidth, kHeight, 3, OIIO::TypeFloat)));
  std::vector<float> values;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) values.insert(values.end(), 3, texel(x, y));
  ASSERT_TRUE(output->write_image(OIIO::TypeFloat, values.data()));
  ASSERT_TRUE(output->close());
}

TEST(EnvironmentFile, PlanesReflectTheIntegralOfItsTexels) {
  const TemporaryFolder folder;
  ASSERT_NO_FATAL_FAILURE(write_map(folder / "map.exr"));
  // Up; towards the sun; away from it, so that it is low above the plane.
  const dvec3 sun = direction(kSunX, kSunY), across = glm::normalize(glm::cross(sun, dvec3(0, 1, 0)));
  const dvec3 normals[] = {{0, 1, 0}, sun, glm::normalize(0.2 * sun + across)};
  for (const dvec3& n : normals) {
    SCOPED_TRACE(fmt::format("({}, {}, {})", n.x, n.y, n.z));
    const dvec3 eye = 2.0 * n;
    const std::string up = std::abs(n.y) > 0.9 ? "1, 0, 0" : "0, 1, 0";
    write_text(folder / "scene.xml", fmt::format(R"(<scene version="3.0.0"><integrator type="path"/>
      <sensor type="perspective"><float name="fov" value="1"/><transform name="to_world">
        <lookat origin="{}, {}, {}" target="0, 0, 0" up="{}"/></transform>
        <sampler type="independent"><integer name="sample_count" value="256"/></sampler>
        <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/>
          <rfilter type="box"/></film></sensor>
      <emitter type="envmap"><string name="filename" value="map.exr"/></emitter>
      <shape type="rectangle"><transform name="to_world">
        <lookat origin="0, 0, 0" target="{}, {}, {}" up="{}"/></transform>
        <bsdf type="diffuse"><float name="reflectance" value="{}"/></bsdf></shape></scene>)",
                                                 eye.x, eye.y, eye.z, up, n.x, n.y, n.z, up, kReflectance));
    const FilmAccumulator film = render_or_throw(read_or_throw(folder / "scene.xml"));
    const double coarse = irradiance(n, 2), fine = irradiance(n, 4), expected = kReflectance / kPi * fine;
    // The quadrature's own error falls by 4 a step.
    const double allowance = kReflectance / kPi * std::abs(fine - coarse) + expected * 64 / (1 << 24);
    EXPECT_LT(allowance, 1e-3 * expected);
    const auto test = statistics::t_test(film_sample(film, 1), expected, allowance);
    EXPECT_GT(test.p, statistics::sidak_significance(kSignificance, std::size(normals)))
        << film_sample(film, 1).mean() << " instead of " << expected;
    EXPECT_LT(film_sample(film, 1).standard_error(), 0.01 * expected);
  }
}

}  // namespace
}  // namespace penumbra
