// Plates of glass that shadow rays towards the sky pass, thin panes, and a ball: against quadrature, and
// between techniques of which some never take such rays.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <numbers>

#include "kernels/features.h"
#include "tests/acceptance/media_pieces.h"

namespace penumbra::flat_glass_test {
namespace {

using namespace media;

constexpr double kIndex = 1.5;

/// A closed shape of glass whose sides face outwards.
Shape of_glass(SceneDescription& scene, Shape shape, const glm::vec3& tint = glm::vec3(1)) {
  DielectricBsdf glass;
  glass.int_ior = float(kIndex);
  glass.ext_ior = 1;
  glass.specular_transmittance = TexturedColour(tint);
  scene.bsdfs.push_back({"glass", glass});
  shape.front_bsdf = int(scene.bsdfs.size()) - 1;
  scene.bsdfs.push_back({"glass from inside", glass.other_side()});
  shape.back_bsdf = int(scene.bsdfs.size()) - 1;
  return shape;
}

Shape turned(Shape shape, const glm::dvec3& axis, double degrees) {
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1), glm::radians(degrees), axis);
  for (glm::dvec3& p : std::get<Mesh>(shape.geometry).positions) p = glm::dvec3(turn * glm::dvec4(p, 1));
  return shape;
}

/// The mean of (1 - reflectance)^power over the hemisphere, weighted by the cosine: midpoints over its
/// square.
double passes(int power) {
  constexpr int kSteps = 1'000'000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    sum += std::pow(1 - reflectance(std::sqrt((i + 0.5) / kSteps), kIndex), power);
  return sum / kSteps;
}

IntegratorSettings path(DirectSampling sampling, int max_depth = -1) {
  return {.method = PathIntegrator{.max_depth = max_depth, .direct_sampling = sampling}};
}

/// Wide matt ground under an even sky, with the camera between the ground and large plates above it.
SceneDescription ground_under(int plates, const IntegratorSettings& integrator) {
  SceneDescription scene = narrow_view(100'000, integrator);
  scene.shapes.push_back(parallelogram({1e4, -1e4, 1}, {-2e4, 0, 0}, {0, 2e4, 0}, add_diffuse(scene, 0.5f)));
  for (int i = 0; i < plates; ++i)
    scene.shapes.push_back(of_glass(scene, box({-1e4, -1e4, -2.0 - i}, {1e4, 1e4, -1.5 - i}, 0)));
  scene.emitters.emplace_back(ConstantEnvironment{});
  return scene;
}

TEST(FlatGlass, LetsThroughWhatQuadratureSays) {
  // The plates end 3e-4 radians above the horizon, where next to nothing passes.
  constexpr double kTolerance = 1e-5;
  const double two = 0.5 * passes(2), four = 0.5 * passes(4);
  for (const DirectSampling sampling :
       {DirectSampling::kMis, DirectSampling::kBsdfOnly, DirectSampling::kEmitterOnly}) {
    SCOPED_TRACE(int(sampling));
    // Each boundary is an edge of the path. What is reflected takes more edges than these.
    expect_colour(ground_under(1, path(sampling, 4)), glm::dvec3(two), kTolerance);
    expect_colour(ground_under(2, path(sampling, 6)), glm::dvec3(four), kTolerance);
    EXPECT_LT(mean_image(render_or_throw(ground_under(1, path(sampling, 3)))).at(0, 0, 0), kTolerance);
    EXPECT_LT(mean_image(render_or_throw(ground_under(2, path(sampling, 5)))).at(0, 0, 0), kTolerance);
  }
}

TEST(FlatGlass, IsLeftOutWhereNothingNeedsIt) {
  const auto features = [](const SceneDescription& scene) {
    return build_or_throw(scene).header.features & FEATURE_FLAT_GLASS;
  };
  const SceneDescription plate = ground_under(1, path(DirectSampling::kMis));
  EXPECT_NE(features(plate), 0u);
  SceneDescription indoors = plate;
  indoors.emitters = {PointLight{}};
  EXPECT_EQ(features(indoors), 0u) << "no light from infinity that directions find";
  SceneDescription ball = plate;
  ball.shapes.back().geometry = Sphere{.center = {0, 0, -3}, .radius = 1};
  EXPECT_EQ(features(ball), 0u);
  SceneDescription parts = plate;
  std::get<PathIntegrator>(parts.integrator.method).only_bounces = 1;
  EXPECT_EQ(features(parts), 0u);
}

/// A room with a light inside, seen from within, that the sky lights through glass: a tinted plate, a plate
/// behind it that is turned, a wedge, whose sides are flat but not parallel, and a ball.
SceneDescription glazed_room(const IntegratorSettings& integrator, std::uint32_t spp = 2000) {
  SceneDescription scene = empty_scene(16, 16, spp, 3);
  scene.camera = look_at({0.2, 0, -3}, {0, 0, 0}, {0, 1, 0}, 40);
  scene.integrator = integrator;
  const int grey = add_diffuse(scene, 0.6f);
  scene.shapes.push_back(parallelogram({-2, -1, -3}, {0, 0, 5}, {4, 0, 0}, grey));
  scene.shapes.push_back(parallelogram({2, -1, 2}, {-4, 0, 0}, {0, 3, 0}, grey));
  scene.shapes.push_back(parallelogram({0.2, 0.9, 0.2}, {-0.4, 0, 0}, {0, 0, -0.4}, grey, 3.0f));
  scene.shapes.push_back(of_glass(scene, box({-2, 1, -2}, {0.5, 1.2, 2}, 0), {0.9f, 0.7f, 0.5f}));
  scene.shapes.push_back(turned(of_glass(scene, box({-2, 2, -2}, {1, 2.1, 2}, 0)), {0.1, 0, 1}, 15));
  Shape wedge = of_glass(scene, box({0.6, 1, -1}, {1.6, 1.3, 1}, 0));
  for (glm::dvec3& p : std::get<Mesh>(wedge.geometry).positions) p.y += p.y > 1.2 ? 0.4 * (p.x - 0.6) : 0;
  scene.shapes.push_back(wedge);
  Shape ball = of_glass(scene, sphere({-0.6, -0.6, 0.3}, 0.4, 0));
  ball.front_bsdf = wedge.front_bsdf;
  ball.back_bsdf = wedge.back_bsdf;
  scene.shapes.push_back(ball);
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1, 1.2f, 1.5f)});
  return scene;
}

