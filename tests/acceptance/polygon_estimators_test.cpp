// Unshadowed polygon lights: the closed form, every sampling method and the choice of lights agree with
// Lambert's sum in double, or with quadrature, at any scale and position of the scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/shadowed_polygon.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra::polygon_estimators_test {
namespace {

using glm::dvec3;

constexpr double kSignificance = 0.01;
constexpr double kRounding = 32.0 / (1 << 24);  ///< relative; see furnace_test.cpp
const dvec3 kViewer(0.004, 0.01, -0.002);

struct ColouredLight {
  PolygonPoints corners;  ///< counter-clockwise from the front
  glm::vec3 radiance{1};
  bool two_sided = false;
  bool is_star = false;  ///< the first corner is the middle of a fan about it, no corner of the outline
};

/// Five spikes, not convex, above and beside the origin, facing it.
ColouredLight star() {
  const dvec3 middle(0.4, 1.2, -0.3), normal = -glm::normalize(middle);
  const dvec3 u = glm::normalize(glm::cross(normal, dvec3(1, 0, 0))), v = glm::cross(normal, u);
  ColouredLight light{{middle}, glm::vec3(2, 1, 0.5f), false, true};
  for (int k = 0; k < 10; ++k) {
    const double angle = k * std::numbers::pi / 5, radius = k % 2 == 0 ? 0.8 : 0.3;
    light.corners.push_back(middle + radius * (std::cos(angle) * u + std::sin(angle) * v));
  }
  return light;
}

Shape shape_of(const ColouredLight& light) {
  Mesh mesh;
  mesh.positions = light.corners;
  const auto count = unsigned(light.corners.size());
  for (unsigned k = 1; k + 1 < count; ++k) mesh.triangles.emplace_back(0, k, k + 1);
  if (light.is_star) mesh.triangles.emplace_back(0, count - 1, 1);
  Shape shape;
  shape.name = "light";
  shape.geometry = std::move(mesh);
  shape.radiance = light.radiance;
  shape.two_sided_emission = light.two_sided;
  return shape;
}

/// The parts of the light as convex polygons that face the origin.
std::vector<PolygonPoints> facing_parts(const ColouredLight& light) {
  std::vector<PolygonPoints> parts;
  if (light.is_star) {
    for (std::size_t k = 1; k < light.corners.size(); ++k)
      parts.push_back(
          {light.corners[0], light.corners[k], light.corners[k + 1 < light.corners.size() ? k + 1 : 1]});
  } else {
    parts.push_back(light.corners);
  }
  std::vector<PolygonPoints> result;
  for (PolygonPoints& part : parts) {
    const bool front = glm::dot(glm::cross(part[1] - part[0], part[2] - part[0]), part[0]) < 0;
    if (!front && !light.two_sided) continue;
    if (!front) std::ranges::reverse(part);
    result.push_back(std::move(part));
  }
  return result;
}

double truth(const std::vector<ColouredLight>& lights, const BsdfModel& bsdf, int channel) {
  double sum = 0;
  for (const ColouredLight& light : lights)
    for (const PolygonPoints& part : facing_parts(light))
      sum += light.radiance[channel] * (std::holds_alternative<DiffuseBsdf>(bsdf)
                                            ? std::get<DiffuseBsdf>(bsdf).reflectance.value.y /
                                                  std::numbers::pi * projected_solid_angle(part)
                                            : reflected_radiance(part, bsdf, kViewer));
  return sum;
}

SceneDescription scene_of(const std::vector<ColouredLight>& lights, const BsdfModel& bsdf, int pixels,
                          std::uint32_t seed) {
  SceneDescription scene = receiver_scene(bsdf, kViewer, pixels, seed);
  for (const ColouredLight& light : lights) scene.shapes.push_back(shape_of(light));
  return scene;
}

struct UnshadowedCase {
  std::string name;
  std::vector<ColouredLight> lights;
  BsdfModel bsdf = DiffuseBsdf{glm::vec3(0.5f)};
};

void PrintTo(const UnshadowedCase& tested, std::ostream* out) { *out << tested.name; }

const ColouredLight kTriangle{{{-1, 1.5, 0.5}, {-0.5, 1, -1}, {0.75, 1.25, 0.25}}, glm::vec3(1, 0.5f, 2)};
const ColouredLight kSquare{{{0.5, 0.75, 0.25}, {0.5, 0.75, -0.5}, {1.25, 0.75, -0.5}, {1.25, 0.75, 0.25}}};
const ColouredLight kLeaning{{{-1, -0.5, 1}, {-1, -0.75, -1}, {-0.875, 0.5, -1}, {-0.875, 0.75, 1}}};

ColouredLight coloured(ColouredLight light, glm::vec3 radiance) {
  light.radiance = radiance;
  return light;
}
/// Its back to the origin.
ColouredLight turned(ColouredLight light, bool two_sided) {
  std::ranges::reverse(light.corners);
  light.two_sided = two_sided;
  return light;
}

std::vector<UnshadowedCase> unshadowed_cases() {
  const PhongBsdf glossy{glm::vec3(0.2f), glm::vec3(0.6f), 20};
  const std::vector<ColouredLight> several{kTriangle, coloured(kSquare, {0.1f, 3, 0}),
                                           turned(coloured(kLeaning, {1, 1, 0}), true)};
  return {{"Triangle", {kTriangle}},
          {"Square", {kSquare}},
          {"Star", {star()}},
          {"AcrossTheHorizon", {kLeaning}},
          {"TwoSidedFromBehind", {turned(kTriangle, true)}},
          {"TwoSidedFromTheFront", {[] {
             ColouredLight light = kSquare;
             light.two_sided = true;
             return light;
           }()}},
          {"Several", several},
          {"PhongTriangle", {kTriangle}, glossy},
          {"PhongStar", {star()}, glossy},
          {"PhongSeveral", several, glossy},
          {"PhongShiny", {kTriangle, kSquare}, PhongBsdf{glm::vec3(0.2f), glm::vec3(0.6f), 300}}};
}

class Unshadowed : public testing::TestWithParam<UnshadowedCase> {};

TEST_P(Unshadowed, ClosedFormIsExact) {
  const auto& [name, lights, bsdf] = GetParam();
  SceneDescription scene = scene_of(lights, bsdf, 4, 1);
  use(scene.integrator, IntegratorKind::kPolygonAnalytic);
  for (int c = 0; c < 3; ++c) {
    const double expected = truth(lights, bsdf, c);
    const statistics::Sample sample = pass_means(scene, 2, c);
    EXPECT_NEAR(sample.mean(), expected, kRounding * expected);
    EXPECT_LT(std::sqrt(sample.variance()), 1e-6 * expected + 1e-30);
  }
}

TEST_P(Unshadowed, EverySamplingHasItsMean) {
  const auto& [name, lights, bsdf] = GetParam();
  const double expected = truth(lights, bsdf, 1);
  ManyTests tests;
  std::uint32_t seed = 1;
  const auto check = [&](const IntegratorSettings& integrator, const std::string& what) {
    // Highlights of exponent 300 fill a hundredth of the lights.
    SceneDescription scene = scene_of(lights, bsdf, 128, seed++);
    scene.integrator = integrator;
    param::trace_shadows(scene.integrator) = false;
    tests.add(statistics::t_test(pass_means(scene, 4), expected, kRounding * expected), what);
  };
  using enum EmitterSampling;
  for (EmitterSampling sampling : {kArea, kSolidAngle, kProjected}) {
    const std::string by = " by sampling " + std::to_string(int(sampling));
    for (LightChoice choice : {LightChoice::kPower, LightChoice::kAnalytic}) {
      check(emitter_only(sampling, 1, choice), "emitter samples" + by);
      IntegratorSettings area = emitter_only(sampling, 2, choice);
      use(area, IntegratorKind::kPolygonArea);
      check(area, "polygon_area" + by);
    }
    IntegratorSettings mis = direct_integrator(1, 1);
    param::emitter_sampling(mis) = sampling;
    check(mis, "MIS" + by);
  }
  check(direct_integrator(0, 1), "BSDF samples");
  tests.expect_passed(kSignificance);
}

TEST_P(Unshadowed, PolygonAreaWithoutShadowsIgnoresOccluders) {
  const auto& [name, lights, bsdf] = GetParam();
  SceneDescription scene = scene_of(lights, bsdf, 64, 1);
  // A roof, and a wall to its left where a light goes down to the horizon.
  scene.shapes.push_back(parallelogram({-3, 0.05, -3}, {6, 0, 0}, {0, 0, 6}, kBlackBsdf));
  scene.shapes.push_back(parallelogram({-0.5, -0.1, -3}, {0, 0.2, 0}, {0, 0, 6}, kBlackBsdf));
  scene.integrator = emitter_only(EmitterSampling::kArea, 16);
  use(scene.integrator, IntegratorKind::kPolygonArea);
  EXPECT_EQ(pass_means(scene, 4).mean(), 0);
  param::trace_shadows(scene.integrator) = false;
  const double expected = truth(lights, bsdf, 1);
  const statistics::Sample sample = pass_means(scene, 4);
  EXPECT_GT(statistics::t_test(sample, expected, kRounding * expected).p, kSignificance)
      << sample.mean() << " +- " << sample.standard_error() << ", exactly " << expected;
  use(scene.integrator, IntegratorKind::kPolygonAnalytic);
  EXPECT_NEAR(pass_means(scene, 1).mean(), expected, kRounding * expected);
}

INSTANTIATE_TEST_SUITE_P(Cases, Unshadowed, testing::ValuesIn(unshadowed_cases()),
                         [](const auto& tested) { return tested.param.name; });

TEST(OneSided, FromBehindIsDark) {
  for (auto kind : {IntegratorKind::kPolygonAnalytic, IntegratorKind::kPolygonCv, IntegratorKind::kDirect}) {
    SceneDescription scene = scene_of({turned(kTriangle, false)}, DiffuseBsdf{}, 4, 1);
    use(scene.integrator, kind);
    EXPECT_EQ(pass_means(scene, 4).mean(), 0);
  }
}

// --- the choice of one of many lights

/// Five lights of one colour whose areas differ by a factor of 10^4: most power is far away or turned away.
std::vector<ColouredLight> unequal_lights() {
  const auto square = [](dvec3 center, dvec3 u, dvec3 v, float radiance) {
    return ColouredLight{{center, center + u, center + u + v, center + v}, glm::vec3(radiance)};
  };
  // All face down or towards the origin.
  return {square({-10, 12, -10}, {20, 0, 0}, {0, 0, 20}, 0.1f),
          square({-0.3, 0.6, 0.1}, {0.1, 0, 0}, {0, 0, 0.1}, 5),
          square({0.5, 0.7, -0.4}, {0.2, 0, 0}, {0, 0, 0.3}, 3),
          square({1.2, 0.1, -0.5}, {0, 0, 1}, {0, 1, 0}, 0.5f),
          square({-8, 0.2, 3}, {0, 4, 0}, {0, 0, 4}, 1)};
}

TEST(LightChoice, ByContributionHasLessNoiseAndTheSameMean) {
  const std::vector<ColouredLight> lights = unequal_lights();
  for (const BsdfModel& bsdf : {BsdfModel(DiffuseBsdf{glm::vec3(0.5f)}),
                                BsdfModel(PhongBsdf{glm::vec3(0.2f), glm::vec3(0.5f), 15})}) {
    const double expected = truth(lights, bsdf, 1);
    std::uint32_t seed = 1;
    ManyTests tests;
    for (EmitterSampling sampling :
         {EmitterSampling::kArea, EmitterSampling::kSolidAngle, EmitterSampling::kProjected}) {
      SceneDescription scene = scene_of(lights, bsdf, 256, seed++);
      scene.integrator = emitter_only(sampling, 1, LightChoice::kPower);
      param::trace_shadows(scene.integrator) = false;  // some lights are in front of others
      const statistics::Sample by_power = pass_means(scene, 1);
      param::light_choice(scene.integrator) = LightChoice::kAnalytic;
      scene.sampler.seed = seed++;
      const statistics::Sample by_contribution = pass_means(scene, 1);
      tests.add(statistics::t_test(by_power, expected, kRounding * expected), "by power");
      tests.add(statistics::t_test(by_contribution, expected, kRounding * expected), "by contribution");
      EXPECT_LT(by_contribution.variance(), 0.5 * by_power.variance());
    }
    tests.expect_passed(kSignificance);
  }
}

TEST(LightChoice, OtherLightsHaveTheirShare) {
  // Next to polygons a sphere, a disk, a point and a sky: chosen by rough bounds, which no mean depends on.
  std::vector<ColouredLight> lights{kTriangle, coloured(kSquare, glm::vec3(2))};
  SceneDescription scene = scene_of(lights, PhongBsdf{glm::vec3(0.4f), glm::vec3(0.3f), 12}, 192, 1);
  Shape sphere, disk;
  sphere.geometry = Sphere{{-1.5, 0.5, -1.5}, 0.25};
  disk.geometry = Disk{{1, 1.5, 1.5}, glm::normalize(dvec3(-1, -1, -1)), 0.5};
  sphere.radiance = disk.radiance = glm::vec3(3);
  scene.shapes.push_back(sphere);
  scene.shapes.push_back(disk);
  scene.emitters.emplace_back(PointLight{{0.2, 0.6, -0.8}, glm::vec3(0.2f)});
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(0.3f)});
  ManyTests tests;
  scene.integrator = emitter_only(EmitterSampling::kArea, 4, LightChoice::kPower);
  const statistics::Sample by_power = pass_means(scene, 4);
  for (EmitterSampling sampling :
       {EmitterSampling::kArea, EmitterSampling::kSolidAngle, EmitterSampling::kProjected}) {
    ++scene.sampler.seed;
    scene.integrator = emitter_only(sampling, 4, LightChoice::kAnalytic);
    const statistics::Sample by_contribution = pass_means(scene, 4);
    tests.add(statistics::welch_t_test(by_contribution, by_power), "by contribution");
    ++scene.sampler.seed;
    scene.integrator = polygon_cv(std::nullopt, sampling, 4);
    tests.add(statistics::welch_t_test(pass_means(scene, 4), by_power), "polygon_cv");
  }
  tests.expect_passed(kSignificance);
}

