// Alpha equals Mitsuba's: the coverage of pixels, with and without skies, masks, glass and hidden emitters.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/differential/mitsuba_process.h"
#include "tests/differential/scene_parts.h"
#include "tests/support/render_scene.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::differential {
namespace {

constexpr int kSize = 24, kSamples = 1024;
constexpr double kSignificance = 0.01;  ///< of all comparisons together

std::string ball(const std::string& bsdf) { return plugin("shape", "sphere", real("radius", 0.8) + bsdf); }
std::string hiding(std::string_view integrator) {
  return plugin("integrator", integrator, boolean("hide_emitters", true));
}

std::vector<std::pair<std::string, std::string>> scenes() {
  const std::string path = plugin("integrator", "path", ""), hides = hiding("path");
  const std::string mask = plugin("bsdf", "mask", real("opacity", 0.3) + kWhite);
  const std::string glass = plugin("bsdf", "dielectric", ""), nothing = plugin("bsdf", "null", "");
  const std::string spot =
      plugin("emitter", "point",
             "<point name=\"position\" x=\"2\" y=\"3\" z=\"3\"/>\n" + rgb("intensity", glm::dvec3(20)));
  const std::string area_light = ball(area(3));
  return {{"a ball", path + ball(kWhite) + spot},
          {"glass", path + ball(glass) + spot},
          {"a mask", path + ball(mask) + spot},
          {"nothing", path + ball(nothing) + spot},
          {"a sky", path + ball(kWhite) + kSky},
          {"a hidden sky", hides + ball(kWhite) + kSky},
          {"a mask before a hidden sky", hides + ball(mask) + kSky},
          {"glass before a hidden sky", hides + ball(glass) + kSky},
          {"an area light", path + area_light + floor_at(-1)},
          {"a hidden area light", hides + area_light + floor_at(-1, 1)},
          {"direct light", hiding("direct") + ball(kWhite) + kSky}};
}

/// How far sums of n samples in [0, 1] of each of two renders may be apart, by Bernstein's inequality, if
/// each of them has this variance on the average.
double bound(double n, double variance, double significance) {
  const double l = std::log(2 / significance);
  return l / 3 + std::sqrt(l * l / 9 + 4 * n * variance * l);
}

TEST(DifferentialTest, AlphaIsMitsubas) {
  MitsubaProcess mitsuba;
  if (!mitsuba.ready()) {
    if (mitsuba.named()) FAIL() << mitsuba.ready().error().message;
    GTEST_SKIP() << mitsuba.ready().error().message;
  }
  const TemporaryFolder folder;
  const double significance =
      statistics::sidak_significance(kSignificance, scenes().size() * (kSize * kSize + 1));
  for (const auto& [name, inside] : scenes()) {
    SCOPED_TRACE(name);
    const std::string film =
        integer("width", kSize) + integer("height", kSize) + text("pixel_format", "rgba");
    const std::string sampler = plugin("sampler", "independent", integer("sample_count", kSamples));
    std::string camera = sensor({0, 1, 4}, {0, 0, 0}, 40, film);
    camera.insert(camera.rfind("</sensor>"), sampler);
    write_text(folder / "s.xml", "<scene version=\"3.0.0\">\n" + camera + inside + "</scene>\n");
    const MitsubaJob job{folder / "s.xml", folder / "s.alpha.exr", 1, kSamples, 1};
    mitsuba.start(job);
    const FilmAccumulator film_of_ours = render_or_throw(read_or_throw(folder / "s.xml"));
    const auto theirs = mitsuba.finish(job);
    ASSERT_TRUE(theirs) << theirs.error().message;
    ASSERT_TRUE(film_of_ours.layers().has(LAYER_COVERAGE));
    double difference = 0, variance = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const double a = film_of_ours.layer(x, y, LAYER_COVERAGE), b = (*theirs)[0].at(x, y, 0);
        const double both = std::clamp((a + b) / 2, 0.0, 1.0), of_pixel = both * (1 - both);
        EXPECT_LE(kSamples * std::abs(a - b), bound(kSamples, of_pixel, significance))
            << x << ',' << y << ": " << a << ", Mitsuba's " << b;
        difference += a - b;
        variance += of_pixel / (kSize * kSize);
      }
    EXPECT_LE(kSamples * std::abs(difference),
              bound(double(kSamples) * kSize * kSize, variance, significance));
  }
}

}  // namespace
}  // namespace penumbra::differential
