// Alpha: the fraction of a pixel's samples that hit a surface or a visible sky.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "scenes/settings.h"

#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/shadowed_polygon.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::coverage_test {
namespace {

using glm::dvec3;

constexpr int kWidth = 32;
constexpr double kEdge = 0.37, kDepth = 6;
constexpr std::uint32_t kSamples = 1024;

/// A camera at the origin that looks along z, x to the left, over a world whose half x > kEdge shines with
/// radiance 1 at depth kDepth. One row of pixels; independent samples.
SceneDescription half_plane(int bsdf = kBlackBsdf) {
  SceneDescription scene = empty_scene(kWidth, 1, kSamples, 5);
  scene.integrator = direct_integrator(1, 0);
  scene.shapes.push_back(parallelogram({kEdge, -1e3, kDepth}, {0, 2e3, 0}, {1e3, 0, 0}, bsdf, 1));
  scene.camera = {};
  scene.camera.fov = 60;
  scene.film.alpha = true;
  return scene;
}

/// Where its edge is, in pixels from the left.
double edge() { return 0.5 * kWidth * (1 - kEdge / kDepth / std::tan(std::numbers::pi / 6)); }
/// The share of a pixel that it covers.
double covered(int x) { return std::clamp(edge() - x, 0.0, 1.0); }

double alpha(const FilmAccumulator& film, int x, int y = 0) { return film.layer(x, y, LAYER_COVERAGE); }

/// Five standard deviations of the share of the samples, and the rounding of a ray.
double tolerance(double share) { return 5 * std::sqrt(share * (1 - share) / kSamples) + 1e-4; }

/// Of the plane itself, wherever it ends: `beyond` of what is not covered.
void expect_alpha(const SceneDescription& scene, double beyond = 0, double of_plane = 1) {
  const FilmAccumulator film = render_or_throw(scene);
  for (int x = 0; x < kWidth; ++x) {
    const double share = covered(x) * of_plane + (1 - covered(x)) * beyond;
    EXPECT_NEAR(alpha(film, x), share, tolerance(share)) << "pixel " << x;
  }
}

TEST(Coverage, IsTheShareOfThePixelWhateverTheIntegrator) {
  SceneDescription scene = half_plane();
  expect_alpha(scene);
  for (const IntegratorKind kind :
       {IntegratorKind::kPath, IntegratorKind::kWhitted, IntegratorKind::kPolygonAnalytic,
        IntegratorKind::kPolygonArea, IntegratorKind::kPolygonCv}) {
    SCOPED_TRACE(int(kind));
    use(scene.integrator, kind);
    expect_alpha(scene);
  }
}

TEST(Coverage, MultipliesTheColours) {
  const FilmAccumulator film = render_or_throw(half_plane());
  for (int x = 0; x < kWidth; ++x)
    EXPECT_EQ(film.at(x, 0).mean[1], alpha(film, x)) << "a plane of radiance 1, pixel " << x;
}

TEST(Coverage, IsWholeInsideAndNothingOutsideWhateverTheFilter) {
  SceneDescription scene = half_plane();
  for (const char* filter : {"tent", "gaussian", "mitchell", "lanczos"}) {
    ASSERT_TRUE(apply_setting(scene, "film.rfilter", filter));
    const FilmAccumulator film = render_or_throw(scene);
    for (int x = 0; x < kWidth; ++x) {
      if (std::abs(x + 0.5 - edge()) < scene.film.filter_radius) {
        EXPECT_GE(alpha(film, x), 0.0) << filter;
        EXPECT_LE(alpha(film, x), 1.0) << filter;
      } else {
        EXPECT_EQ(alpha(film, x), x < edge() ? 1.0 : 0.0) << filter << ", pixel " << x;
      }
    }
  }
}

TEST(Coverage, OfASkyIsWholeWhereItIsSeen) {
  SceneDescription scene = half_plane();
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(0.25f)});
  expect_alpha(scene, 1);
  scene.integrator.hide_emitters = true;
  scene.integrator.hidden_emitters = HiddenEmitters::kUnlit;
  expect_alpha(scene, 0);
  // The plane shines, so the camera looks through it, at a sky that is hidden too.
  scene.integrator.hidden_emitters = HiddenEmitters::kLookedThrough;
  expect_alpha(scene, 0, 0);
}

TEST(Coverage, OfLightsWithoutASurfaceIsNothing) {
  SceneDescription scene = half_plane();
  scene.emitters.emplace_back(PointLight{dvec3(0, 0, 3), glm::vec3(1)});
  expect_alpha(scene);
}

