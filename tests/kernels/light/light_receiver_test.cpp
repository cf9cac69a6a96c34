// Receivers without a normal, such as points in a medium: light of every kind reaches them from all
// directions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tests/kernels/light_scenes.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::light_receiver_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSignificance = 0.01;
constexpr int kSamples = 100'000;

const vec3 kHere = make_vec3(0.3f, -0.2f, 0.1f);
constexpr auto kLightRadiance = 2.0;  // of the second channel, see light_scenes.h

double solid_angle_of(const SceneTables& tables) {
  const Light& light = tables.lights[0];
  const Exact3 here = exact(kHere);
  return exact_solid_angle(exact(light.p0) - here, exact(light.p1) - here, exact(light.p2) - here);
}

/// Of a rectangle: of both its triangles.
double rectangle_solid_angle(const SceneTables& tables) {
  const Light& light = tables.lights[0];
  const Exact3 here = exact(kHere), p0 = exact(light.p0) - here, p1 = exact(light.p1) - here,
               p2 = exact(light.p2) - here;
  return exact_solid_angle(p0, p1, p2) + exact_solid_angle(p1, p1 + p2 - p0, p2);
}

/// Of a disk, by quadrature over rings and turns.
double disk_solid_angle(const SceneTables& tables) {
  constexpr int kSteps = 400;
  const Light& light = tables.lights[0];
  const Exact3 normal = exact(light.p1);
  const Exact3 s = normalize(cross(normal, Exact3{0.6L, 0.8L, 0})), t = cross(normal, s);
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int k = 0; k < kSteps; ++k) {
      const double r = double(light.p2.x) * (i + 0.5) / kSteps, angle = 2 * kPi * (k + 0.5) / kSteps;
      const Exact3 at = exact(light.p0) + (r * std::cos(angle)) * s + (r * std::sin(angle)) * t;
      const Exact3 way = at - exact(kHere);
      const double cosine = -double(dot(way, normal) / length(way));
      sum += std::max(cosine, 0.0) * r / double(dot(way, way));
    }
  return sum * (double(light.p2.x) / kSteps) * (2 * kPi / kSteps);
}

struct MediumCase {
  std::string name;
  SceneTables tables;
  double expected;  ///< radiance over all directions, a channel whose lights emit kLightRadiance
};

std::vector<MediumCase> medium_cases() {
  const vec3 a = make_vec3(-1, -1, 1.5f), b = make_vec3(0, 1.5f, 2), c = make_vec3(1.5f, -1, 1);
  const vec3 behind = make_vec3(-2, 0.5f, -1);
  std::vector<MediumCase> cases;
  const auto add = [&](const char* name, const SceneTables& tables, double solid_angle) {
    cases.push_back({name, tables, kLightRadiance * solid_angle});
  };
  for (const bool by_solid_angle : {false, true}) {
    const SceneTables triangle = triangle_light(a, b, c, by_solid_angle);
    add(by_solid_angle ? "TriangleBySolidAngle" : "TriangleByArea", triangle, solid_angle_of(triangle));
    const double ratio2 = 0.49 / double(dot(exact(behind) - exact(kHere), exact(behind) - exact(kHere)));
    add(by_solid_angle ? "SphereByCone" : "SphereByArea", sphere_light(behind, 0.7f, 1, by_solid_angle),
        2 * kPi * (1 - std::sqrt(1 - ratio2)));
  }
  SceneTables projected = triangle_light(a, b, c, false);
  projected.header.features = FEATURE_PROJECTED;
  projected.lights[0].sampling = EMITTER_PROJECTED;
  add("TriangleByProjectedSolidAngle", projected, solid_angle_of(projected));
  const SceneTables rectangle =
      rectangle_light(make_vec3(-1, -1, 2), make_vec3(-1, 1, 2), make_vec3(2, -1, 2));
  add("Rectangle", rectangle, rectangle_solid_angle(rectangle));
  add("SphereFromInside", sphere_light(make_vec3(0, 0.5f, 0), 2, -1, true), 4 * kPi);
  const SceneTables disk = disk_light(make_vec3(0, 1, 1), make_vec3(0, -0.6f, -0.8f), 1.2f);
  add("Disk", disk, disk_solid_angle(disk));
  add("Environment", environment_light(), 4 * kPi);
  const SceneTables point = point_light(make_vec3(0, 3, -1));
  const Exact3 way = exact(point.lights[0].p0) - exact(kHere);
  add("Point", point, 1 / double(dot(way, way)));
  return cases;
}

/// By name: the cases themselves take a quadrature, which a list of all tests need not wait for.
constexpr const char* kMediumCases[] = {"TriangleBySolidAngle",
                                        "TriangleByArea",
                                        "SphereByCone",
                                        "SphereByArea",
                                        "TriangleByProjectedSolidAngle",
                                        "Rectangle",
                                        "SphereFromInside",
                                        "Disk",
                                        "Environment",
                                        "Point"};

