// Light sampling: a sample's pdf is that of its direction, samples are uniform on the light in the stated
// measure, shadow rays end before the light, and the limits of the range are valid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "tests/kernels/light_scenes.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::light_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSignificance = 0.01;

LightSample sample(const Scene& scene, const Surface& r, RandomNumbers& random) {
  const float u = random.unit_float(), v = random.unit_float();
  return sample_light(scene, r, u, v, random.unit_float());
}

/// A light in front of a receiver, both drawn anew by `make` for each seed.
struct LightCase {
  std::string name;
  std::function<SceneTables(RandomNumbers&)> make;
};

void PrintTo(const LightCase& light_case, std::ostream* out) { *out << light_case.name; }

SceneTables random_triangle(RandomNumbers& random, double size, bool by_solid_angle) {
  const Exact3 at = (1.0L + random.uniform()) * random.direction();
  const auto vertex = [&] { return rounded(at + random.point(size)); };
  vec3 a = vertex(), b = vertex(), c = vertex();
  // The receiver is at the origin: towards it.
  if (dot(cross(exact(b) - exact(a), exact(c) - exact(a)), exact(a)) > 0) std::swap(b, c);
  return triangle_light(a, b, c, by_solid_angle);
}

const LightCase kLightCases[] = {
    {"TriangleByArea", [](RandomNumbers& r) { return random_triangle(r, 1, false); }},
    {"SmallTriangleByArea", [](RandomNumbers& r) { return random_triangle(r, 1e-3, false); }},
    {"TriangleBySolidAngle", [](RandomNumbers& r) { return random_triangle(r, 1, true); }},
    {"LargeTriangleBySolidAngle", [](RandomNumbers& r) { return random_triangle(r, 50, true); }},
    {"TriangleTooSmallForSolidAngle", [](RandomNumbers& r) { return random_triangle(r, 1e-3, true); }},
    {"SphereByArea",
     [](RandomNumbers& r) {
       return sphere_light(rounded(2.0L * r.direction()), float(r.between(0.1, 1.9)), 1, false);
     }},
    {"SphereByCone",
     [](RandomNumbers& r) {
       return sphere_light(rounded(2.0L * r.direction()), float(r.between(0.1, 1.9)), 1, true);
     }},
    {"SmallSphereByCone",
     [](RandomNumbers& r) {
       return sphere_light(rounded(20.0L * r.direction()), float(r.between(0.001, 0.1)), 1, true);
     }},
    {"SphereFromInside",
     [](RandomNumbers& r) { return sphere_light(rounded(r.point(1)), float(r.between(2, 5)), -1, true); }},
    {"Disk",
     [](RandomNumbers& r) {
       const Exact3 at = 2.0L * r.direction();
       const Exact3 toward = normalize(r.direction() - 1.5L * normalize(at));
       return disk_light(rounded(at), rounded(toward), float(r.between(0.1, 1.5)));
     }},
    {"Cylinder",
     [](RandomNumbers& r) {
       return cylinder_light(rounded(3.0L * r.direction()), rounded(r.direction()),
                             float(r.between(0.1, 0.8)), float(r.between(0.1, 1.5)), 1);
     }},
    {"CylinderFromInside",
     [](RandomNumbers& r) {
       const Exact3 axis = r.direction();
       return cylinder_light(rounded(r.point(0.3) - 1.5L * axis), rounded(axis), float(r.between(1, 2)), 3,
                             -1);
     }},
};

class Lights : public testing::TestWithParam<LightCase> {};
INSTANTIATE_TEST_SUITE_P(All, Lights, testing::ValuesIn(kLightCases),
                         [](const auto& tested) { return tested.param.name; });

/// How far a point of the light may be moved off it, see POSITION_ERROR.
double light_offset(const SceneTables& tables) {
  const Light& light = tables.lights[0];
  double extent = double(length(exact(light.p0)));
  if (light.kind == LIGHT_TRIANGLE)
    extent = std::max({extent, double(length(exact(light.p1))), double(length(exact(light.p2)))});
  if (light.kind == LIGHT_SPHERE || light.kind == LIGHT_DISK || light.kind == LIGHT_CYLINDER)
    extent += light.p2.x + light.p2.z;
  return std::sqrt(3.0) * POSITION_ERROR * extent;
}

