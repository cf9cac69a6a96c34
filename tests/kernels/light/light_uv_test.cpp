// Texture coordinates on lights: those of a sample equal those of a ray that hits the same point.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/kernels/light_scenes.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra {
namespace {

constexpr uint kWays = FEATURE_UV | FEATURE_SOLID_ANGLE | FEATURE_PROJECTED;

LightReceiver receiver_at(const vec3& p, const vec3& normal) { return receiver_of(receiver(p, normal)); }

/// A ray from `from` to the point finds the light of index 0 on one of the primitives, at the same place.
void expect_found(const Scene& scene, int primitive, const vec3& from, const LightPoint& at,
                  double tolerance) {
  const vec3 way = sub(at.p, from);
  const Surface s = surface_at(&scene, primitive, from, normalize3(way));
  if (std::abs(dot3(s.geometric, s.wo)) < 0.05f || std::abs(s.distance - length3(way)) > 1e-3f) return;
  ASSERT_EQ(s.light, 0);
  const float turn = std::abs(at.u - s.u);
  ASSERT_LE(std::min(turn, 1 - turn), tolerance);
  const float other = std::abs(at.v - s.v);
  ASSERT_LE(std::min(other, 1 - other), tolerance);
  // What it tells emission.
  Surfaces surfaces;
  FoundLights found;
  for (int j = 0; j < LANES; ++j) store_surface(&surfaces, j, s);
  find_lights(&scene, &surfaces, &found);
  for (int j = 0; j < LANES; ++j) {
    ASSERT_EQ(found.u[j], s.u);
    ASSERT_EQ(found.v[j], s.v);
  }
}

TEST(LightUv, OfATriangleIsThatOfItsSurface) {
  RandomNumbers random(1);
  for (const bool by_solid_angle : {false, true})
    for (int i = 0; i < 20'000 && !testing::Test::HasFatalFailure(); ++i) {
      const Exact3 at = 3.0L * random.direction();
      const vec3 a = rounded(at + random.point(1)), b = rounded(at + random.point(1)),
                 c = rounded(at + random.point(1));
      if (length(cross(exact(b) - exact(a), exact(c) - exact(a))) < 0.3L) continue;
      SceneTables tables = triangle_light(a, b, c, by_solid_angle);
      const auto number = [&] { return float(random.between(0, 0.4)); };
      tables.vertex_uvs.push_back({number(), number(), number(), number(), number(), number()});
      tables.light_triangles.push_back({0, 0, -1});
      const Scene scene = tables.scene();
      const vec3 here = make_vec3(0, 0, 0);
      const SampledPoint point =
          sample_triangle_point(&scene, 0, scene.lights[0], receiver_at(here, make_vec3(0, 0, 1)),
                                random.unit_float(), random.unit_float(), no_light_sampling(), kWays);
      expect_found(scene, 0, here, point.at, 1e-4);
    }
}

TEST(LightUv, OfARectangleIsThatOfTheTriangleUnderIt) {
  // Two triangles whose texture coordinates do not fit together.
  RandomNumbers random(2);
  int on[2] = {0, 0};
  for (int i = 0; i < 20'000 && !testing::Test::HasFatalFailure(); ++i) {
    const Exact3 corner = 3.0L * random.direction(), side = random.direction();
    const Exact3 other = normalize(cross(side, random.direction()));
    const vec3 p0 = rounded(corner), p1 = rounded(corner + side), p3 = rounded(corner + other);
    const vec3 p2 = rounded(corner + side + other);
    SceneTables tables = rectangle_light(p0, p1, p3);
    tables.triangles.clear();
    tables.add_triangle(p0, p1, p2);
    tables.add_triangle(p2, p3, p0);
    for (Triangle& t : tables.triangles) {
      t.light = 0;
      const auto number = [&] { return float(random.between(0, 0.4)); };
      tables.vertex_uvs.push_back({number(), number(), number(), number(), number(), number()});
    }
    tables.light_triangles.push_back({0, 1, -1});
    const Scene scene = tables.scene();
    const vec3 here = make_vec3(0, 0, 0);
    const SampledPoint point = sample_rectangle_point(
        &scene, 0, scene.lights[0], still_axes(&scene, 0, LIGHT_RECTANGLE),
        receiver_at(here, make_vec3(0, 0, 1)), random.unit_float(), random.unit_float(), kWays);
    const Exact3 d = exact(point.at.p) - corner;
    const long double from_diagonal = dot(d, side) - dot(d, other);
    if (std::abs(from_diagonal) < 1e-4L) continue;
    const int under = from_diagonal > 0 ? 0 : 1;
    ++on[under];
    expect_found(scene, under, here, point.at, 1e-4);
  }
  EXPECT_GT(on[0], 5000);
  EXPECT_GT(on[1], 5000);
}

TEST(LightUv, OfASphereAndADiskIsThatOfTheirSurface) {
  RandomNumbers random(3);
  for (int i = 0; i < 40'000 && !testing::Test::HasFatalFailure(); ++i) {
    const Exact3 center = 3.0L * random.direction();
    const auto radius = float(random.between(0.3, 1.5));
    const bool disk = i % 2 == 0;
    SceneTables tables = disk ? disk_light(rounded(center), rounded(random.direction()), radius)
                              : sphere_light(rounded(center), radius, 1, i % 4 == 1);
    tables.header.features |= FEATURE_UV;
    tables.light_triangles.push_back({-1, -1, 0});
    // Turned and mirrored anyhow: the disk about its normal.
    Quadric& q = tables.quadrics[0];
    const vec3 pole = disk ? q.normal : rounded(random.direction());
    q.x_axis = tangent_axis(pole, rounded(random.direction()));
    q.y_axis = scale(cross3(pole, q.x_axis), i % 3 == 0 ? -1.0f : 1.0f);
    q.normal = pole;
    const Scene scene = tables.scene();
    const vec3 here = make_vec3(0, 0, 0);
    const LightReceiver r = receiver_at(here, make_vec3(0, 0, 1));
    const float u = random.unit_float(), v = random.unit_float();
    const SampledPoint point =
        disk
            ? sample_disk_point(&scene, 0, scene.lights[0], still_axes(&scene, 0, LIGHT_DISK), r, u, v, kWays)
            : sample_sphere_point(&scene, 0, scene.lights[0], still_axes(&scene, 0, LIGHT_SPHERE), r, u, v,
                                  kWays);
    // Angles widen towards the axis.
    const vec3 w = sub(point.at.p, rounded(center));
    const vec3 from_axis = to_quadric_frame(tables.quadrics[0], w);
    const double reach = std::hypot(double(from_axis.x), double(from_axis.y));
    if (reach < 1e-2) continue;
    expect_found(scene, 0, here, point.at, 2e-5 / reach);
  }
}

TEST(LightUv, IsNotComputedForScenesWithoutIt) {
  SceneTables tables = disk_light(make_vec3(0, 0, 2), make_vec3(0, 0, -1), 1);
  const Scene scene = tables.scene();
  const LightReceiver r = receiver_at(make_vec3(0, 0, 0), make_vec3(0, 0, 1));
  const SampledPoint point =
      sample_disk_point(&scene, 0, scene.lights[0], still_axes(&scene, 0, LIGHT_DISK), r, 0.5f, 0.3f, 0u);
  EXPECT_EQ(point.at.u, 0);
  EXPECT_EQ(point.at.v, 0);
}

}  // namespace
}  // namespace penumbra
