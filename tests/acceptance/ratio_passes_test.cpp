// The ratio estimator over several passes: its quotient is that of all samples, so its image and error are
// those of one pass but for rounding, and its bias falls with the samples of the pixel.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenes/device/device_scene_builder.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/shadowed_polygon.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::ratio_passes_test {
namespace {

using glm::dvec3;

constexpr double kSignificance = 0.01;
/// Sums over a pass in single precision, of values up to some times the result.
constexpr double kRounding = 256.0 / (1 << 24);
const dvec3 kViewer(0.004, 0.01, -0.002);

SceneDescription shadowed_scene(int pixels, std::uint32_t spp, std::uint32_t seed) {
  SceneDescription scene = receiver_scene(DiffuseBsdf{glm::vec3(0.5f)}, kViewer, pixels, seed);
  add_light(scene, large_light(kEdge24), glm::vec3(1));
  scene.integrator = polygon_ratio(EmitterSampling::kArea, 1);
  scene.sampler.spp = spp;
  return scene;
}

FilmAccumulator by_passes(const SceneDescription& scene, std::uint32_t pass, bool layers = true) {
  TestDevice device = native_device();
  device.samples_per_pass = pass;
  DeviceSceneOptions options;
  options.feature_layers = layers;
  auto built = build_device_scene(scene, options);
  if (!built) throw std::runtime_error(built.error().message);
  return render_or_throw(*built, device);
}

std::vector<SceneDescription> scenes_of_passes() {
  std::vector<SceneDescription> all;
  all.push_back(shadowed_scene(8, 96, 1));
  for (const FilterKind filter : {FilterKind::kBox, FilterKind::kMitchell}) {
    // A floor that the light shines on from behind an occluder, with colours, a lobe and other lights.
    SceneDescription scene = empty_scene(24, 16, 96, 2);
    scene.camera = look_at(dvec3(0.5, 2, 3), dvec3(0), dvec3(0, 1, 0), 60);
    scene.bsdfs.push_back({"floor", PhongBsdf{glm::vec3(0.5f, 0.7f, 0.2f), glm::vec3(0.3f), 9}});
    scene.shapes.push_back(parallelogram({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, 0));
    add_light(scene, large_light(kEdge68), glm::vec3(3, 2, 1));
    scene.emitters.emplace_back(PointLight{dvec3(1, 1, 1), glm::vec3(1)});
    scene.film.filter = filter;
    scene.film.filter_radius = filter == FilterKind::kBox ? 0.5f : 2.0f;
    scene.integrator = polygon_ratio(EmitterSampling::kSolidAngle, 2);
    all.push_back(scene);
    scene.integrator = path_integrator(DirectSampling::kEmitterOnly);
    param::max_depth(scene.integrator) = 3;
    param::next_event(scene.integrator) = NextEvent::kCv;
    param::estimator(scene.integrator) = CvEstimator::kRatio;
    all.push_back(scene);
  }
  return all;
}

TEST(RatioPasses, TheImageIsThatOfOnePass) {
  for (const SceneDescription& scene : scenes_of_passes()) {
    const FilmAccumulator one = by_passes(scene, 96);
    for (const std::uint32_t pass : {1u, 2u, 7u, 48u}) {
      const FilmAccumulator film = by_passes(scene, pass);
      for (int y = 0; y < film.height(); ++y)
        for (int x = 0; x < film.width(); ++x)
          for (int c = 0; c < 3; ++c) {
            const double scale =
                std::abs(one.at(x, y).mean[c]) + std::abs(one.layer(x, y, kAnalyticR + c)) + 1e-9;
            ASSERT_NEAR(film.at(x, y).mean[c], one.at(x, y).mean[c], kRounding * scale)
                << x << ", " << y << " by passes of " << pass;
            ASSERT_NEAR(film.layer(x, y, kDifferenceR + c), one.layer(x, y, kDifferenceR + c),
                        kRounding * scale);
            ASSERT_NEAR(film.at(x, y).m2[c], one.at(x, y).m2[c],
                        kRounding * (one.at(x, y).m2[c] + 96 * scale * scale));
          }
    }
  }
}

TEST(RatioPasses, TheImageDoesNotDependOnLayers) {
  for (const SceneDescription& scene : scenes_of_passes()) {
    const FilmAccumulator with = by_passes(scene, 8), without = by_passes(scene, 8, false);
    for (int y = 0; y < with.height(); ++y)
      for (int x = 0; x < with.width(); ++x) {
        ASSERT_EQ(with.at(x, y).mean[0], without.at(x, y).mean[0]);
        ASSERT_EQ(with.at(x, y).m2[2], without.at(x, y).m2[2]);
      }
  }
}

TEST(RatioPasses, BiasFallsWithTheSamplesNotWithThePass) {
  const double truth =
      reflected_radiance(large_light(kEdge24).visible(), DiffuseBsdf{glm::vec3(0.5f)}, kViewer);
  constexpr int kPixels = 192;
  const auto errors = [&](std::uint32_t spp, std::uint32_t seed) {
    const FilmAccumulator film = by_passes(shadowed_scene(kPixels, spp, seed), 2);
    statistics::Sample sample;
    for (int y = 0; y < kPixels; ++y)
      for (int x = 0; x < kPixels; ++x) sample.add(spp * (film.at(x, y).mean[1] - truth));
    return sample;
  };
  // Times the samples it is a constant, but for terms of the order of 1 / samples: 5 % of it at 32.
  const statistics::Sample at_32 = errors(32, 1), at_256 = errors(256, 2);
  EXPECT_LT(statistics::t_test(at_32, 0).p, 1e-6) << "a bias is seen";
  EXPECT_GT(statistics::welch_t_test(at_32, at_256, 0.1 * std::abs(at_32.mean())).p, kSignificance)
      << at_32.mean() << " +- " << at_32.standard_error() << ", " << at_256.mean() << " +- "
      << at_256.standard_error();
}

TEST(RatioPasses, SpreadIsTheError) {
  constexpr int kPixels = 128;
  constexpr std::uint32_t kSamples = 128;
  const FilmAccumulator film = by_passes(shadowed_scene(kPixels, kSamples, 3), 4);
  statistics::Sample means, variances;
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x) {
      means.add(film.at(x, y).mean[1]);
      variances.add(film.at(x, y).m2[1] / (kSamples * (kSamples - 1.0)));
    }
  // The delta method leaves out O(1 / n); a variance of so many nearly normal values is known to 1.1 %.
  EXPECT_NEAR(variances.mean() / means.variance(), 1,
              4.0 / kSamples + 4 * std::sqrt(2.0 / (kPixels * kPixels)));
}

}  // namespace
}  // namespace penumbra::ratio_passes_test
