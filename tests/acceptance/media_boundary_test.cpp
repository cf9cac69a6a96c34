// Boundaries of media: thin panes that shadow rays pass, and boundaries that contradict each other.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/acceptance/media_pieces.h"

namespace penumbra::media {
namespace {

// --- Thin panes.

constexpr double kPaneIndex = 1.5;

int add_pane(SceneDescription& scene, const glm::vec3& tint) {
  ThinDielectricBsdf pane;
  pane.int_ior = float(kPaneIndex);
  pane.ext_ior = 1;
  pane.specular_transmittance = TexturedColour(tint);
  scene.bsdfs.push_back({"pane", pane});
  return int(scene.bsdfs.size()) - 1;
}

/// What passes a pane at that cosine: the sum over reflections within.
double passes_pane(double cosine) {
  const double r = reflectance(cosine, kPaneIndex);
  return 1 - 2 * r / (1 + r);
}

Shape both_sides(Shape shape) {
  shape.back_bsdf = shape.front_bsdf;
  return shape;
}

/// Where a medium is that no light meets, so that the scene is one with media.
void add_medium_aside(SceneDescription& scene) {
  bound(scene, box({50, 50, 50}, {51, 51, 51}, add_null(scene)), add_medium(scene, medium(1, 0.5f)));
}

TEST(Panes, DimShadowRaysByWhatTheyLetThrough) {
  const glm::vec3 tint(0.3f, 0.6f, 1);
  const auto wall = [&](int panes) {
    SceneDescription scene = narrow_view(1);
    scene.shapes.push_back(parallelogram({2, -2, 4}, {-4, 0, 0}, {0, 4, 0}, add_diffuse(scene, 0.5f)));
    PointLight light;
    light.position = {1.5, 0, 0.5};
    scene.emitters.emplace_back(light);
    const int pane = add_pane(scene, tint);
    for (int i = 0; i < panes; ++i)  // beside the camera's way, across that of the light
      scene.shapes.push_back(
          both_sides(parallelogram({1.4, -1, 2 + 0.5 * i}, {-1.35, 0, 0}, {0, 2, 0}, pane)));
    add_medium_aside(scene);
    param::max_depth(scene.integrator) = 2;
    return mean_image(render_or_throw(scene));
  };
  const glm::dvec3 way = glm::dvec3(0, 0, 4) - glm::dvec3(1.5, 0, 0.5);
  const double passes = passes_pane(way.z / glm::length(way));
  const statistics::Image plain = wall(0);
  for (const int panes : {1, 2, 3}) {
    const statistics::Image dimmed = wall(panes);
    for (int k = 0; k < 3; ++k)  // some ten operations of single precision each
      EXPECT_NEAR(dimmed.at(0, 0, k) / plain.at(0, 0, k) / std::pow(passes * double(tint[k]), panes), 1,
                  panes * 10.0 / (1 << 23))
          << panes << " panes, channel " << k;
  }
}

SceneDescription room_with_panes(DirectSampling sampling) {
  SceneDescription scene = empty_scene(8, 8, 4000, 3);
  scene.camera = look_at({0, 0, -3}, {0, 0, 0}, {0, 1, 0}, 40);
  scene.integrator = volpath(sampling);
  const int grey = add_diffuse(scene, 0.6f), pane = add_pane(scene, {0.9f, 0.7f, 0.5f});
  scene.shapes.push_back(parallelogram({-2, -1, -2}, {0, 0, 4}, {4, 0, 0}, grey));
  scene.shapes.push_back(parallelogram({0.7, 1.5, 0.7}, {-1.4, 0, 0}, {0, 0, -1.4}, grey, 10.0f));
  scene.shapes.push_back(both_sides(parallelogram({-1.5, 1, -1.5}, {0, 0, 3}, {3, 0, 0}, pane)));
  bound(scene, sphere({-0.5, -0.3, 0}, 0.6, pane), add_medium(scene, medium({4, 2, 1}, {0.8f, 0.9f, 0.99f})));
  return scene;
}

TEST(Panes, EveryTechniqueFindsTheSameBehindThem) {
  expect_alike(room_with_panes(DirectSampling::kMis), room_with_panes(DirectSampling::kBsdfOnly));
}

TEST(Panes, AboutAMediumWithoutAbsorptionChangeNoFurnace) {
  SceneDescription scene = narrow_view(100'000);
  const int pane = add_pane(scene, glm::vec3(1));
  bound(scene, sphere({0.2, 0.1, 3}, 1, pane), add_medium(scene, medium(2, 1, 0.3f)));
  scene.emitters.emplace_back(ConstantEnvironment{});
  expect_colour(scene, glm::dvec3(1));
}

// --- Surfaces within a medium that bound none.

TEST(Media, PassedSurfacesWithinThemChangeNothing) {
  const auto view = [](int surfaces) {
    SceneDescription scene = narrow_view(200'000);
    scene.camera_medium = add_medium(scene, medium(0.5f, 0));
    const int nothing = add_null(scene);
    bound(scene, box({-1, -1, -1}, {1, 1, 4}, nothing), scene.camera_medium);
    for (int i = 0; i < surfaces; ++i)
      scene.shapes.push_back(both_sides(parallelogram({-1, -1, 1.0 + i}, {2, 0, 0}, {0, 2, 0}, nothing)));
    scene.emitters.emplace_back(ConstantEnvironment{});
    return scene;
  };
  for (const int surfaces : {0, 1, 2})
    expect_colour(view(surfaces), glm::dvec3(std::exp(-0.5 * (4 - view(0).camera.near_clip))), 1e-5);
}

TEST(Media, ShadowRaysPassSurfacesWithinThemOnce) {
  const auto wall = [](int surfaces) {
    SceneDescription scene = narrow_view(1);
    scene.camera_medium = add_medium(scene, medium(0.5f, 0));
    scene.shapes.push_back(parallelogram({2, -2, 4}, {-4, 0, 0}, {0, 4, 0}, add_diffuse(scene, 0.5f)));
    PointLight light;
    light.position = {1.5, 0, 0.5};
    scene.emitters.emplace_back(light);
    const int nothing = add_null(scene);
    for (int i = 0; i < surfaces; ++i)  // beside the camera's way, across that of the light
      scene.shapes.push_back(
          both_sides(parallelogram({1.4, -1, 2 + 0.5 * i}, {-1.35, 0, 0}, {0, 2, 0}, nothing)));
    param::max_depth(scene.integrator) = 2;
    return mean_image(render_or_throw(scene)).at(0, 0, 0);
  };
  const double plain = wall(0);
  ASSERT_GT(plain, 0);
  // Lengths of some 4 round by 2^-22 of them each, times the extinction.
  for (const int surfaces : {1, 2, 3}) EXPECT_NEAR(wall(surfaces) / plain, 1, surfaces * 4e-6) << surfaces;
}

// --- Contradictions.

FlaggedSamples contradictions(const SceneDescription& scene) {
  return render_or_throw(scene, big_passes()).flagged()[BAD_BOUNDARY];
}

/// Boxes along z, of a medium each.
SceneDescription boxes(const std::vector<std::pair<double, double>>& parts) {
  SceneDescription scene = narrow_view(64);
  const int nothing = add_null(scene);
  for (const auto& [from, to] : parts)
    bound(scene, box({-1, -1, from}, {1, 1, to}, nothing),
          add_medium(scene, medium(0.01f * float(1 + scene.media.size()), 0)));
  scene.emitters.emplace_back(ConstantEnvironment{});
  return scene;
}

TEST(Contradictions, OfMediaThatOverlapInPartAreOfTheOneThatIsLeftFirst) {
  const FlaggedSamples found = contradictions(boxes({{5, 6}, {1, 3}, {2, 4}}));
  EXPECT_EQ(found.count, 64u);
  EXPECT_EQ(found.shape, 1);
  EXPECT_EQ(std::pair(found.x, found.y), std::pair(0, 0));
  EXPECT_EQ(found.sample, 0u);
}

TEST(Contradictions, AreNoneOfMediaThatAreNestedOrTouch) {
  EXPECT_EQ(contradictions(boxes({{1, 4}, {2, 3}})).count, 0u);
  EXPECT_EQ(contradictions(boxes({{1, 2}, {2, 3}, {3, 4}})).count, 0u);
  EXPECT_EQ(contradictions(boxes({{3, 4}, {2, 3}, {1, 2}})).count, 0u);
}

TEST(Contradictions, OfACameraThatDoesNotNameItsMediumAreFound) {
  SceneDescription scene = boxes({{-1, 2}});
  EXPECT_EQ(contradictions(scene).count, 64u);
  scene.camera_medium = 0;
  EXPECT_EQ(contradictions(scene).count, 0u);
}

TEST(Contradictions, OfWhatIsSaidOfTheOutsideAreFound) {
  SceneDescription scene = boxes({{2, 3}});
  scene.shapes[0].exterior = add_medium(scene, medium(0.02f, 0));
  EXPECT_GT(contradictions(scene).count, 0u);
  scene.camera_medium = scene.shapes[0].exterior;
  EXPECT_EQ(contradictions(scene).count, 0u);
}

// Shadow rays and paths through meshes and spheres, past edges and silhouettes, by every instruction set.
TEST(Contradictions, AreNoneOfClosedSurfaces) {
  SceneDescription scene = room_with_panes(DirectSampling::kMis);
  const int nothing = add_null(scene), fog = add_medium(scene, medium(0.5f, 0.8f));
  bound(scene, box({-1.9, -0.99, -0.7}, {-1.15, 0.5, 0.7}, nothing), fog);
  bound(scene, box({0.4, -1, -0.5}, {1.3, 0.4, 0.4}, nothing), fog);
  bound(scene, sphere({0.8, -0.3, 0}, 0.3, nothing), add_medium(scene, medium(3, 0.9f)));
  scene.film.width = scene.film.height = 64;
  scene.sampler.spp = 256;
  const FlaggedSamples found = contradictions(scene);
  EXPECT_EQ(found.count, 0u) << "sample " << found.sample << " of pixel " << found.x << ", " << found.y
                             << ", shape " << found.shape;
}

}  // namespace
}  // namespace penumbra::media