MediumCase medium_case(std::string_view name) {
  for (MediumCase& each : medium_cases())
    if (each.name == name) return each;
  throw std::out_of_range(std::string(name));
}

class InMedium : public testing::TestWithParam<const char*> {
 protected:
  const MediumCase case_ = medium_case(GetParam());
  SceneTables tables_ = case_.tables;
};
INSTANTIATE_TEST_SUITE_P(All, InMedium, testing::ValuesIn(kMediumCases),
                         [](const auto& tested) { return std::string(tested.param); });

TEST(InMediumCases, AreAllTested) {
  EXPECT_EQ(medium_cases().size(), std::size(kMediumCases));
  for (const MediumCase& each : medium_cases())
    EXPECT_NE(std::ranges::find(kMediumCases, each.name), std::end(kMediumCases)) << each.name;
}

TEST_P(InMedium, LightArrivesFromAllDirections) {
  const Scene scene = tables_.scene();
  const Surface r = surface_in_medium(kHere);
  RandomNumbers random(1);
  statistics::Sample arriving;
  for (int i = 0; i < kSamples; ++i) {
    const float u = random.unit_float(), v = random.unit_float();
    const LightSample light = sample_light(scene, r, u, v, random.unit_float());
    arriving.add(light.tmax > 0 ? double(light.radiance.y) / double(light.pdf) : 0);
  }
  const double expected = case_.expected;
  EXPECT_GT(statistics::t_test(arriving, expected, 1e-5 * expected).p, kSignificance / 10)
      << arriving.mean() << " instead of " << expected;
}

TEST_P(InMedium, ShadowRaysStartAtThePoint) {
  const Scene scene = tables_.scene();
  RandomNumbers random(2);
  for (int i = 0; i < 1000; ++i) {
    const float u = random.unit_float(), v = random.unit_float();
    const LightSample light = sample_light(scene, surface_in_medium(kHere), u, v, random.unit_float());
    ASSERT_TRUE(light.origin.x == kHere.x && light.origin.y == kHere.y && light.origin.z == kHere.z);
    ASSERT_TRUE(light.toward.x == light.wi.x && light.toward.y == light.wi.y && light.toward.z == light.wi.z);
  }
}

