// Spot lights, projectors and directional lights: arriving light against formulas in double precision, powers
// against quadrature, and no light outside of the beam.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes/emitters.h"
#include "tests/kernels/light_scenes.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra::beam_light_test {
namespace {

constexpr double kPi = std::numbers::pi;

struct Made {
  SceneTables tables;
  double power;
};

template <typename Model>
Made scene_of(const Model& model) {
  Made made;
  const auto at = [](const glm::dvec3& p) { return to_vec3(p); };
  const EmitterLight light = model.light({at, 2.0, made.tables});
  made.tables.lights.push_back(light.light);
  made.tables.lights[0].pmf = 1;
  made.tables.header.environment = -1;
  made.power = light.power;
  return made;
}

/// A rotation about an axis that is none of space's, and another place.
const glm::dmat4 kPlaced{{0.7827555537, 0.5487988591, -0.2934510708, 0},
                         {-0.4819543958, 0.8328889012, 0.2720588744, 0},
                         {0.3937177658, -0.0715255366, 0.9164444805, 0},
                         {0.4, -1.25, 0.75, 1}};

vec3 local_point(double x, double y, double z) {
  return to_vec3(glm::dvec3(kPlaced * glm::dvec4(x, y, z, 1)));
}

LightSample arriving(const Scene& scene, const vec3& p) {
  return sample_light(scene, surface_in_medium(p), 0.3f, 0.6f, 0.0f);
}

/// In degrees: the shares of the intensity that leave at an angle from the axis.
double expected_share(const SpotLight& spot, double angle) {
  if (angle <= spot.beam_width) return 1;
  if (angle >= spot.cutoff_angle) return 0;
  if (spot.falloff == SpotFalloff::kLinear)
    return (spot.cutoff_angle - angle) / (spot.cutoff_angle - spot.beam_width);
  // 1 - cosines by half angles, for narrow beams.
  const auto versine = [](double a) { return 2 * std::pow(std::sin(a * kPi / 360), 2); };
  const double t =
      (versine(spot.cutoff_angle) - versine(angle)) / (versine(spot.cutoff_angle) - versine(spot.beam_width));
  return spot.falloff == SpotFalloff::kSquared ? t * t : t * t * (3 - 2 * t);
}

constexpr SpotFalloff kFalloffs[] = {SpotFalloff::kLinear, SpotFalloff::kSmoothstep, SpotFalloff::kSquared};

TEST(SpotLight, FallsOffAsItsFormulaSays) {
  for (const SpotFalloff falloff : kFalloffs)
    for (const auto& [cutoff, beam] :
         {std::pair{20.0, 15.0}, {75.0, 0.0}, {1e-3, 5e-4}, {120.0, 100.0}, {180.0, 90.0}}) {
      SpotLight spot;
      spot.intensity = glm::vec3(3, 6, 9);
      spot.cutoff_angle = cutoff;
      spot.beam_width = beam;
      spot.falloff = falloff;
      Made made = scene_of(spot);  // at the origin: positions of narrow beams are not rounded
      const Scene scene = made.tables.scene();
      for (int k = 0; k <= 60; ++k) {
        const double angle = std::min(1.2 * cutoff * k / 60, 179.9), turn = 0.7 + k;
        const double a = angle * kPi / 180, d = 2.5;
        const vec3 p =
            to_vec3(d * glm::dvec3(std::sin(a) * std::cos(turn), std::sin(a) * std::sin(turn), std::cos(a)));
        const LightSample s = arriving(scene, p);
        const double share = expected_share(spot, angle);
        // A few roundings of the angle, over the width of the falloff.
        const double tolerance = 1e-6 * (1 + (cutoff + 1e-3) / (cutoff - beam));
        ASSERT_NEAR(s.radiance.y, 6 * share / (d * d), 6 * tolerance)
            << cutoff << " " << beam << " at " << angle;
        ASSERT_EQ(s.tmax > 0, s.radiance.y > 0);
        ASSERT_TRUE(s.delta && s.pdf == 1);
      }
    }
}

TEST(SpotLight, WithoutATransitionHasAnEdge) {
  for (const SpotFalloff falloff : kFalloffs) {
    SpotLight spot;
    spot.cutoff_angle = spot.beam_width = 30;
    spot.falloff = falloff;
    Made made = scene_of(spot);
    const Scene scene = made.tables.scene();
    const auto at = [&](double degrees) {
      const double a = degrees * kPi / 180;
      return arriving(scene, to_vec3(glm::dvec3(std::sin(a), 0, std::cos(a)))).radiance.x;
    };
    EXPECT_NEAR(at(29.999), 1, 1e-6);
    EXPECT_EQ(at(30.001), 0);
    EXPECT_NEAR(made.power, 2 * kPi * (1 - std::cos(kPi / 6)), 1e-6);
  }
}

TEST(SpotLight, PowerIsTheIntegralOfItsIntensity) {
  for (const SpotFalloff falloff : kFalloffs)
    for (const auto& [cutoff, beam] : {std::pair{20.0, 15.0}, {75.0, 0.0}, {170.0, 60.0}, {0.01, 0.002}}) {
      SpotLight spot;
      spot.cutoff_angle = cutoff;
      spot.beam_width = beam;
      spot.falloff = falloff;
      constexpr int kNodes = 20000;
      double sum = 0;
      for (int k = 0; k < kNodes; ++k) {
        const double angle = cutoff * (k + 0.5) / kNodes;
        sum += expected_share(spot, angle) * std::sin(angle * kPi / 180);
      }
      const double expected = 2 * kPi * sum * cutoff * kPi / 180 / kNodes;
      EXPECT_NEAR(scene_of(spot).power / expected, 1, 1e-5) << cutoff;
    }
}

TEST(ProjectorLight, IlluminatesAPlaneEvenly) {
  ProjectorLight projector;
  projector.irradiance = glm::vec3(0.5f, 1.0f, 1.5f);
  projector.scale = 2;
  projector.fov = 60;
  projector.to_world = kPlaced;
  Made made = scene_of(projector);
  const Scene scene = made.tables.scene();
  const double edge = std::tan(kPi / 6);
  for (const double z : {0.5, 3.0})
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.9, 0.3}, {-0.7, -0.95}, {0.99, 0.99}}) {
      const LightSample s = arriving(scene, local_point(x * edge * z, y * edge * z, z));
      const double cosine = 1 / std::sqrt(1 + (x * x + y * y) * edge * edge);
      // Irradiance pi times the image at distance 1; of a white surface that is the image.
      EXPECT_NEAR(s.radiance.y * cosine, 2 * kPi / (z * z), 1e-5 / (z * z)) << x << " " << y << " " << z;
      EXPECT_GT(s.tmax, 0);
    }
  EXPECT_LT(arriving(scene, local_point(1.01 * edge, 0, 1)).tmax, 0);
  EXPECT_LT(arriving(scene, local_point(0, -1.01 * edge, 1)).tmax, 0);
  EXPECT_LT(arriving(scene, local_point(0.1, 0.1, -1)).tmax, 0) << "behind it";
  EXPECT_NEAR(made.power, 2 * kPi * 4 * edge * edge, 1e-5);
}