TEST(FlatGlass, MisFindsWhatDirectionsFind) {
  expect_alike(glazed_room(path(DirectSampling::kMis, 12), 100),
               glazed_room(path(DirectSampling::kBsdfOnly, 12), 100));
}

TEST(FlatGlass, EveryTechniqueFindsTheSameBehindIt) {
  const SceneDescription mis = glazed_room(path(DirectSampling::kMis, 12));
  EXPECT_NE(build_or_throw(mis).header.features & FEATURE_FLAT_GLASS, 0u);
  expect_alike(mis, glazed_room(path(DirectSampling::kBsdfOnly, 12)));
  expect_alike(glazed_room(path(DirectSampling::kEmitterOnly, 12)), mis);
  expect_alike(mis, glazed_room({.method = WhittedIntegrator{.max_depth = 12}}));
}

/// A dark sky with four small suns about the y axis, one of them along -z.
EnvironmentMapLight suns() {
  constexpr int kWidth = 128, kHeight = 64;
  Bitmap map{.name = "suns",
             .width = kWidth,
             .height = kHeight,
             .channels = 1,
             .type = TexelType::kFloat,
             .words = {}};
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const int from_sun = (i % kWidth + 1) % (kWidth / 4), from_horizon = i / kWidth - kHeight / 2;
    map.words.push_back(
        std::bit_cast<std::uint32_t>(from_sun <= 1 && std::abs(from_horizon) <= 1 ? 1e3f : 0.1f));
  }
  EnvironmentMapLight light;
  light.image = std::make_shared<const Bitmap>(std::move(map));
  return light;
}

TEST(FlatGlass, TheSunBehindItIsNotLeftToChance) {
  const auto seen = [](DirectSampling sampling) {
    SceneDescription scene = ground_under(1, path(sampling, 4));
    scene.emitters = {suns()};
    return pixel_sample(render_or_throw(scene, big_passes()), 0, 0, 0);
  };
  const statistics::Sample mis = seen(DirectSampling::kMis), by_chance = seen(DirectSampling::kBsdfOnly);
  EXPECT_GT(statistics::welch_t_test(mis, by_chance).p, media::kSignificance);
  // By chance, one direction in several hundred finds the sun.
  EXPECT_LT(mis.standard_error() * 5, by_chance.standard_error());
}

// Rays that would pass the centre of the ball at less than `index` times the bulb's radius are refracted into
// the bulb. If rays started 3e-4 off the surface, the bulb would have 0.8 % more power.
TEST(GlassBall, MagnifiesABulbInIt) {
  constexpr double kDistance = 2, kBall = 0.09, kBulb = 0.03, kRadiance = 3;
  const double edge = std::tan(std::asin(kIndex * kBulb / kDistance)), half = 1.1 * edge;
  constexpr int kRings = 1000;
  double seen = 0;
  for (int i = 0; i < kRings; ++i) {
    const double tangent = edge * (i + 0.5) / kRings, sine = kDistance / kBall * std::sin(std::atan(tangent));
    const double passes = 1 - reflectance(std::sqrt(1 - sine * sine), kIndex);
    seen += 2 * std::numbers::pi * tangent * (edge / kRings) * passes / (kIndex * kIndex) * kRadiance;
  }
  SceneDescription scene = empty_scene(1, 1, 400'000, 1);
  const glm::dvec3 centre(1.3, 2.6, 1.02);
  scene.camera =
      look_at(centre - glm::dvec3(0, 0, kDistance), centre, {0, 1, 0}, glm::degrees(2 * std::atan(half)));
  scene.integrator = path(DirectSampling::kMis);
  scene.shapes.push_back(of_glass(scene, sphere(centre, kBall, 0)));
  scene.shapes.push_back(sphere(centre, kBulb, kBlackBsdf));
  scene.shapes.back().radiance = glm::vec3(float(kRadiance));
  expect_colour(scene, glm::dvec3(seen / (4 * half * half)));
}

}  // namespace
}  // namespace penumbra::flat_glass_test