/// Those whose lights rays meet: not a point, and not a rectangle by itself.
class FoundFromMedium : public InMedium {};
INSTANTIATE_TEST_SUITE_P(All, FoundFromMedium,
                         testing::Values("TriangleBySolidAngle", "TriangleByArea", "SphereByCone",
                                         "SphereByArea", "TriangleByProjectedSolidAngle", "SphereFromInside",
                                         "Disk", "Environment"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST_P(FoundFromMedium, DensityOfASampleIsThatOfTheLightFound) {
  const Scene scene = tables_.scene();
  const int kind = tables_.lights[0].kind;
  RandomNumbers random(3);
  int compared = 0;
  for (int i = 0; i < 1000; ++i) {
    const float u = random.unit_float(), v = random.unit_float();
    const LightSample light = sample_light(scene, surface_in_medium(kHere), u, v, random.unit_float());
    if (!(light.tmax > 0)) continue;
    const Surface found = surface_at(&scene, kind == LIGHT_ENVIRONMENT ? -1 : 0, kHere, light.wi);
    const bool is_rim = !(found.distance > 0) || !found.front || dot3(found.geometric, found.wo) < 0.3f;
    if (kind != LIGHT_ENVIRONMENT && is_rim) continue;  // where rounding may miss it
    const Emission emission = emission_at(scene, found);
    ASSERT_EQ(emission.radiance.y, kLightRadiance);
    ASSERT_NEAR(light.pdf / emission.pdf, 1, 2e-4);
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

TEST(MediumReceiver, DirectionsAreUniformInACone) {
  constexpr int kSide = 16;
  const vec3 center = make_vec3(0, 0, 3);
  SceneTables tables = sphere_light(center, 1, 1, true);
  const Scene scene = tables.scene();
  const Surface r = surface_in_medium(make_vec3(0, 0, 0));
  const double versine = 1 - std::sqrt(1 - 1.0 / 9);
  std::vector<double> counts(kSide * kSide);
  RandomNumbers random(4);
  for (int i = 0; i < kSamples; ++i) {
    const float u = random.unit_float(), v = random.unit_float();
    const Exact3 d = exact(sample_light(scene, r, u, v, random.unit_float()).wi);
    const double up = double(d.x * d.x + d.y * d.y) / (1 + double(d.z)) / versine;
    const double turn = double(std::atan2(d.y, d.x)) / (2 * kPi) + 0.5;
    const auto cell = [](double x) { return std::size_t(std::clamp(x, 0.0, 1 - 1e-12) * kSide); };
    ++counts[cell(up) * kSide + cell(turn)];
  }
  const std::vector<double> expected(counts.size(), kSamples / double(counts.size()));
  EXPECT_GT(statistics::chi_square_test(counts, expected).p, kSignificance);
}

TEST(MediumReceiver, NoDirectionIsSampledByProjectedSolidAngle) {
  SceneTables tables = triangle_light(make_vec3(-1, -1, 1), make_vec3(0, 1, 1), make_vec3(1, -1, 1), false);
  tables.lights[0].sampling = EMITTER_PROJECTED;
  LightSamplings samplings;
  clear_light_samplings(&samplings);
  const vec3 up = make_vec3(0, 0, 1), here = make_vec3(0, 0, 0);
  sample_projected_light(tables.lights[0], receiver_of(receiver(here, up)), 0.5f, 0.3f, 0.6f, &samplings, 0);
  EXPECT_GT(load_light_sampling(&samplings, 0).scale, 0);
  sample_projected_light(tables.lights[0], receiver_of(surface_in_medium(here)), 0.5f, 0.3f, 0.6f, &samplings,
                         0);
  EXPECT_LT(load_light_sampling(&samplings, 0).scale, 0);
}

TEST(LightReceiver, OfASurfaceIsWhereItIs) {
  SceneTables tables = triangle_light(make_vec3(-1, -1, 0), make_vec3(1, -1, 0), make_vec3(0, 1, 0), false);
  const Scene scene = tables.scene();
  const Surface s = surface_at(&scene, 0, make_vec3(0, 0, -2), make_vec3(0, 0, 1));
  const LightReceiver r = receiver_of(s);
  EXPECT_TRUE(r.has_normal);
  EXPECT_FALSE(r.front);
  EXPECT_EQ(r.light, 0);
  EXPECT_EQ(r.geometric.z, -1);
  EXPECT_EQ(r.error, s.error);
  EXPECT_TRUE(is_own_light(&scene, r, 0));
  EXPECT_FALSE(is_own_light(&scene, receiver_of(surface_in_medium(s.p)), 0));
}

/// Lanes whose lights are of different kinds do not disturb each other.
TEST(LightLanes, OfSeveralKindsAreThoseOfEachByItself) {
  const SceneTables kinds[] = {
      triangle_light(make_vec3(-1, -1, 2), make_vec3(0, 1, 2), make_vec3(1, -1, 2), true),
      rectangle_light(make_vec3(-1, -1, 2), make_vec3(-1, 1, 2), make_vec3(2, -1, 2)),
      sphere_light(make_vec3(0, 3, 0), 1, 1, true),
      disk_light(make_vec3(3, 0, 0), make_vec3(-1, 0, 0), 1),
      point_light(make_vec3(0, 0, -3)),
      environment_light()};
  SceneTables all;
  all.header.features = FEATURE_SOLID_ANGLE;
  all.header.environment = 5;
  for (const SceneTables& one : kinds) all.lights.push_back(one.lights[0]);
  const int count = int(all.lights.size());
  for (int k = 0; k < count; ++k) all.lights[std::size_t(k)].pmf = 1 / float(count);
  const Scene scene = all.scene();
  const Surface r = surface_in_medium(kHere);
  for (int k = 0; k < count; ++k) {
    Surfaces receivers;
    LightSamples samples;
    LightSamplings samplings;
    float u[LANES], v[LANES];
    for (int j = 0; j < LANES; ++j) {
      LightSampling sampling = no_light_sampling();
      sampling.light = (k + j) % count;
      sampling.pmf = 1;
      store_light_sampling(&samplings, j, sampling);
      store_surface(&receivers, j, r);
      u[j] = 0.37f, v[j] = 0.81f;
    }
    sample_lights(&scene, &receivers, u, v, v, &samplings, &samples);
    for (int j = 0; j < LANES; ++j) {
      SceneTables alone = kinds[(k + j) % count];
      const LightSample expected = sample_light(alone.scene(), r, 0.37f, 0.81f, 0);
      const LightSample light = load_light_sample(&samples, j);
      EXPECT_EQ(light.light, (k + j) % count);
      EXPECT_EQ(light.tmax, expected.tmax);
      EXPECT_EQ(light.delta, expected.delta);
      EXPECT_EQ(light.wi.x, expected.wi.x);
      EXPECT_NEAR(light.pdf / expected.pdf, 1, 1e-6);
      EXPECT_EQ(light.radiance.z, expected.radiance.z);
    }
  }
}

TEST(LightLanes, AKindThatTheSceneDoesNotNameGivesNothing) {
  SceneTables tables = environment_light();
  Scene scene = tables.scene();
  scene.header.light_kinds = 0;
  EXPECT_LT(sample_light(scene, surface_in_medium(kHere), 0.5f, 0.5f, 0).tmax, 0);
  const Surface nothing = surface_at(&scene, -1, kHere, make_vec3(0, 0, 1));
  EXPECT_EQ(emission_at(scene, nothing).radiance.y, 0);
}

}  // namespace
}  // namespace penumbra::light_receiver_test
