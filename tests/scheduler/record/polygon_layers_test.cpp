// The layers of polygon lights: they are written if requested and known, closed form and difference add up to
// the image, and the visible fraction is in [0, 1].
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "scenes/device/device_scene_builder.h"
#include "scheduler/record/film_image.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/shadowed_polygon.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

using glm::dvec3;
using ::testing::Contains;
using ::testing::IsSupersetOf;
using ::testing::Not;
using enum EmitterSampling;

/// A floor under a square and a triangle of two colours; with `shadows` a dark square between them.
SceneDescription floor_scene(bool shadows,
                             const BsdfModel& bsdf = DiffuseBsdf{glm::vec3(0.5f, 0.75f, 0.25f)}) {
  SceneDescription scene = empty_scene(24, 16, 16, 5);
  scene.sampler.kind = SamplerKind::kSobol;
  scene.camera = look_at(dvec3(0, 1.5, -3), dvec3(0), dvec3(0, 1, 0), 35);
  scene.bsdfs.push_back({"floor", bsdf});
  scene.shapes.push_back(parallelogram({-4, 0, -4}, {0, 0, 8}, {8, 0, 0}, 0));
  scene.shapes.push_back(parallelogram({-0.5, 2, -0.5}, {1, 0, 0}, {0, 0, 1}, kBlackBsdf, 3.0f));
  scene.shapes.push_back(
      triangles(std::vector{dvec3(1, 2, 1), dvec3(2, 2, 1), dvec3(1.5, 2, 2)}, kBlackBsdf, 1.0f));
  scene.shapes.back().radiance = glm::vec3(1, 2, 4);
  if (shadows) scene.shapes.push_back(parallelogram({-0.4, 1, -0.4}, {0, 0, 0.8}, {0.8, 0, 0}, kBlackBsdf));
  // What is seen of lights themselves is in the image alone.
  scene.integrator.hide_emitters = true;
  return scene;
}

const PhongBsdf kGlossy{glm::vec3(0.3f), glm::vec3(0.4f), 20};

struct Estimator {
  std::string name;
  IntegratorSettings settings;
};

std::vector<Estimator> estimators() {
  IntegratorSettings path = path_integrator(DirectSampling::kEmitterOnly), by_contribution = path;
  param::next_event(path) = NextEvent::kCv;
  param::max_depth(path) = param::max_depth(by_contribution) = 2;
  param::light_choice(by_contribution) = LightChoice::kAnalytic;
  std::vector<Estimator> all{{"alpha 1", polygon_cv(1.0f, kSolidAngle, 2)},
                             {"alpha 0", polygon_cv(0.0f, kSolidAngle, 2)},
                             {"alpha -0.5", polygon_cv(-0.5f, kSolidAngle, 1)},
                             {"auto", polygon_cv(std::nullopt, kSolidAngle, 2)},
                             {"auto, projected", polygon_cv(std::nullopt, kProjected, 1)},
                             {"direct", emitter_only(kSolidAngle, 2, LightChoice::kAnalytic)},
                             {"path", path},
                             {"path by contribution", by_contribution}};
  for (Estimator& each : all) each.settings.hide_emitters = true;
  return all;
}

double layer(const FilmAccumulator& film, int x, int y, int layer, int channel) {
  return film.layer(x, y, layer, channel);
}

DeviceScene build(const SceneDescription& scene, bool layers) {
  DeviceSceneOptions options;
  options.feature_layers = layers;
  auto built = build_device_scene(scene, options);
  if (!built) throw std::runtime_error(built.error().message);
  return std::move(*built);
}

// --- which layers there are

TEST(PolygonLayers, CountOfPlanes) {
  for (const std::uint64_t others :
       {std::uint64_t(0),
        std::uint64_t(FEATURE_ALL & ~(FEATURE_LAYERS | FEATURE_POLYGONS | FEATURE_DENOISING |
                                      FEATURE_COVERAGE | LAYERS_ON_DEMAND))}) {
    EXPECT_EQ(plane_count(others), 6);
    EXPECT_EQ(plane_count(others | FEATURE_POLYGONS), 6);
    EXPECT_EQ(plane_count(others | FEATURE_LAYERS), 6 + 7);
    EXPECT_EQ(plane_count(others | FEATURE_LAYERS | FEATURE_POLYGONS), 6 + 7 + 8);
    for (const std::uint64_t layers : {std::uint64_t(0), std::uint64_t(FEATURE_LAYERS),
                                       std::uint64_t(FEATURE_LAYERS | FEATURE_POLYGONS)}) {
      const int without = plane_count(others | layers),
                with = plane_count(others | layers | FEATURE_COVERAGE);
      EXPECT_EQ(with, without + 1);
      EXPECT_FALSE(has_layer(others | layers, LAYER_COVERAGE));
      EXPECT_EQ(layer_plane(others | layers | FEATURE_COVERAGE, LAYER_COVERAGE), without);
    }
  }
}

