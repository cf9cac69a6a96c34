// Participating media against closed forms, quadrature and furnaces, and techniques against each other.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/acceptance/media_pieces.h"

namespace penumbra::media {
namespace {

// --- Transmittance.

TEST(Media, ASlabLetsThroughWhatBeerSays) {
  for (const double thickness : {1e-3, 0.5, 3.0}) {
    SceneDescription scene = narrow_view(200'000);
    const glm::vec3 extinction(0.3f, 1.0f, 2.5f);
    const int slab = add_medium(scene, medium(extinction, glm::vec3(0)));
    bound(scene, box({-1, -1, 1}, {1, 1, 1 + thickness}, add_null(scene)), slab);
    scene.emitters.emplace_back(ConstantEnvironment{});
    glm::dvec3 truth;
    for (int k = 0; k < 3; ++k) truth[k] = std::exp(-double(extinction[k]) * thickness);
    SCOPED_TRACE(thickness);
    expect_colour(scene, truth, 1e-5);
  }
}

// Paths pass what only absorbs: a slab, and one within it, dim all samples alike.
TEST(Media, ThatOnlyAbsorbCauseNoNoise) {
  SceneDescription scene = narrow_view(256);
  const glm::vec3 outer(0.3f, 1, 8), inner(2, 0, 0.1f);
  bound(scene, box({-1, -1, 1}, {1, 1, 3}, add_null(scene)), add_medium(scene, medium(outer, glm::vec3(0))));
  bound(scene, sphere({0, 0, 2}, 0.5, add_null(scene)), add_medium(scene, medium(inner, glm::vec3(0))));
  scene.emitters.emplace_back(ConstantEnvironment{});
  const FilmAccumulator film = render_or_throw(scene, big_passes());
  for (int k = 0; k < 3; ++k) {
    // The inner one is in the place of the outer one.
    const double truth = std::exp(-double(outer[k]) - double(inner[k]));
    const statistics::Sample sample = pixel_sample(film, 0, 0, k);
    EXPECT_NEAR(sample.mean() / truth, 1, 1e-4) << k;  // lengths are off by 1e-5 of some 10 free paths
    EXPECT_LT(sample.standard_error() / truth, 1e-5) << k;
  }
}

/// What a point light gives to a wall that one sample sees, before anything is between.
double lit_wall(const std::vector<std::pair<Shape, ParticipatingMedium>>& between, int channel) {
  SceneDescription scene = narrow_view(1);
  const int grey = add_diffuse(scene, 0.5f), nothing = add_null(scene);
  scene.shapes.push_back(parallelogram({2, -2, 4}, {-4, 0, 0}, {0, 4, 0}, grey));
  PointLight light;
  light.position = {1.5, 0, 0.5};
  scene.emitters.emplace_back(light);
  for (const auto& [shape, what] : between) {
    Shape placed = shape;
    placed.front_bsdf = placed.back_bsdf = nothing;
    bound(scene, placed, add_medium(scene, what));
  }
  param::max_depth(scene.integrator) = 2;
  return mean_image(render_or_throw(scene)).at(0, 0, channel);
}

// The light's way is oblique, off the camera's: deterministic. Where it crosses a boundary is off by up to
// 7 * 2^-24 of the coordinates, some 3, on either side of a slab, and its lengths round likewise.
double dimming_tolerance(double extinction) { return 1e-6 + extinction * 4e-6; }

TEST(Media, ShadowRaysAreDimmedByTheLengthWithinEachMedium) {
  const glm::dvec3 light(1.5, 0, 0.5), wall(0, 0, 4);
  const double slope = glm::length(wall - light) / (wall.z - light.z);
  const auto slab = [](double from, double to) {
    // Beside the camera's way, across that of the light.
    return box({0.05, -1, from}, {1.4, 1, to}, 0);
  };
  const glm::vec3 a(0.2f, 0.9f, 3), b(1.1f, 0.1f, 0.4f);
  for (int k = 0; k < 3; ++k) {
    const double plain = lit_wall({}, k);
    ASSERT_GT(plain, 0);
    const double one = lit_wall({{slab(1, 2.25), medium(a, glm::vec3(0.5f))}}, k);
    EXPECT_NEAR(one / plain / std::exp(-double(a[k]) * 1.25 * slope), 1, dimming_tolerance(double(a[k])))
        << k;
    // Two that touch.
    const double two =
        lit_wall({{slab(1, 2.25), medium(a, glm::vec3(0.5f))}, {slab(2.25, 3), medium(b, glm::vec3(0))}}, k);
    EXPECT_NEAR(two / plain / std::exp(-(double(a[k]) * 1.25 + double(b[k]) * 0.75) * slope), 1,
                dimming_tolerance(double(a[k]) + double(b[k])))
        << k;
    // One within another.
    const double nested = lit_wall({{slab(1, 3), medium(a, glm::vec3(0.5f))},
                                    {box({0.1, -0.5, 1.5}, {1.3, 0.5, 2.5}, 0), medium(b, glm::vec3(0))}},
                                   k);
    EXPECT_NEAR(nested / plain / std::exp(-(double(a[k]) + double(b[k])) * slope), 1,
                dimming_tolerance(double(a[k]) + double(b[k])))
        << k;
  }
}

TEST(Media, ACameraInsideSeesThroughWhatIsLeftOfItsMedium) {
  SceneDescription scene = narrow_view(200'000);
  const int around = add_medium(scene, medium(0.7f, 0));
  scene.camera_medium = around;
  bound(scene, box({-1, -1, -1}, {1, 1, 1.5}, add_null(scene)), around);
  scene.emitters.emplace_back(ConstantEnvironment{});
  expect_colour(scene, glm::dvec3(std::exp(-0.7 * (1.5 - scene.camera.near_clip))), 1e-5);
}

// --- Single scattering.

/// Radiance along z from the origin of light that a medium within [near, far] scatters once, from a point
/// light of intensity 1: Simpson's rule.
double scattered_once(const glm::dvec3& light, double near, double far, double extinction, double albedo,
                      double g) {
  constexpr int kSteps = 20'000;
  double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double z = near + (far - near) * i / kSteps;
    const glm::dvec3 to = light - glm::dvec3(0, 0, z);
    const double d = glm::length(to), mu = to.z / d;
    // The light is within the slab too: all of its way is in the medium.
    const double phase = (1 - g * g) / (4 * std::numbers::pi * std::pow(1 + g * g - 2 * g * mu, 1.5));
    const double value = albedo * extinction * std::exp(-extinction * (z - near + d)) * phase / (d * d);
    sum += value * (i == 0 || i == kSteps ? 1 : (i % 2 == 1 ? 4 : 2));
  }
  return sum * (far - near) / kSteps / 3;
}

TEST(Media, ScatterOnceAsQuadratureSays) {
  const glm::dvec3 light(0.6, 0.3, 2.2);
  for (const double g : {-0.7, 0.0, 0.7}) {
    SceneDescription scene = narrow_view(400'000, volpath(DirectSampling::kMis, 2));
    const glm::vec3 extinction(0.2f, 0.8f, 3), albedo(0.9f, 0.5f, 1);
    bound(scene, box({-20, -20, 1}, {20, 20, 4}, add_null(scene)),
          add_medium(scene, medium(extinction, albedo, float(g))));
    PointLight point;
    point.position = light;
    scene.emitters.emplace_back(point);
    glm::dvec3 truth;
    for (int k = 0; k < 3; ++k)
      truth[k] = scattered_once(light, 1, 4, double(extinction[k]), double(albedo[k]), g);
    SCOPED_TRACE(g);
    expect_colour(scene, truth);
  }
}

// --- Furnaces.

TEST(Media, WithoutAbsorptionChangeNoFurnace) {
  for (const DirectSampling sampling : {DirectSampling::kBsdfOnly, DirectSampling::kMis})
    for (const float g : {0.0f, 0.8f}) {
      SceneDescription scene = narrow_view(100'000, volpath(sampling));
      bound(scene, sphere({0, 0, 3}, 1, add_null(scene)),
            add_medium(scene, medium(glm::vec3(0.5f, 2, 6), glm::vec3(1), g)));
      scene.emitters.emplace_back(ConstantEnvironment{});
      SCOPED_TRACE(g);
      expect_colour(scene, glm::dvec3(1));
    }
}

TEST(Media, ARoomFilledToItsWallsIsTheFurnaceItWas) {
  SceneDescription scene = narrow_view(100'000);
  const int grey = add_diffuse(scene, 0.5f);
  // The medium's boundary and the walls are in the same places; which comes first is not the same for all.
  for (const bool walls_first : {true, false}) {
    SceneDescription room = scene;
    const int nothing = add_null(room), filling = add_medium(room, medium(1, 1));
    Shape walls = box({-1, -1, -1}, {1, 1, 2}, grey);
    walls.flip_normals = true;
    walls.radiance = glm::vec3(1);
    if (walls_first) room.shapes.push_back(walls);
    bound(room, box({-1, -1, -1}, {1, 1, 2}, nothing), filling);
    if (!walls_first) room.shapes.push_back(walls);
    room.camera_medium = filling;
    SCOPED_TRACE(walls_first);
    expect_colour(room, glm::dvec3(2));
  }
}

TEST(Media, WithinGlassAreTheFurnaceTheyWere) {
  SceneDescription scene = narrow_view(100'000);
  const DielectricBsdf glass;
  scene.bsdfs.push_back({"glass", glass});
  scene.bsdfs.push_back({"glass from inside", glass.other_side()});
  Shape ball = sphere({0, 0, 3}, 1, 0);
  ball.back_bsdf = 1;
  bound(scene, ball, add_medium(scene, medium(2, 1, 0.3f)));
  scene.emitters.emplace_back(ConstantEnvironment{});
  expect_colour(scene, glm::dvec3(1));
}

// --- Techniques, scales, and scenes without media.

SceneDescription foggy_room(double scale, const IntegratorSettings& integrator) {
  SceneDescription scene = empty_scene(8, 8, 4000, 3);
  scene.camera = look_at(glm::dvec3(0, 0, -3) * scale, glm::dvec3(0), glm::dvec3(0, 1, 0), 40);
  scene.camera.near_clip = 1e-4 * scale;
  scene.camera.far_clip = 1e4 * scale;
  scene.integrator = integrator;
  const int grey = add_diffuse(scene, 0.6f), nothing = add_null(scene);
  const auto s = float(scale);
  const auto at = [&](double x, double y, double z) { return glm::dvec3(x, y, z) * scale; };
  scene.camera_medium = add_medium(scene, medium(glm::vec3(0.1f, 0.15f, 0.2f) / s, glm::vec3(0.9f), 0.6f));
  const int dense = add_medium(scene, medium(glm::vec3(4, 2, 1) / s, glm::vec3(0.8f, 0.9f, 0.99f), -0.3f));
  scene.shapes.push_back(parallelogram(at(-2, -1, -2), at(0, 0, 4), at(4, 0, 0), grey));
  scene.shapes.push_back(parallelogram(at(0.5, 1.5, 0.5), at(0, 0, -1), at(-1, 0, 0), grey, 10.0f));
  bound(scene, sphere(at(-0.6, -0.4, 0), 0.5 * scale, nothing), dense);
  bound(scene, box(at(0.2, -0.9, -0.4), at(1, 0.2, 0.4), nothing), dense);
  return scene;
}

TEST(Media, EveryTechniqueFindsTheSame) {
  expect_alike(foggy_room(1, volpath(DirectSampling::kMis)),
               foggy_room(1, volpath(DirectSampling::kBsdfOnly)));
}

/// Balls and smoke below the lamp that absorb, in fog that scatters. `albedo`: what they scatter.
SceneDescription dim_room(DirectSampling sampling, float albedo) {
  SceneDescription scene = foggy_room(1, volpath(sampling));
  scene.media[1].albedo = glm::vec3(albedo);
  ParticipatingMedium smoke = medium({3, 1.5f, 1}, glm::vec3(albedo));
  smoke.density = grid({5, 2, 4}, 1, [](int x, int y, int z, int) { return 0.4f * float((x + y + z) % 4); });
  const glm::dvec3 low(-0.7, 1, -0.7), high(0.7, 1.4, 0.7);
  smoke.density->to_world = unit_cube_to(low, high);
  bound(scene, box(low, high, add_null(scene)), add_medium(scene, smoke));
  return scene;
}

TEST(Media, ThatOnlyAbsorbLookTheSameByEveryTechnique) {
  expect_alike(dim_room(DirectSampling::kMis, 0), dim_room(DirectSampling::kBsdfOnly, 0));
  // So little scattering that it is not seen: distances are sampled.
  expect_alike(dim_room(DirectSampling::kMis, 0), dim_room(DirectSampling::kMis, 1e-30f));
}

// A power of two scales every number exactly.
TEST(Media, LargerScenesOfThinnerMediaAreTheSame) {
  const statistics::Image small = mean_image(render_or_throw(foggy_room(1, volpath())));
  const statistics::Image large = mean_image(render_or_throw(foggy_room(1024, volpath())));
  EXPECT_EQ(small.values, large.values);
}

TEST(Media, AreLeftOutWhereThereAreNone) {
  SceneDescription scene = foggy_room(1, volpath());
  scene.camera_medium = kNoMedium;
  for (Shape& shape : scene.shapes) shape.interior = kNoMedium;
  SceneDescription paths = scene;
  paths.integrator = {.method = PathIntegrator{}};
  const DeviceScene a = build_or_throw(scene), b = build_or_throw(paths);
  EXPECT_EQ(a.header.features & FEATURE_MEDIA, 0u);
  EXPECT_EQ(a.header.features, b.header.features);
  EXPECT_EQ(a.words, b.words);
  EXPECT_EQ(mean_image(render_or_throw(a)).values, mean_image(render_or_throw(b)).values);
}

// --- Thin panes, which rays pass as they pass boundaries, where there are no media too.

int add_clear_pane(SceneDescription& scene, float ior) {
  ThinDielectricBsdf pane;
  pane.int_ior = ior;
  pane.ext_ior = 1;
  scene.bsdfs.push_back({"pane", pane});
  return int(scene.bsdfs.size()) - 1;
}

/// Light that is seen through panes takes no depth. Each lets through (1 - r) / (1 + r), with r of one
/// boundary.
TEST(Media, PanesDoNotCountAsDepth) {
  constexpr double kIor = 2.17;
  for (const int depth : {1, 4}) {
    SceneDescription scene = narrow_view(200'000, volpath(DirectSampling::kMis, depth));
    scene.shapes.push_back(box({-1, -1, 1}, {1, 1, 2}, add_clear_pane(scene, float(kIor))));
    scene.emitters.emplace_back(ConstantEnvironment{});
    const double one = std::pow((kIor - 1) / (kIor + 1), 2), reflected = 2 * one / (1 + one),
                 passed = 1 - reflected;
    // Of depth 4, all that but what passed the first and was reflected four times within.
    const double truth = depth == 1 ? passed * passed : 1 - passed * std::pow(reflected, 4);
    SCOPED_TRACE(depth);
    expect_colour(scene, glm::dvec3(truth), 1e-5);
  }
}

/// The inside of a ball is another surface than the outside that the ray passed before.
TEST(Media, PanesOfBallsReflectWithin) {
  SceneDescription scene = empty_scene(16, 16, 256, 1);
  scene.camera = look_at({0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 14);
  scene.integrator = volpath();
  scene.shapes.push_back(sphere({0, 0, 0}, 1, add_clear_pane(scene, 2.17f)));
  scene.shapes.push_back(parallelogram({-4, -1.2, 4}, {8, 0, 0}, {0, 0, -8}, add_diffuse(scene, 0.2f)));
  scene.emitters.emplace_back(ConstantEnvironment{});
  SceneDescription branching = scene;  // where panes are surfaces like others
  branching.integrator = {.method = WhittedIntegrator{.max_depth = -1}};
  expect_alike(scene, branching);
}

/// Fog that ends nowhere, in a scene without any triangle.
TEST(Media, FogWithoutBoundariesNeedsNoTriangles) {
  SceneDescription scene = empty_scene(16, 16, 256, 1);
  scene.camera = look_at({0, -4, 2}, {0, 0, 0}, {0, 0, 1}, 40);
  scene.integrator = volpath();
  scene.camera_medium = add_medium(scene, medium({0.1f, 0.2f, 0.3f}, glm::vec3(0.5f)));
  scene.shapes.push_back(sphere({0, 0, 0}, 0.5, add_diffuse(scene, 0.5f)));
  PointLight light;
  light.position = {0, -1, 2};
  scene.emitters.emplace_back(light);
  const FilmAccumulator film = render_or_throw(scene, big_passes());
  EXPECT_EQ(non_finite_count(film.flagged()), 0u);
  SceneDescription with_one = scene;
  // Behind the camera, so far off that no light gets there.
  const glm::dvec3 corners[] = {{0, -1000, 0}, {1, -1000, 0}, {0, -1000, 1}};
  with_one.shapes.push_back(triangles(corners, add_diffuse(with_one, 0.5f)));
  expect_alike(scene, with_one);
}

// --- Ends of the range.

TEST(Media, OfAnyDensityGiveFiniteImagesOfTheirTransmittance) {
  for (const float depth : {1e-8f, 1e-3f, 20.0f, 1e3f, 1e8f})
    for (const float albedo : {0.0f, 1.0f}) {
      SceneDescription scene = narrow_view(2000);
      bound(scene, box({-1, -1, 1}, {1, 1, 2}, add_null(scene)), add_medium(scene, medium(depth, albedo)));
      scene.emitters.emplace_back(ConstantEnvironment{});
      const FilmAccumulator film = render_or_throw(scene, big_passes());
      EXPECT_EQ(non_finite_count(film.flagged()), 0u) << depth;
      const double mean = pixel_sample(film, 0, 0, 0).mean();
      EXPECT_LE(mean, 1.3) << depth;
      if (albedo == 0) EXPECT_NEAR(mean, std::exp(-double(depth)), 1e-3 + (depth < 1 ? depth : 0)) << depth;
    }
}

// What half a space of isotropic scattering gives back of light from everywhere, straight up: 1 - H(1) sqrt(1
// - a), H(1) = exp(-1/pi int_0^(pi/2) log(1 - a t / tan t) dt) (Chandrasekhar 1960, sections 25 and 39). Of
// media of 1e8 mean free paths a float's spacing holds ten.
TEST(Media, OfAnyDensityGiveBackWhatTheirAlbedoSays) {
  constexpr double kOfAlbedo9 = 0.41494747913;
  for (const double width : {1.0, 100.0})
    for (const float extinction : {100.0f, 1e5f, 1e8f}) {
      SceneDescription scene = narrow_view(50'000, volpath(DirectSampling::kBsdfOnly));
      bound(scene, box({-width, -width, 1}, {width, width, 2}, add_null(scene)),
            add_medium(scene, medium(extinction, 0.9f)));
      scene.emitters.emplace_back(ConstantEnvironment{});
      SCOPED_TRACE(extinction);
      expect_colour(scene, glm::dvec3(kOfAlbedo9));
      EXPECT_EQ(render_or_throw(scene, big_passes()).flagged()[BAD_BOUNDARY].count, 0u);
    }
}

TEST(Media, ThousandsOfBoundariesAreCrossed) {
  SceneDescription scene = narrow_view(64);
  const int nothing = add_null(scene), thin = add_medium(scene, medium(1e-3f, 0));
  for (int i = 0; i < 5000; ++i) {
    const double z = 1 + i * 1e-3;
    bound(scene, box({-0.5, -0.5, z}, {0.5, 0.5, z + 0.5e-3}, nothing), thin);
  }
  scene.emitters.emplace_back(ConstantEnvironment{});
  const FilmAccumulator film = render_or_throw(scene, big_passes());
  EXPECT_NEAR(pixel_sample(film, 0, 0, 0).mean(), std::exp(-2.5e-3), 0.06);
}

}  // namespace
}  // namespace penumbra::media