TEST(DirectionalLight, ComesFromBeyondTheScene) {
  DirectionalLight sun;
  sun.irradiance = glm::vec3(1, 2, 3);
  sun.direction = glm::dvec3(0, -3, 4);
  Made made = scene_of(sun);
  const Scene scene = made.tables.scene();
  const LightSample s = arriving(scene, make_vec3(5, -2, 1));
  EXPECT_TRUE(s.delta);
  EXPECT_EQ(s.pdf, 1);
  EXPECT_EQ(s.tmax, NO_LIMIT);
  EXPECT_EQ(s.radiance.y, 2);
  EXPECT_NEAR(s.wi.y, 0.6, 1e-7);
  EXPECT_NEAR(s.wi.z, -0.8, 1e-7);
  EXPECT_NEAR(made.power, 2 * kPi * 4, 1e-5) << "over the scene's sphere";
}

/// Directions are within the disk, and are found with the density with which they are sampled; others are not
/// found. Single precision leaves the chord of a direction an error of some 1e-7.
TEST(DirectionalLight, OfAnAngleIsFoundInTheDirectionsThatItSamples) {
  for (const double angle : {0.02, 0.53, 40.0, 180.0}) {
    DirectionalLight sun;
    sun.direction = glm::dvec3(0.3, -3, 4);
    sun.angle = angle;
    Made made = scene_of(sun);
    made.tables.header.sun_count = 1;
    const Scene scene = made.tables.scene();
    const double half = angle * kPi / 360, radiance = 1 / (kPi * std::pow(std::sin(half), 2));
    const auto at = [&](const vec3& wi) {
      return emission_at(scene, surface_at(&scene, -1, make_vec3(1, 2, 3), wi));
    };
    const glm::dvec3 z = -glm::normalize(sun.direction),
                     x = glm::normalize(glm::cross(z, glm::dvec3(1, 2, 3)));
    RandomNumbers random(4);
    for (int i = 0; i < 200; ++i) {
      const LightSample s = sample_light(scene, surface_in_medium(make_vec3(1, 2, 3)),
                                         0.99f * random.unit_float(), random.unit_float(), 0.0f);
      ASSERT_FALSE(s.delta);
      ASSERT_NEAR(s.pdf * 2 * kPi * 2 * std::pow(std::sin(half / 2), 2), 1, 1e-5);
      ASSERT_NEAR(s.radiance.y / radiance, 1, 1e-5);
      ASSERT_EQ(s.tmax, NO_LIMIT);
      const Emission emission = at(s.wi);
      ASSERT_EQ(emission.radiance.y, s.radiance.y) << angle;
      ASSERT_EQ(emission.pdf, s.pdf);
    }
    for (const double beyond : {1.005, 1.5}) {
      const double a = beyond * half + 3e-7;
      EXPECT_EQ(at(to_vec3(std::cos(a) * z + std::sin(a) * x)).radiance.y, 0) << angle;
      EXPECT_GT(at(to_vec3(std::cos(a / beyond / beyond) * z + std::sin(a / beyond / beyond) * x)).radiance.y,
                0);
    }
  }
}