TEST(PolygonLayers, AreThereIfWantedAndKnown) {
  const std::vector<std::string> names{"analytic.R",   "analytic.G",   "analytic.B",  "difference.R",
                                       "difference.G", "difference.B", "visibility.Y"};
  const auto channels = [](const SceneDescription& scene, bool layers) {
    return image_of_film(render_or_throw(build(scene, layers)), 24, 16).channels;
  };
  SceneDescription scene = floor_scene(true);
  for (const Estimator& each : estimators()) {
    scene.integrator = each.settings;
    EXPECT_THAT(channels(scene, true), IsSupersetOf(names)) << each.name;
    EXPECT_EQ(channels(scene, false).size(), 7u) << each.name;
  }
  scene.integrator = {};
  use(scene.integrator, IntegratorKind::kPolygonAnalytic);
  EXPECT_THAT(channels(scene, true), IsSupersetOf(names));
  // No closed form, then.
  IntegratorSettings area;
  use(area, IntegratorKind::kPolygonArea);
  for (const IntegratorSettings& settings :
       {direct_integrator(1, 1), emitter_only(kProjected, 1), path_integrator(DirectSampling::kMis), area}) {
    scene.integrator = settings;
    const std::vector<std::string> there = channels(scene, true);
    EXPECT_THAT(there, Contains("albedo.R"));
    EXPECT_EQ(there.size(), 7u + 7u);
    for (const std::string& name : names) EXPECT_THAT(there, Not(Contains(name)));
  }
  // Nor where the lights have none.
  scene.shapes.resize(1);
  scene.integrator = polygon_cv(std::nullopt, kAuto, 1);
  EXPECT_EQ(channels(scene, true).size(), 7u + 7u);
}

// --- what they add up to

/// A pixel's estimate and its layers are means of some 16 terms, each of a few roundings; the samples with
/// and without shadows are at most a few times the closed form.
constexpr double kRounding = 64.0 / (1 << 24);

TEST(PolygonLayers, ClosedFormAndDifferenceMakeTheImage) {
  for (const BsdfModel& bsdf : {BsdfModel(DiffuseBsdf{glm::vec3(0.5f, 0.75f, 0.25f)}), BsdfModel(kGlossy)})
    for (const FilterKind filter : {FilterKind::kBox, FilterKind::kMitchell})
      for (const Estimator& each : estimators()) {
        SceneDescription scene = floor_scene(true, bsdf);
        scene.integrator = each.settings;
        if (filter == FilterKind::kMitchell) {
          scene.film.filter = filter;
          scene.film.filter_radius = 2;
        }
        for (const std::uint32_t pass : {16u, 6u}) {
          TestDevice device = native_device();
          device.samples_per_pass = pass;
          const FilmAccumulator film = render_or_throw(scene, device);
          double lit = 0;
          for (int y = 0; y < film.height(); ++y)
            for (int x = 0; x < film.width(); ++x)
              for (int c = 0; c < 3; ++c) {
                const double analytic = layer(film, x, y, LAYER_ANALYTIC, c);
                const double difference = layer(film, x, y, LAYER_DIFFERENCE, c);
                ASSERT_NEAR(film.at(x, y).mean[c], analytic + difference, kRounding * analytic)
                    << each.name << " at " << x << ", " << y;
                lit += analytic;
              }
          EXPECT_GT(lit, 0);
        }
      }
}

TEST(PolygonLayers, TheClosedFormIsThatOfPolygonAnalytic) {
  for (const BsdfModel& bsdf : {BsdfModel(DiffuseBsdf{glm::vec3(0.5f, 0.75f, 0.25f)}), BsdfModel(kGlossy)}) {
    SceneDescription scene = floor_scene(true, bsdf);
    scene.integrator = {};
    use(scene.integrator, IntegratorKind::kPolygonAnalytic);
    scene.integrator.hide_emitters = true;
    const FilmAccumulator alone = render_or_throw(scene);
    for (const Estimator& each : estimators()) {
      scene.integrator = each.settings;
      const FilmAccumulator film = render_or_throw(scene);
      const bool same_rays = build_or_throw(scene).header.integrator.estimator != ESTIMATOR_AUTO;
      // A fitted alpha takes its camera rays from two other sequences. Each mean errs by no more than that of
      // independent rays would.
      constexpr double kSigmas = 5;
      for (int y = 0; y < film.height(); ++y)
        for (int x = 0; x < film.width(); ++x)
          for (int c = 0; c < 3; ++c) {
            const double truth = alone.at(x, y).mean[c];
            const double error = std::sqrt(2 * alone.at(x, y).m2[c] / (16 * 15));
            ASSERT_NEAR(layer(film, x, y, LAYER_ANALYTIC, c), truth,
                        kRounding * truth + (same_rays ? 0 : kSigmas * error))
                << each.name << " at " << x << ", " << y;
            ASSERT_EQ(layer(alone, x, y, LAYER_DIFFERENCE, c), 0) << "it has no samples";
          }
    }
  }
}