// --- scale and place

TEST(Invariance, ClosedFormDoesNotDependOnScaleOrPlace) {
  // Corners round to 2^-24 of the scene's extent, 4; the nearest is at 0.6, so directions are off by 4e-7 at
  // most, and so is the form by a few times that.
  constexpr double kTolerance = 4e-6;
  const PhongBsdf glossy{glm::vec3(0.2f), glm::vec3(0.6f), 20};
  const std::vector<ColouredLight> lights{kTriangle, kSquare};
  for (const BsdfModel& bsdf : {BsdfModel(DiffuseBsdf{glm::vec3(0.5f)}), BsdfModel(glossy)}) {
    const double expected = truth(lights, bsdf, 1);
    for (double scale : {1e-4, 1e-3, 1e-2, 1.0, 1e2, 1e4, 1e5})
      for (double shift : {0.0, 1e3, 1e4, 1e5, 1e6}) {
        SceneDescription scene = scene_of(lights, bsdf, 2, 1);
        const dvec3 by = shift * scale * dvec3(1, -0.7, 0.3);
        for (Shape& shape : scene.shapes)
          for (dvec3& p : std::get<Mesh>(shape.geometry).positions) p = scale * p + by;
        scene.camera = look_at(scale * kViewer + by, by, dvec3(0, 0, 1), 1e-6);
        scene.camera.near_clip = 1e-4 * scale;
        scene.camera.far_clip = 1e4 * scale;
        for (IntegratorSettings integrator : {polygon_cv(1.0f, EmitterSampling::kProjected, 4),
                                              polygon_cv(1.0f, EmitterSampling::kArea, 4)}) {
          scene.integrator = integrator;
          EXPECT_NEAR(pass_means(scene, 4).mean(), expected, kTolerance * expected)
              << "scale " << scale << ", shift " << shift;
        }
        use(scene.integrator, IntegratorKind::kPolygonAnalytic);
        EXPECT_NEAR(pass_means(scene, 1).mean(), expected, kTolerance * expected)
            << "scale " << scale << ", shift " << shift;
      }
  }
}

}  // namespace
}  // namespace penumbra::polygon_estimators_test
