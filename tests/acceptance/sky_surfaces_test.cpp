// Surfaces under Mitsuba 3's sunsky, end to end, against what Mitsuba 3.9.1 has for them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <glm/glm.hpp>

#include "tests/support/render_scene.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using glm::dvec3;

/// What the image costs: SkyImage.LightsSurfacesAsMitsubaDoes allows as much of one with a quarter of the
/// columns. The sun is nowhere at the horizon of a surface, so that to spread its disk costs nothing more.
constexpr double kOfImage = 4e-3;
/// The standard error that is asked for, and how often it fits: all 15 means are within that with a
/// probability of 1 - 1e-4.
constexpr double kNoise = 1.3e-3, kDeviates = 4.5;
constexpr double kTolerance = kOfImage + kDeviates * kNoise;

struct Case {
  const char* what;
  double turbidity, albedo;
  dvec3 to_sun, normal;
  bool with_sun;
  dvec3 radiance;  ///< of Mitsuba 3.9.1, for a diffuse reflectance of 0.5
  int samples = 8192;
};

// By quadrature of its radiance, as tests/scenes/mitsuba_skies.py does. At sunset the sun's blue is below 0,
// and so that of the wall has more noise.
const Case kCases[] = {
    {"a wall under the sky", 3, 0.3, {0.5, 0.3, 0.81}, {0, 1, 0}, false, {0.021073, 0.031462, 0.048487}},
    {"a wall in the sun", 3, 0.3, {0.5, 0.3, 0.81}, {0, 1, 0}, true, {0.092448, 0.090886, 0.093643}},
    {"ground under the sky", 3, 0.3, {0.5, 0.3, 0.81}, {0, 0, 1}, false, {0.026318, 0.041650, 0.071834}},
    {"ground in the sun", 3, 0.3, {0.5, 0.3, 0.81}, {0, 0, 1}, true, {0.219033, 0.202094, 0.193754}},
    {"a wall at sunset",
     1,
     0,
     {0.99996192, 0, 0.00872654},
     {1, 0, 0},
     true,
     {0.0839020, 0.0278434, 0.0023581},
     32768}};

TEST(SkySurfaces, AreAsBrightAsInMitsuba) {
  const TemporaryFolder folder;
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.what);
    const dvec3 n = c.normal;
    const std::string up = n.z > 0.9 ? "1, 0, 0" : "0, 0, 1";
    write_text(folder / "scene.xml",
               fmt::format(R"(<scene version="3.0.0"><integrator type="path"/>
      <sensor type="perspective"><float name="fov" value="1"/><transform name="to_world">
        <lookat origin="{}, {}, {}" target="0, 0, 0" up="{}"/></transform>
        <sampler type="independent"><integer name="sample_count" value="{}"/></sampler>
        <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/>
          <rfilter type="box"/></film></sensor>
      <emitter type="sunsky"><float name="turbidity" value="{}"/><float name="albedo" value="{}"/>
        <vector name="sun_direction" value="{}, {}, {}"/><float name="sun_scale" value="{}"/></emitter>
      <shape type="rectangle"><transform name="to_world">
        <lookat origin="0, 0, 0" target="{}, {}, {}" up="{}"/></transform>
        <bsdf type="diffuse"><float name="reflectance" value="0.5"/></bsdf></shape></scene>)",
                           2 * n.x, 2 * n.y, 2 * n.z, up, c.samples, c.turbidity, c.albedo, c.to_sun.x,
                           c.to_sun.y, c.to_sun.z, c.with_sun ? 1 : 0, n.x, n.y, n.z, up));
    const FilmAccumulator film = render_or_throw(read_or_throw(folder / "scene.xml"));
    for (int channel = 0; channel < 3; ++channel) {
      const auto sample = film_sample(film, channel);
      EXPECT_LT(sample.standard_error(), kNoise * c.radiance[channel]) << channel;
      EXPECT_NEAR(sample.mean() / c.radiance[channel], 1, kTolerance) << channel;
    }
  }
}

}  // namespace
}  // namespace penumbra
