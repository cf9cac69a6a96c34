// Texture coordinates and tangents of surfaces, against extended precision and finite differences.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra::surface_uv_test {
namespace {

constexpr long double kPi = std::numbers::pi_v<long double>;

struct ExactUv {
  long double u, v;
};

/// Between two angles in turns.
long double turn_between(long double a, long double b) {
  const long double d = std::abs(a - b);
  return std::min(d, 1 - d);
}

long double turns(long double x, long double y) {
  const long double t = std::atan2(y, x) / (2 * kPi);
  return t < 0 ? t + 1 : t;
}

/// The affine map of a triangle's plane to its texture coordinates.
ExactUv uv_of_triangle(const Triangle& t, const VertexUvs& at, const Exact3& p) {
  const Exact3 p0 = exact(t.p0), p1 = exact(t.p1), p2 = exact(t.p2), n = cross(p1 - p0, p2 - p0);
  const long double b1 = dot(cross(p - p0, p2 - p0), n) / dot(n, n);
  const long double b2 = dot(cross(p1 - p0, p - p0), n) / dot(n, n);
  return {at.u0 + b1 * ((long double)at.u1 - at.u0) + b2 * ((long double)at.u2 - at.u0),
          at.v0 + b1 * ((long double)at.v1 - at.v0) + b2 * ((long double)at.v2 - at.v0)};
}

void expect_unit_and_in_plane(const Surface& s) {
  ASSERT_NEAR(double(length(exact(s.tangent))), 1, 4e-7);
  ASSERT_NEAR(dot3(s.tangent, s.geometric), 0, 1e-6);
}

/// A triangle that is no sliver, and a ray at a point of it.
SceneTables random_triangle(RandomNumbers& random, vec3& origin, vec3& direction) {
  SceneTables tables;
  const Exact3 at = 10.0L * random.direction();
  for (;;) {
    const vec3 a = rounded(at + random.point(1)), b = rounded(at + random.point(1)),
               c = rounded(at + random.point(1));
    if (length(cross(exact(b) - exact(a), exact(c) - exact(a))) < 0.3L) continue;
    tables.add_triangle(a, b, c);
    const long double b0 = random.uniform(), b1 = (1 - b0) * random.uniform();
    origin = rounded(at + 3.0L * random.direction());
    const Exact3 target = b0 * exact(a) + b1 * exact(b) + (1 - b0 - b1) * exact(c);
    direction = rounded(normalize(target - exact(origin)));
    const Exact3 normal = normalize(cross(exact(b) - exact(a), exact(c) - exact(a)));
    if (std::abs(dot(normal, exact(direction))) > 0.05L) return tables;
    tables.triangles.clear();
  }
}

TEST(UvOfATriangle, IsInterpolatedAndTheTangentIsWhereUGrowsAlone) {
  RandomNumbers random(1);
  for (int i = 0; i < 20'000; ++i) {
    vec3 o, d;
    SceneTables tables = random_triangle(random, o, d);
    const auto number = [&] { return float(random.between(-2, 3)); };
    const VertexUvs at{number(), number(), number(), number(), number(), number()};
    const double area =
        (double(at.u1) - at.u0) * (double(at.v2) - at.v0) - (double(at.v1) - at.v0) * (double(at.u2) - at.u0);
    if (std::abs(area) < 0.05) continue;
    tables.vertex_uvs.push_back(at);
    const Scene scene = tables.scene();
    const Surface s = surface_at(&scene, 0, o, d);
    const Exact3 p = exact(s.p);
    const ExactUv here = uv_of_triangle(tables.triangles[0], at, p);
    ASSERT_NEAR(s.u, double(here.u), 1e-4);
    ASSERT_NEAR(s.v, double(here.v), 1e-4);
    expect_unit_and_in_plane(s);
    const ExactUv there = uv_of_triangle(tables.triangles[0], at, p + exact(s.tangent));
    ASSERT_GT(there.u, here.u);
    ASSERT_NEAR(double((there.v - here.v) / (there.u - here.u)), 0, 1e-4);
  }
}

TEST(UvOfATriangle, IsExactAtItsVertices) {
  SceneTables tables;
  tables.add_triangle(make_vec3(0, 0, 0), make_vec3(1, 0, 0), make_vec3(0, 1, 0));
  tables.vertex_uvs.push_back({0.1f, 0.2f, 0.3f, 0.7f, 0.9f, 0.4f});
  const Scene scene = tables.scene();
  const float expected[3][2] = {{0.1f, 0.2f}, {0.3f, 0.7f}, {0.9f, 0.4f}};
  const vec3 vertices[3] = {make_vec3(0, 0, 0), make_vec3(1, 0, 0), make_vec3(0, 1, 0)};
  for (int k = 0; k < 3; ++k) {
    const Surface s = surface_at(&scene, 0, add(vertices[k], make_vec3(0, 0, 1)), make_vec3(0, 0, -1));
    EXPECT_EQ(s.u, expected[k][0]);
    EXPECT_EQ(s.v, expected[k][1]);
  }
}

TEST(UvOfATriangle, WithoutAreaHasTheFramesTangent) {
  RandomNumbers random(2);
  for (int i = 0; i < 1000; ++i) {
    vec3 o, d;
    SceneTables tables = random_triangle(random, o, d);
    tables.vertex_uvs.push_back({0.5f, 0.25f, 1, 0.5f, 2, 1});
    const Scene scene = tables.scene();
    const Surface s = surface_at(&scene, 0, o, d);
    const vec3 first = from_frame(s.front ? s.geometric : negate(s.geometric), 1, 0, 0);
    ASSERT_TRUE(s.tangent.x == first.x && s.tangent.y == first.y && s.tangent.z == first.z);
  }
}

/// As in Mitsuba 3.9, where a mesh without texture coordinates has barycentric ones, and their tangent.
TEST(UvOfATriangle, OfBarycentricCoordinatesTheTangentIsTheFirstEdge) {
  RandomNumbers random(3);
  for (int i = 0; i < 1000; ++i) {
    vec3 o, d;
    SceneTables tables = random_triangle(random, o, d);
    tables.vertex_uvs.push_back({0, 0, 1, 0, 0, 1});
    const Scene scene = tables.scene();
    const Surface s = surface_at(&scene, 0, o, d);
    const ExactUv b = uv_of_triangle(tables.triangles[0], {0, 0, 1, 0, 0, 1}, exact(s.p));
    ASSERT_NEAR(s.u, double(b.u), 2e-5);
    ASSERT_NEAR(s.v, double(b.v), 2e-5);
    const Exact3 edge = normalize(exact(tables.triangles[0].p1) - exact(tables.triangles[0].p0));
    ASSERT_LT(length(exact(s.tangent) - edge), 1e-5L);
  }
}

/// The scene's features say that it has texture coordinates; spheres and disks need no table.
Surface surface_with_uv(SceneTables& tables, const vec3& o, const vec3& d) {
  tables.header.features |= FEATURE_UV;
  const Scene scene = tables.scene();
  return surface_at(&scene, 0, o, d);
}

TEST(UvOfASphere, IsLongitudeAndAngleFromItsPole) {
  RandomNumbers random(3);
  for (int i = 0; i < 20'000; ++i) {
    SceneTables tables;
    const vec3 center = rounded(random.point(2));
    const auto radius = float(random.between(0.2, 2));
    tables.add_sphere(center, radius, i % 2 == 0 ? 1.0f : -1.0f);
    const vec3 o =
        rounded(exact(center) + (long double)(radius * random.between(0.1, 4)) * random.direction());
    const vec3 d = rounded(normalize(exact(center) + 0.7L * radius * random.direction() - exact(o)));
    const Surface s = surface_with_uv(tables, o, d);
    if (!(s.distance > 0)) continue;
    const auto uv_of = [&](const Exact3& p) {
      const Exact3 w = p - exact(center);
      return ExactUv{turns(w.x, w.y), std::atan2(std::hypot(w.x, w.y), w.z) / kPi};
    };
    const Exact3 p = exact(s.p);
    const ExactUv here = uv_of(p);
    // The position's rounding, which is a wide angle near the axis and on a small sphere.
    const Exact3 w = p - exact(center);
    const double sine = double(std::hypot(w.x, w.y)) / radius, rounding = 1e-6 / radius;
    ASSERT_GE(s.u, 0);
    ASSERT_LT(s.u, 1);
    ASSERT_LE(turn_between(s.u, here.u), 2e-7 + rounding / sine);
    ASSERT_NEAR(s.v, double(here.v), 4e-7 + rounding);
    expect_unit_and_in_plane(s);
    if (sine < 1e-2) continue;
    const long double step = 1e-5L * radius * sine;
    const ExactUv there = uv_of(p + step * exact(s.tangent));
    long double du = there.u - here.u;
    du += du < -0.5L ? 1 : 0;
    ASSERT_NEAR(double(du * 2 * kPi * radius * sine / step), 1, 1e-3) << "as far as it goes";
    ASSERT_NEAR(double((there.v - here.v) * kPi * radius / step), 0, 1e-3);
  }
}

TEST(UvOfASphere, HasAnyTangentAtItsPoles) {
  for (const float z : {1.0f, -1.0f}) {
    SceneTables tables;
    tables.add_sphere(make_vec3(0, 0, 0), 1);
    const Surface s = surface_with_uv(tables, make_vec3(0, 0, 3 * z), make_vec3(0, 0, -z));
    EXPECT_EQ(s.u, 0);
    EXPECT_EQ(s.v, z > 0 ? 0 : 1);
    expect_unit_and_in_plane(s);
  }
}

TEST(UvOfADisk, IsDistanceAndAngleAboutItsCentre) {
  RandomNumbers random(4);
  for (int i = 0; i < 20'000; ++i) {
    SceneTables tables;
    const vec3 center = rounded(random.point(2)), normal = rounded(random.direction());
    const auto radius = float(random.between(0.2, 2));
    tables.add_disk(center, normal, radius);
    const Exact3 x = exact(from_frame(normal, 1, 0, 0)), y = exact(from_frame(normal, 0, 1, 0));
    const long double r = (long double)radius * random.uniform(), phi = 2 * kPi * random.uniform();
    const Exact3 target = exact(center) + r * std::cos(phi) * x + r * std::sin(phi) * y;
    const vec3 o = rounded(exact(center) + 3.0L * random.direction());
    const vec3 d = rounded(normalize(target - exact(o)));
    if (std::abs(dot3(d, normal)) < 0.05f) continue;
    const Surface s = surface_with_uv(tables, o, d);
    if (!(s.distance > 0)) continue;
    const auto uv_of = [&](const Exact3& p) {
      const Exact3 w = p - exact(center);
      return ExactUv{std::hypot(dot(w, x), dot(w, y)) / radius, turns(dot(w, x), dot(w, y))};
    };
    const Exact3 p = exact(s.p);
    const ExactUv here = uv_of(p);
    const double rounding = 2e-6 / radius;
    ASSERT_NEAR(s.u, double(here.u), 4e-7 + rounding);
    ASSERT_LE(turn_between(s.v, here.v), 2e-7 + rounding / double(here.u));
    ASSERT_GE(s.v, 0);
    ASSERT_LT(s.v, 1);
    expect_unit_and_in_plane(s);
    if (here.u < 1e-2) continue;
    const long double step = 1e-4L * radius * here.u;
    const ExactUv there = uv_of(p + step * exact(s.tangent));
    ASSERT_NEAR(double((there.u - here.u) * radius / step), 1, 1e-3);
    ASSERT_LE(turn_between(there.v, here.v) * 2 * kPi * here.u * radius / step, 1e-3L);
  }
}

TEST(UvOfQuadrics, TurnsWithTheirFrames) {
  RandomNumbers random(5);
  for (int i = 0; i < 4000; ++i) {
    const bool disk = i % 2 == 0;
    const vec3 z = rounded(random.direction());
    const vec3 x = tangent_axis(z, rounded(random.direction())), y = cross3(z, x);
    const auto turned = [&](const vec3& v) { return add(add(scale(x, v.x), scale(y, v.y)), scale(z, v.z)); };
    SceneTables plain, other;
    for (SceneTables* tables : {&plain, &other}) {
      const vec3 axis = tables == &plain ? make_vec3(0, 0, 1) : z;
      if (disk)
        tables->add_disk(make_vec3(0, 0, 0), axis, 1);
      else
        tables->add_sphere(make_vec3(0, 0, 0), 1);
      tables->quadrics[0].x_axis = tables == &plain ? make_vec3(1, 0, 0) : x;
      tables->quadrics[0].y_axis = tables == &plain ? make_vec3(0, 1, 0) : y;
      tables->quadrics[0].normal = axis;
    }
    const vec3 o = rounded(3.0L * random.direction());
    const vec3 d = rounded(normalize(0.8L * random.uniform() * random.direction() - exact(o)));
    const Surface a = surface_with_uv(plain, o, d), b = surface_with_uv(other, turned(o), turned(d));
    if (!(a.distance > 0) || !(b.distance > 0) || std::abs(dot3(a.geometric, d)) < 0.1f) continue;
    const double reach = std::hypot(double(a.p.x), double(a.p.y));
    if (reach < 1e-2 || std::abs(a.distance - b.distance) > 1e-4f) continue;
    const double tolerance = 1e-5 / reach;
    const auto apart = [](float s, float t) { return double(turn_between(s, t)); };
    ASSERT_LE(disk ? std::abs(a.u - b.u) : apart(a.u, b.u), tolerance);
    ASSERT_LE(disk ? apart(a.v, b.v) : std::abs(a.v - b.v), tolerance);
    ASSERT_LE(length3(sub(turned(a.tangent), b.tangent)), 10 * tolerance);
  }
}

TEST(Uv, IsNothingInScenesWithoutIt) {
  SceneTables tables;
  tables.add_triangle(make_vec3(-1, -1, 0), make_vec3(1, -1, 0), make_vec3(0, 1, 0));
  const Scene scene = tables.scene();
  const Surface s = surface_at(&scene, 0, make_vec3(0, 0, 1), make_vec3(0, 0, -1));
  EXPECT_EQ(s.u, 0);
  EXPECT_EQ(s.v, 0);
  EXPECT_EQ(length3(s.tangent), 0);
}

}  // namespace
}  // namespace penumbra::surface_uv_test