TEST(PolygonLayers, WithoutOccludersAllIsVisible) {
  for (const BsdfModel& bsdf : {BsdfModel(DiffuseBsdf{glm::vec3(0.5f)}), BsdfModel(kGlossy)})
    for (const Estimator& each : estimators()) {
      SceneDescription scene = floor_scene(false, bsdf);
      scene.integrator = each.settings;
      const FilmAccumulator film = render_or_throw(scene);
      for (int y = 0; y < film.height(); ++y)
        for (int x = 0; x < film.width(); ++x) {
          ASSERT_EQ(film.visibility(x, y), 1) << each.name << " at " << x << ", " << y;
          // H is W to the last bit.
          if (const auto cv = control_variate(each.settings); cv && cv->alpha == 1.0f) {
            ASSERT_EQ(layer(film, x, y, LAYER_DIFFERENCE, 1), 0);
          }
        }
    }
}

TEST(PolygonLayers, WithOccludersItIsAShare) {
  for (const BsdfModel& bsdf : {BsdfModel(DiffuseBsdf{glm::vec3(0.5f)}), BsdfModel(kGlossy)})
    for (const Estimator& each : estimators()) {
      SceneDescription scene = floor_scene(true, bsdf);
      scene.integrator = each.settings;
      const FilmAccumulator film = render_or_throw(scene);
      int shadowed = 0, lit = 0;
      double difference = 0;
      for (int y = 0; y < film.height(); ++y)
        for (int x = 0; x < film.width(); ++x) {
          const double visibility = film.visibility(x, y);
          ASSERT_GE(visibility, 0);
          ASSERT_LE(visibility, 1);
          shadowed += visibility < 0.5 ? 1 : 0;
          lit += visibility == 1 ? 1 : 0;
          difference += layer(film, x, y, LAYER_DIFFERENCE, 1);
        }
      EXPECT_GT(shadowed, 3) << each.name;
      EXPECT_GT(lit, 3) << each.name;
      EXPECT_LT(difference, 0) << each.name;
    }
}

TEST(PolygonLayers, TheShareIsThatOfTheProjectedSolidAngle) {
  // Samples by projected solid angle of a diffuse point have one weight: the layer is the mean of 0 or 1.
  const DiffuseBsdf grey{glm::vec3(0.5f)};
  for (const double edge : {kEdge68, kEdge24, kEdgeUmbra}) {
    const ShadowedPolygon light = large_light(edge);
    SceneDescription scene = receiver_scene(grey, dvec3(0.004, 0.01, -0.002), 64, 21);
    add_light(scene, light, glm::vec3(1));
    scene.integrator = polygon_cv(1.0f, kProjected, 1);
    scene.sampler.spp = 4;
    const FilmAccumulator film = render_or_throw(scene);
    double sum = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) sum += film.visibility(x, y);
    const double share = projected_solid_angle(light.visible()) / projected_solid_angle(light.light);
    constexpr double kCount = 64 * 64 * 4, kSigmas = 4;  // one in 16 000
    EXPECT_NEAR(sum / (64 * 64), share, kSigmas * std::sqrt(share * (1 - share) / kCount) + kRounding)
        << edge;
  }
}

TEST(PolygonLayers, WhereThereIsNoLightTheyAreZero) {
  // The lights face up.
  SceneDescription scene = floor_scene(true);
  for (const std::size_t i : {1u, 2u}) scene.shapes[i].flip_normals = true;
  for (const Estimator& each : estimators()) {
    scene.integrator = each.settings;
    const FilmAccumulator film = render_or_throw(scene);
    for (int y = 0; y < film.height(); ++y)
      for (int x = 0; x < film.width(); ++x)
        for (int layer = LAYER_ANALYTIC; layer <= LAYER_UNSHADOWED; ++layer)
          for (int plane = 0; plane < kFilmLayers[layer].planes; ++plane)
            ASSERT_EQ(film.layer(x, y, layer, plane), 0) << each.name << ' ' << kFilmLayers[layer].name;
  }
}

}  // namespace
}  // namespace penumbra