TEST(DirectionalLight, ThinnerThanSinglePrecisionResolvesIsParallel) {
  DirectionalLight sun;
  sun.angle = 0.0099;
  EXPECT_EQ(scene_of(sun).tables.lights[0].kind, LIGHT_DIRECTIONAL);
}

/// Whatever the radius, the mean over the samples is the irradiance that the formula in round_spot_light.h
/// stands for; points are on the sphere; from inside there are none.
TEST(SpotLight, OfARadiusIsASphere) {
  for (const double radius : {1e-25, 1e-6, 0.3, 0.9}) {
    SpotLight spot;
    spot.radius = radius;
    spot.cutoff_angle = spot.beam_width = 180;
    spot.to_world = kPlaced;
    Made made = scene_of(spot);
    const Scene scene = made.tables.scene();
    EXPECT_NEAR(made.power, 4 * kPi, 1e-5);
    const glm::dvec3 centre(kPlaced[3]);
    const vec3 p = to_vec3(centre + glm::dvec3(0.5, -0.6, 0.62449979984));  // at distance 1
    const double versine = radius * radius / (1 + std::sqrt(1 - radius * radius));
    RandomNumbers random(5);
    for (int i = 0; i < 200; ++i) {
      const LightSample s =
          sample_light(scene, surface_in_medium(p), random.unit_float(), random.unit_float(), 0.0f);
      ASSERT_TRUE(s.delta && s.pdf == 1);
      ASSERT_NEAR(s.radiance.x, 2 / (2 - versine), 1e-5);
      const glm::dvec3 end(double(s.origin.x) + s.tmax * s.toward.x, double(s.origin.y) + s.tmax * s.toward.y,
                           double(s.origin.z) + s.tmax * s.toward.z);
      ASSERT_NEAR(glm::length(end - centre), radius, 1e-5);
    }
    if (radius > 0.1)
      EXPECT_LT(arriving(scene, local_point(0.1 * radius, 0.2 * radius, -0.5 * radius)).tmax, 0);
  }
}

TEST(BeamLights, AreNotFoundByRays) {
  for (const double radius : {0.0, 0.5}) {
    SpotLight spot;
    spot.to_world = kPlaced;
    spot.radius = radius;
    Made made = scene_of(spot);
    const Scene scene = made.tables.scene();
    const Surface nothing = surface_at(&scene, -1, make_vec3(0, 0, 0), make_vec3(0, 0, 1));
    EXPECT_EQ(emission_at(scene, nothing).radiance.y, 0);
  }
}

TEST(BeamLights, AtTheirOwnPointGiveNothing) {
  SpotLight spot;
  ProjectorLight projector;
  Made lights[] = {scene_of(spot), scene_of(projector)};
  for (Made& made : lights) {
    const Scene scene = made.tables.scene();
    EXPECT_LT(arriving(scene, make_vec3(0, 0, 0)).tmax, 0);
  }
}

}  // namespace
}  // namespace penumbra::beam_light_test