/// Cosine at the light, by its exact normal where the sample ends.
double cosine_at_light(const SceneTables& tables, const LightSample& sample) {
  const Light& light = tables.lights[0];
  const Exact3 end = exact(sample.origin) + (long double)sample.tmax * exact(sample.wi);
  const Exact3 from = end - exact(light.p0), axis = exact(light.p1);
  const Exact3 normal = light.kind == LIGHT_CYLINDER
                            ? (long double)light.p2.y * (from - dot(from, axis) * axis)
                        : light.kind == LIGHT_TRIANGLE
                            ? cross(exact(light.p1) - exact(light.p0), exact(light.p2) - exact(light.p0))
                        : light.kind == LIGHT_DISK ? exact(light.p1)
                                                   : (long double)light.p2.y * (end - exact(light.p0));
  return -double(dot(normalize(normal), exact(sample.wi)));
}

TEST_P(Lights, DensityOfASampleIsThatOfItsDirection) {
  RandomNumbers random(1);
  int compared = 0;
  for (int k = 0; k < 400; ++k) {
    SceneTables tables = GetParam().make(random);
    const Scene scene = tables.scene();
    const int kind = tables.lights[0].kind;
    const bool round = kind == LIGHT_SPHERE || kind == LIGHT_CYLINDER;
    const double curvature = round ? 1 / double(tables.lights[0].p2.x) : 0;
    const vec3 p = rounded(random.point(0.01));
    const Surface s = receiver(p, rounded(random.direction()));
    for (int i = 0; i < 50; ++i) {
      const LightSample light = sample(scene, s, random);
      if (!(light.tmax > 0)) continue;
      ASSERT_TRUE(std::isfinite(light.pdf) && light.pdf > 0);
      ASSERT_NEAR(double(length(exact(light.wi))), 1, 4e-7);
      const Surface found = surface_at(&scene, 0, light.origin, light.wi);
      const float cosine = dot3(found.geometric, found.wo);
      if (!(found.distance > 0) || !found.front || cosine < 0.05f)
        continue;  // the rim, where rounding may miss it
      const Emission emission = emission_at(scene, found);
      ASSERT_EQ(emission.radiance.y, 2);
      // The ray meets the light beside the point that was offset from it: where it is curved, under another
      // cosine.
      const double tolerance = 1e-4 + 2 * light_offset(tables) * (curvature / cosine + 1) / cosine;
      ASSERT_NEAR(light.pdf / emission.pdf, 1, tolerance)
          << "cosine " << cosine << " distance " << found.distance;
      ++compared;
    }
  }
  EXPECT_GT(compared, 2000);
}

