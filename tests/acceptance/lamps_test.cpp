// Suns with an angle, spot lights with a radius and lights that the camera does not see: penumbrae against
// their closed form, what cameras and mirrors see, and furnaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/shadowed_polygon.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::lamps_test {
namespace {

using glm::dvec3;

constexpr double kPi = std::numbers::pi;
constexpr double kSignificance = 0.01;
constexpr double kRounding = 64.0 / (1 << 24);  ///< see furnace_test.cpp
constexpr float kAlbedo = 0.8f;
/// Half the angle of a sun in the zenith, or that which a spot light's sphere subtends there.
constexpr double kHalfAngle = 20 * kPi / 180;
constexpr double kEdgeHeight = 0.3;

DirectionalLight sun_above(double angle) {
  DirectionalLight sun;
  sun.irradiance = glm::vec3(1.5f);
  sun.direction = dvec3(0, -1, 0);
  sun.angle = angle;
  return sun;
}

/// At height 1, as bright below as the sun.
SpotLight spot_above() {
  SpotLight spot;
  spot.intensity = glm::vec3(1.5f);
  spot.radius = std::sin(kHalfAngle);
  spot.cutoff_angle = spot.beam_width = 80;
  spot.to_world = glm::dmat4({1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}, {0, 1, 0, 1});
  return spot;
}

/// The share of the irradiance at the origin that is left by a half plane at the height of the edge, from x =
/// `edge` on. The directions of the light are a disk of radius sin(kHalfAngle) when projected to the floor,
/// in proportion to the irradiance. The edge is the line (edge, kEdgeHeight, z): a half ellipse.
double visible_share(double edge) {
  constexpr int kSteps = 200'000;  // the error of midpoints falls as its power of -3/2, at the disk's ends
  const double radius = std::sin(kHalfAngle), slope = edge / std::hypot(edge, kEdgeHeight);
  double area = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double z = radius * (2 * (i + 0.5) / kSteps - 1);
    const double half = std::sqrt(radius * radius - z * z), cut = slope * std::sqrt(1 - z * z);
    area += std::clamp(cut, -half, half) + half;
  }
  return area * 2 * radius / kSteps / (kPi * radius * radius);
}

struct Method {
  std::string name;
  IntegratorSettings integrator;
};

std::vector<Method> methods() {
  IntegratorSettings whitted;
  use(whitted, IntegratorKind::kWhitted);
  return {{"path", path_integrator(DirectSampling::kMis)},
          {"path, emitters alone", path_integrator(DirectSampling::kEmitterOnly)},
          {"direct", direct_integrator(2, 1)},
          {"whitted", whitted}};
}

TEST(Penumbrae, OfSunsAndSpotLightsHaveTheirProfile) {
  std::uint32_t seed = 1;
  for (const bool is_spot : {false, true}) {
    ManyTests tests;
    for (const Method& method : methods())
      // Of which the first is in full shadow and the last in none: 0.3 tan 20 deg = 0.109.
      for (const double edge : {-0.12, -0.08, -0.03, 0.0, 0.02, 0.07, 0.1, 0.12}) {
        SceneDescription scene =
            receiver_scene(DiffuseBsdf{glm::vec3(kAlbedo)}, dvec3(-0.9, 0.4, 0.1), 4, seed++);
        scene.shapes.push_back(parallelogram({edge, kEdgeHeight, -9}, {0, 0, 18}, {9, 0, 0}, kBlackBsdf));
        scene.shapes.back().back_bsdf = kBlackBsdf;
        if (is_spot)
          scene.emitters.emplace_back(spot_above());
        else
          scene.emitters.emplace_back(sun_above(2 * kHalfAngle * 180 / kPi));
        scene.integrator = method.integrator;
        scene.sampler.spp = 512;
        TestDevice device = native_device();
        device.samples_per_pass = scene.sampler.spp;
        const statistics::Sample sample = film_sample(render_or_throw(scene, device), 1);
        const double expected = visible_share(edge) * 1.5 * double(kAlbedo) / kPi;
        if (sample.variance() > 0)
          tests.add(statistics::t_test(sample, expected, 1.5 * kRounding), method.name);
        else
          EXPECT_NEAR(sample.mean(), expected, 1.5 * kRounding) << method.name << " " << edge;
      }
    tests.expect_passed(kSignificance);
  }
}