TEST(Coverage, OfOcclusionIsThatOfItsBackground) {
  SceneDescription scene = half_plane(0);
  add_diffuse(scene, 0.5f);
  for (const float background : {0.0f, 1.0f}) {
    AmbientOcclusionIntegrator method;
    method.background = background;
    scene.integrator.method = method;
    expect_alpha(scene, background);
  }
}

TEST(Coverage, OfAMaskIsItsOpacity) {
  constexpr float kOpacity = 0.3f;
  SceneDescription scene = half_plane(1);
  add_diffuse(scene, 0.5f);
  scene.bsdfs.push_back({"mask", MaskBsdf{kOpacity, 0}});
  scene.shapes[0].radiance.reset();
  for (const auto& integrator : {direct_integrator(1, 0), path_integrator(DirectSampling::kMis)}) {
    scene.integrator = integrator;
    expect_alpha(scene, 0, kOpacity);
  }
}

TEST(Coverage, IsNotThereUnlessAskedFor) {
  SceneDescription scene = half_plane();
  scene.film.alpha = false;
  EXPECT_EQ(build_or_throw(scene).header.features & FEATURE_COVERAGE, 0u);
  EXPECT_FALSE(render_or_throw(scene).layers().has(LAYER_COVERAGE));
}

/// A film without its last plane is that of the same render without alpha, which samples edges of lights.
void expect_rest_unchanged(SceneDescription scene) {
  scene.film.closed_light_edges = false;
  scene.film.alpha = true;
  const FilmAccumulator with = render_or_throw(scene);
  scene.film.alpha = false;
  const FilmAccumulator without = render_or_throw(scene);
  ASSERT_EQ(with.layers().planes(), without.layers().planes() + 1);
  for (int y = 0; y < with.height(); ++y)
    for (int x = 0; x < with.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        ASSERT_EQ(with.at(x, y).mean[c], without.at(x, y).mean[c]);
        ASSERT_EQ(with.at(x, y).m2[c], without.at(x, y).m2[c]);
      }
      for (int layer = 0; layer < FILM_LAYERS; ++layer)
        for (int plane = 0; without.layers().has(layer) && plane < kFilmLayers[layer].planes; ++plane)
          ASSERT_EQ(with.layer(x, y, layer, plane), without.layer(x, y, layer, plane)) << layer;
    }
}

TEST(Coverage, LeavesEverythingElseAsItIs) {
  expect_rest_unchanged(half_plane());
  SceneDescription scene = half_plane(0);
  add_diffuse(scene, 0.5f);
  scene.shapes.push_back(parallelogram({-1, -1, 3}, {0, 2, 0}, {1, 0, 0}, 0));
  scene.integrator = polygon_cv(1.0f, EmitterSampling::kSolidAngle, 2);
  expect_rest_unchanged(scene);
}

/// A half plane by paths, and by control variates.
std::vector<DeviceScene> covered_scenes() {
  SceneDescription scene = half_plane(0);
  add_diffuse(scene, 0.5f);
  scene.film.filter = FilterKind::kGaussian;
  std::vector<DeviceScene> scenes;
  for (const auto& integrator :
       {path_integrator(DirectSampling::kMis), polygon_cv(std::nullopt, EmitterSampling::kSolidAngle, 1)}) {
    scene.integrator = integrator;
    scenes.push_back(build_or_throw(scene));
  }
  return scenes;
}

TEST(Coverage, IsTheSameFromEveryBackend) {
  std::vector<DeviceScene> scenes = covered_scenes();
  share_needs(scenes);
  for (const DeviceScene& scene : scenes) {
    TestDevice device = native_device();
    const std::uint64_t hash = render_or_throw(scene, device).hash();
    for (const Isa isa : usable_isas()) {
      device.options.isa = isa;
      EXPECT_EQ(render_or_throw(scene, device).hash(), hash) << isa_name(isa);
    }
    device.options.block_of_one = true;
    EXPECT_EQ(render_or_throw(scene, device).hash(), hash);
    EXPECT_EQ(render_or_throw(scene, opencl_device()).hash(), hash) << "OpenCL";
  }
}

TEST(Coverage, IsTheSameFromOpenClKernelsForEachSceneAlone) {
  for (const DeviceScene& scene : covered_scenes())
    EXPECT_EQ(render_or_throw(scene, opencl_device()).hash(), render_or_throw(scene).hash());
}

}  // namespace
}  // namespace penumbra::coverage_test