TEST_P(Lights, ShadowRaysEndBeforeTheLight) {
  RandomNumbers random(2);
  int traced = 0;
  for (double offset : {0.0, 10.0, 1e3}) {
    for (int k = 0; k < 400; ++k) {
      SceneTables tables = GetParam().make(random);
      // The whole scene away from the origin: everything is rounded more coarsely.
      const vec3 shift = rounded(offset * random.direction());
      const auto move = [&](vec3& v) { v = add(v, shift); };
      for (Light& light : tables.lights) {
        move(light.p0);
        if (light.kind == LIGHT_TRIANGLE) move(light.p1), move(light.p2);
      }
      for (Triangle& t : tables.triangles) move(t.p0), move(t.p1), move(t.p2);
      for (Quadric& q : tables.quadrics) move(q.center);
      const Scene scene = tables.scene();
      const Surface s = receiver(shift, rounded(random.direction()));
      for (int i = 0; i < 50; ++i) {
        const LightSample light = sample(scene, s, random);
        if (!(light.tmax > 0)) continue;
        // At the rim the offsets of receiver and light decide which side is seen.
        if (cosine_at_light(tables, light) < 8 * (light_offset(tables) + s.error) / light.tmax + 1e-3)
          continue;
        ++traced;
        const TestHit hit =
            trace_one_by_one(tables, std::vector{TestRay{light.origin, light.wi, light.tmax}})[0];
        ASSERT_EQ(hit.primitive, -1) << "blocked by the light itself after " << hit.t << " of " << light.tmax
                                     << " at " << offset << ", cosine " << cosine_at_light(tables, light);
      }
    }
  }
  EXPECT_GT(traced, 10'000);
}

TEST_P(Lights, ShadowRaysReachAlmostTheLight) {
  RandomNumbers random(3);
  int reached = 0;
  for (int k = 0; k < 1000; ++k) {
    SceneTables tables = GetParam().make(random);
    const Scene scene = tables.scene();
    const Surface s = receiver(make_vec3(0, 0, 0), rounded(random.direction()));
    const LightSample light = sample(scene, s, random);
    if (!(light.tmax > 0)) continue;
    const Surface found = surface_at(&scene, 0, light.origin, light.wi);
    const float cosine = dot3(found.geometric, found.wo);
    if (!(found.distance > 0) || !found.front || cosine < 0.05f) continue;
    // 64 roundings of the distance, and the offset from the light's surface along the slanting ray.
    ASSERT_NEAR(light.tmax, found.distance,
                80 * 0x1p-24 * found.distance + 2 * light_offset(tables) / cosine);
    ++reached;
  }
  EXPECT_GT(reached, 200);
}

/// Mean of 1 / pdf over samples: the solid angle of what they can reach.
void expect_solid_angle(SceneTables tables, double expected, const std::string& name) {
  const Scene scene = tables.scene();
  const Surface s = receiver(make_vec3(0, 0, 0), make_vec3(0, 0, 1));
  RandomNumbers random(4);
  statistics::Sample inverse;
  for (int i = 0; i < 100'000; ++i) {
    const LightSample light = sample(scene, s, random);
    inverse.add(light.tmax > 0 ? 1 / double(light.pdf) : 0);
  }
  EXPECT_GT(statistics::t_test(inverse, expected, 1e-5 * expected).p, kSignificance / 12)
      << name << ": " << inverse.mean();
}

TEST(LightDensity, InverseAveragesToTheSolidAngle) {
  const vec3 x = make_vec3(1, 0, 0), y = make_vec3(0, 1, 0), z = make_vec3(0, 0, 1);
  for (bool by_solid_angle : {false, true}) {
    const std::string way = by_solid_angle ? " by solid angle" : " by area";
    expect_solid_angle(triangle_light(x, z, y, by_solid_angle), kPi / 2, "octant" + way);
    const vec3 a = make_vec3(-0.2f, 0.1f, 1), b = make_vec3(0.1f, 0.3f, 1.2f),
               c = make_vec3(0.3f, -0.2f, 0.8f);
    expect_solid_angle(triangle_light(a, b, c, by_solid_angle),
                       exact_solid_angle(exact(a), exact(b), exact(c)), "triangle" + way);
    const double cosine = std::sqrt(1 - 0.25);
    expect_solid_angle(sphere_light(make_vec3(0, 0, 2), 1, 1, by_solid_angle), 2 * kPi * (1 - cosine),
                       "sphere" + way);
    expect_solid_angle(sphere_light(make_vec3(0.5f, 0, 0), 2, -1, by_solid_angle), 4 * kPi,
                       "sphere from inside" + way);
  }
  expect_solid_angle(disk_light(make_vec3(0, 0, 2), make_vec3(0, 0, -1), 1),
                     2 * kPi * (1 - 2 / std::sqrt(5.0)), "disk");
  expect_solid_angle(environment_light(), 4 * kPi, "environment");
}

TEST(LightDensity, OneSidedLightsShineForwardsOnly) {
  const vec3 x = make_vec3(1, 0, 0), y = make_vec3(0, 1, 0), z = make_vec3(0, 0, 1);
  expect_solid_angle(triangle_light(x, y, z, false), 0, "triangle from behind");
  expect_solid_angle(disk_light(make_vec3(0, 0, 2), make_vec3(0, 0, 1), 1), 0, "disk from behind");
  expect_solid_angle(sphere_light(make_vec3(0, 0, 2), 1, -1, true), 2 * kPi * (1 - std::sqrt(0.75)),
                     "far side of a sphere that emits inwards");
  expect_solid_angle(sphere_light(make_vec3(0, 0, 0.5f), 2, 1, true), 0,
                     "sphere that emits outwards, from inside");
}

/// p of a chi-square test that (a, b) in [0, 1)^2 are uniform.
class UnitSquare {
 public:
  void add(double a, double b) {
    const auto cell = [](double v) { return std::size_t(std::clamp(v, 0.0, 1 - 1e-12) * kSide); };
    ++counts_[cell(a) * kSide + cell(b)];
    ++total_;
  }
  [[nodiscard]] double p() const {
    return statistics::chi_square_test(counts_,
                                       std::vector<double>(counts_.size(), total_ / double(counts_.size())))
        .p;
  }

 private:
  static constexpr int kSide = 16;
  std::vector<double> counts_ = std::vector<double>(kSide * kSide);
  double total_ = 0;
};

double turns(const Exact3& d) {
  const double t = double(std::atan2(d.y, d.x)) / (2 * kPi);
  return t < 0 ? t + 1 : t;
}

constexpr int kUniformSamples = 200'000;

TEST(LightPoints, AreUniformOverATriangle) {
  // By area: with barycentric coordinates b1, b2 the pair ((1 - b0)^2, b2 / (b1 + b2)) is uniform.
  const vec3 a = make_vec3(-1, -1, 2), b = make_vec3(0, 1.5f, 3), c = make_vec3(2, -1, 2.5f);
  SceneTables tables = triangle_light(a, b, c, false);
  const Scene scene = tables.scene();
  const Surface s = receiver(make_vec3(0, 0, 0), make_vec3(0, 0, 1));
  const Exact3 area = cross(exact(b) - exact(a), exact(c) - exact(a));
  RandomNumbers random(5);
  UnitSquare square;
  for (int i = 0; i < kUniformSamples; ++i) {
    const LightSample light = sample(scene, s, random);
    if (!(light.tmax > 0)) continue;
    const Exact3 d = exact(light.wi);
    const Exact3 at = (dot(exact(a), area) / dot(d, area)) * d;
    const double b1 = double(dot(cross(exact(c) - at, exact(a) - at), area) / dot(area, area));
    const double b2 = double(dot(cross(exact(a) - at, exact(b) - at), area) / dot(area, area));
    square.add(std::pow(b1 + b2, 2), b2 / (b1 + b2));
  }
  EXPECT_GT(square.p(), kSignificance);
}

TEST(LightPoints, AreUniformOverADisk) {
  const vec3 center = make_vec3(0.5f, -0.5f, 2);
  SceneTables tables = disk_light(center, make_vec3(0, 0, -1), 1.5f);
  const Scene scene = tables.scene();
  const Surface s = receiver(make_vec3(0, 0, 0), make_vec3(0, 0, 1));
  RandomNumbers random(6);
  UnitSquare square;
  for (int i = 0; i < kUniformSamples; ++i) {
    const LightSample light = sample(scene, s, random);
    const Exact3 from_center = (2 / (long double)light.wi.z) * exact(light.wi) - exact(center);
    square.add(double(dot(from_center, from_center)) / 2.25, turns(from_center));
  }
  EXPECT_GT(square.p(), kSignificance);
}

TEST(LightPoints, AreUniformOverTheConeOfASphere) {
  for (double distance : {1.001, 1.5, 30.0}) {
    SceneTables tables = sphere_light(make_vec3(0, 0, float(distance)), 1, 1, true);
    const Scene scene = tables.scene();
    const Surface s = receiver(make_vec3(0, 0, 0), make_vec3(0, 0, 1));
    const double versine = 1 - std::sqrt(1 - 1 / (distance * distance));
    RandomNumbers random(7);
    UnitSquare square;
    for (int i = 0; i < kUniformSamples; ++i) {
      const Exact3 d = exact(sample(scene, s, random).wi);
      square.add(double(dot(d - Exact3{0, 0, 1}, d - Exact3{0, 0, 1})) / 2 / versine, turns(d));
    }
    EXPECT_GT(square.p(), kSignificance / 3) << "from " << distance;
  }
}

TEST(LightPoints, AreUniformOverASphereFromInside) {
  const vec3 center = make_vec3(0.3f, 0.2f, -0.4f);
  SceneTables tables = sphere_light(center, 2, -1, true);
  const Scene scene = tables.scene();
  const Surface s = receiver(make_vec3(0, 0, 0), make_vec3(0, 0, 1));
  RandomNumbers random(8);
  UnitSquare square;
  for (int i = 0; i < kUniformSamples; ++i) {
    const LightSample light = sample(scene, s, random);
    const Exact3 on_sphere = exact(light.origin) + (long double)light.tmax * exact(light.wi) - exact(center);
    square.add(double(1 + on_sphere.z / 2) / 2, turns(on_sphere));
  }
  EXPECT_GT(square.p(), kSignificance);
}

TEST(LightPoints, AreUniformOverTheEnvironment) {
  SceneTables tables = environment_light();
  const Scene scene = tables.scene();
  const Surface s = receiver(make_vec3(1, 2, 3), make_vec3(0, 0, 1));
  RandomNumbers random(9);
  UnitSquare square;
  for (int i = 0; i < kUniformSamples; ++i) {
    const LightSample light = sample(scene, s, random);
    square.add((1 + double(light.wi.z)) / 2, turns(exact(light.wi)));
  }
  EXPECT_GT(square.p(), kSignificance);
}

TEST(PointLight, FollowsTheInverseSquareLaw) {
  SceneTables tables = point_light(make_vec3(0, 3, 4));
  tables.lights[0].radiance = make_vec3(50, 100, 25);
  const Scene scene = tables.scene();
  const LightSample s =
      sample_light(scene, receiver(make_vec3(0, 0, 0), make_vec3(0, 0, 1)), 0.2f, 0.7f, 0.0f);
  EXPECT_TRUE(s.delta);
  EXPECT_EQ(s.pdf, 1);
  EXPECT_NEAR(s.radiance.x, 2, 1e-6);
  EXPECT_NEAR(s.radiance.y, 4, 1e-6);
  EXPECT_NEAR(s.wi.y, 0.6, 1e-6);
  EXPECT_NEAR(s.wi.z, 0.8, 1e-6);
  EXPECT_LE(s.tmax, 5);
  EXPECT_NEAR(s.tmax, 5, 1e-4);
}

TEST(LightChoice, EntersTheDensity) {
  SceneTables tables = sphere_light(make_vec3(0, 0, 2), 1, 1, true);
  tables.lights.push_back(environment_light().lights[0]);
  tables.header.environment = 1;
  tables.lights[0].pmf = 0.25f;
  tables.lights[1].pmf = 0.75f;
  tables.lights[1].start = 1 << 22;
  tables.light_cells = {0, 1, 1, 1};
  const Scene scene = tables.scene();
  const Surface s = receiver(make_vec3(0, 0, 0), make_vec3(0, 0, 1));
  const double cone = 2 * kPi * (1 - std::sqrt(0.75));
  EXPECT_NEAR(sample_light(scene, s, 0.1f, 0.5f, 0.0f).pdf, 0.25 / cone, 1e-5);
  EXPECT_NEAR(sample_light(scene, s, 0.3f, 0.5f, 0.0f).pdf, 0.75 / (4 * kPi), 1e-6);
  EXPECT_NEAR(sample_light(scene, s, 0.9f, 0.5f, 0.0f).pdf, 0.75 / (4 * kPi), 1e-6);
}

TEST(Emission, OfTheEnvironmentReachesWhatLeavesTheScene) {
  SceneTables tables = environment_light();
  tables.lights[0].pmf = 0.5f;
  const Scene scene = tables.scene();
  const Surface nothing = surface_at(&scene, -1, make_vec3(0, 0, 0), make_vec3(0, 0, 1));
  const Emission e = emission_at(scene, nothing);
  EXPECT_EQ(e.radiance.x, 1);
  EXPECT_EQ(e.radiance.z, 3);
  EXPECT_NEAR(e.pdf, 0.5 / (4 * kPi), 1e-7);
}

TEST(Emission, IsFromTheFrontOnly) {
  SceneTables tables = triangle_light(make_vec3(-1, -1, 0), make_vec3(1, -1, 0), make_vec3(0, 1, 0), false);
  const Scene scene = tables.scene();
  const vec3 above = make_vec3(0, 0, 1), below = make_vec3(0, 0, -1);
  const Surface front = surface_at(&scene, 0, above, below), back = surface_at(&scene, 0, below, above);
  EXPECT_EQ(emission_at(scene, front).radiance.y, 2);
  EXPECT_NEAR(emission_at(scene, front).pdf, 0.5, 1e-6);  // d^2 / (cos A)
  EXPECT_EQ(emission_at(scene, back).radiance.y, 0);
  EXPECT_EQ(emission_at(scene, back).pdf, 0);
}

TEST(LightSampling, StaysFiniteWhereTheReceiverTouchesTheLight) {
  const vec3 a = make_vec3(0, 0, 0), b = make_vec3(1, 0, 0), c = make_vec3(0, 1, 0);
  const vec3 places[] = {a,  // a vertex
                         make_vec3(0.5f, 0, 0),
                         make_vec3(0.25f, 0.25f, 0),
                         make_vec3(3, 3, 0),  // an edge, inside, in the plane
                         make_vec3(0.25f, 0.25f, 1e-7f),
                         make_vec3(0.25f, 0.25f, -1e-7f),
                         make_vec3(0.25f, 0.25f, 1e-30f),
                         make_vec3(1e6f, 0, 1e-3f),
                         make_vec3(0, 0, 1),
                         make_vec3(0, 0, 2)};
  std::vector<SceneTables> scenes;
  for (bool by_solid_angle : {false, true}) {
    scenes.push_back(triangle_light(a, b, c, by_solid_angle));
    scenes.push_back(triangle_light(a, b, make_vec3(0.5f, 0, 0), by_solid_angle));  // no area
    scenes.push_back(triangle_light(a, a, a, by_solid_angle));
    scenes.push_back(sphere_light(make_vec3(0, 0, 1), 1, 1, by_solid_angle));
    scenes.push_back(sphere_light(make_vec3(0, 0, 1), 1, -1, by_solid_angle));
  }
  scenes.push_back(disk_light(make_vec3(0.25f, 0.25f, 0), make_vec3(0, 0, 1), 1));
  RandomNumbers random(10);
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    const Scene scene = scenes[k].scene();
    for (const vec3& p : places)
      for (float u : {0.0f, 0x1p-24f, 0.5f, ONE_MINUS_EPSILON})
        for (float v : {0.0f, 0.25f, 0.5f, ONE_MINUS_EPSILON}) {
          const Surface s = receiver(p, rounded(random.direction()));
          const LightSample light = sample_light(scene, s, u, v, 0.5f);
          if (!(light.tmax > 0)) continue;  // no contribution possible
          ASSERT_TRUE(std::isfinite(light.pdf) && light.pdf > 0) << "scene " << k;
          ASSERT_TRUE(std::isfinite(light.tmax));
          ASSERT_NEAR(double(length(exact(light.wi))), 1, 1e-6) << "scene " << k;
        }
  }
}

}  // namespace
}  // namespace penumbra::light_test