/// One pixel whose view is 60 degrees wide and high, above a mirror.
SceneDescription wide_view(const dvec3& target) {
  SceneDescription scene = empty_scene(1, 1, 20'000, 3);
  scene.camera = look_at(dvec3(0, 1, 0), target, dvec3(0, 0, 1), 60);
  scene.bsdfs.push_back({"mirror", ConductorBsdf{}});
  scene.shapes.push_back(parallelogram({-50, 0, -50}, {0, 0, 100}, {100, 0, 0}, 0));
  return scene;
}

statistics::Sample pixel(const SceneDescription& scene) {
  TestDevice device = native_device();
  device.samples_per_pass = kMaxSamplesPerUnit;
  return pixel_sample(render_or_throw(scene, device), 0, 0, 1);
}

TEST(Suns, AreSeenAsDisksByTheCameraAndInMirrors) {
  const double half_view = std::tan(kPi / 6), radius = std::tan(kHalfAngle);
  const double radiance = 1.5 / (kPi * std::pow(std::sin(kHalfAngle), 2));
  const double expected = radiance * kPi * radius * radius / (4 * half_view * half_view);
  for (const Method& method : methods())
    for (const bool in_mirror : {false, true})
      for (const bool hidden : {false, true}) {
        if (method.name == "direct" && in_mirror)
          continue;  // it samples no lights but those of its first hits
        SceneDescription scene = wide_view(dvec3(0, in_mirror ? 0 : 2, 0));
        DirectionalLight sun = sun_above(2 * kHalfAngle * 180 / kPi);
        sun.seen_by_camera = !hidden;
        scene.emitters.emplace_back(sun);
        scene.integrator = method.integrator;
        const statistics::Sample sample = pixel(scene);
        if (hidden && !in_mirror)
          EXPECT_EQ(sample.mean(), 0) << method.name;
        else
          EXPECT_GT(statistics::t_test(sample, expected, kRounding * expected).p, kSignificance / 16)
              << method.name << ": " << sample.mean() << " instead of " << expected;
      }
}

/// Two suns of half the sky are a sky of radiance 1, in which a white ball is not to be seen.
TEST(Suns, OfTheWholeSkyAreAFurnace) {
  for (const DirectSampling sampling :
       {DirectSampling::kMis, DirectSampling::kEmitterOnly, DirectSampling::kBsdfOnly}) {
    SceneDescription scene = empty_scene(1, 1, 40'000, 5);
    scene.camera = look_at(dvec3(0, 0.2, -3), dvec3(0), dvec3(0, 1, 0), 50);
    Shape ball;
    ball.geometry = Sphere{dvec3(0), 1};
    ball.front_bsdf = add_diffuse(scene, 1);
    scene.shapes.push_back(ball);
    for (const double side : {-1.0, 1.0}) {
      DirectionalLight sun;
      sun.irradiance = glm::vec3(float(kPi));
      sun.direction = side * dvec3(0.3, -0.5, 0.8);
      sun.angle = 180;
      scene.emitters.emplace_back(sun);
    }
    scene.integrator = path_integrator(sampling);
    const statistics::Sample sample = pixel(scene);
    EXPECT_GT(statistics::t_test(sample, 1, kRounding).p, kSignificance / 3) << sample.mean();
  }
}

/// Through a plate of glass, which shadow rays to the sun pass, as directions find it.
TEST(Suns, ShineThroughFlatGlass) {
  std::vector<statistics::Sample> samples;
  for (const DirectSampling sampling : {DirectSampling::kMis, DirectSampling::kBsdfOnly}) {
    SceneDescription scene = empty_scene(1, 1, 200'000, 7);
    scene.camera = look_at(dvec3(0, 0.5, 0), dvec3(0), dvec3(0, 0, 1), 1e-5);
    scene.shapes.push_back(parallelogram({-9, 0, -9}, {0, 0, 18}, {18, 0, 0}, add_diffuse(scene, kAlbedo)));
    DielectricBsdf glass;
    scene.bsdfs.push_back({"glass", glass});
    scene.bsdfs.push_back({"glass from inside", glass.other_side()});
    for (const double height : {1.0, 1.2}) {
      const bool top = height > 1.1;
      scene.shapes.push_back(parallelogram({-99, height, -99}, top ? dvec3(0, 0, 198) : dvec3(198, 0, 0),
                                           top ? dvec3(198, 0, 0) : dvec3(0, 0, 198), 1));
      scene.shapes.back().back_bsdf = 2;
    }
    DirectionalLight sun = sun_above(30);
    sun.direction = dvec3(0.4, -1, 0.1);
    scene.emitters.emplace_back(sun);
    scene.integrator = path_integrator(sampling);
    samples.push_back(pixel(scene));
  }
  EXPECT_GT(statistics::welch_t_test(samples[0], samples[1]).p, kSignificance)
      << samples[0].mean() << " and " << samples[1].mean();
  EXPECT_LT(samples[0].variance(), samples[1].variance());
}

/// A square at height 2 that shines up to the camera, marked or not, and one that no mark hides.
TEST(HiddenLamps, AreSeenInMirrorsAndNotByTheCamera) {
  for (const Method& method : methods()) {
    SceneDescription scene = wide_view(dvec3(0));
    scene.bsdfs.push_back({"nothing", NullBsdf{}});
    // It fills the view, from above as from below.
    scene.shapes.push_back(parallelogram({-9, 0.5, -9}, {0, 0, 18}, {18, 0, 0}, 1, 3.0f));
    scene.shapes.back().back_bsdf = 1;
    scene.integrator = method.integrator;
    EXPECT_EQ(pixel(scene).mean(), 3) << method.name;
    scene.shapes.back().camera_sees_emission = false;
    EXPECT_EQ(pixel(scene).mean(), 0) << method.name;
    if (method.name == "direct") continue;
    // Down, to the mirror.
    scene.shapes.back() = parallelogram({-9, 0.5, -9}, {18, 0, 0}, {0, 0, 18}, 1, 3.0f);
    scene.shapes.back().back_bsdf = 1;
    scene.shapes.back().camera_sees_emission = false;
    EXPECT_NEAR(pixel(scene).mean(), 3, 3 * kRounding) << method.name;
  }
}

TEST(HiddenLamps, LeaveOtherLightsVisible) {
  SceneDescription scene = wide_view(dvec3(0));
  scene.shapes.push_back(parallelogram({-9, 0.5, -9}, {0, 0, 18}, {18, 0, 0}, kBlackBsdf, 3.0f));
  Shape hidden;
  hidden.geometry = Sphere{dvec3(0, 9, 0), 0.5};
  hidden.radiance = glm::vec3(1);
  hidden.camera_sees_emission = false;
  scene.shapes.push_back(hidden);
  for (const Method& method : methods()) {
    scene.integrator = method.integrator;
    EXPECT_EQ(pixel(scene).mean(), 3) << method.name;
  }
}

}  // namespace
}  // namespace penumbra::lamps_test
