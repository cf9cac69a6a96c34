// Cylinders against extended precision.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra::cylinder_test {
namespace {

struct Tube {
  Exact3 end, axis;
  long double radius, length;
};

Tube random_tube(RandomNumbers& random, double far = 2) {
  return {exact(rounded(random.point(far))), exact(rounded(random.direction())),
          float(random.between(0.05, 1)), float(random.between(0.05, 3))};
}

/// Height of the point over the axis, and its distance from it less the radius.
struct Place {
  long double height, off;
};
Place place_of(const Tube& t, const Exact3& p) {
  const Exact3 axis = normalize(t.axis);
  const long double height = dot(p - t.end, axis);
  return {height, length(p - t.end - height * axis) - t.radius};
}

SceneTables tables_of(const Tube& t) {
  SceneTables tables;
  Quadric q{};
  q.kind = QUADRIC_CYLINDER;
  q.center = rounded(t.end);
  q.normal = rounded(t.axis);
  q.radius = float(t.radius);
  q.length = float(t.length);
  q.orientation = 1;
  q.x_axis = from_frame(q.normal, 1, 0, 0);
  q.y_axis = from_frame(q.normal, 0, 1, 0);
  q.light = -1;
  tables.quadrics.push_back(q);
  tables.header.features |= FEATURE_UV;
  tables.materials.resize(1);
  return tables;
}

struct Root {
  long double t = -1, margin = 0;  ///< how far the decision was from another
};

/// The nearest in front, by the quadratic equation.
Root exact_root(const Tube& tube, const Exact3& o, const Exact3& d) {
  const Exact3 axis = normalize(tube.axis), f = o - tube.end;
  const Exact3 fa = f - dot(f, axis) * axis, da = d - dot(d, axis) * axis;
  const long double a = dot(da, da), b = dot(fa, da), c = dot(fa, fa) - tube.radius * tube.radius;
  const long double disc = b * b - a * c;
  Root r;
  r.margin = std::abs(disc) / (a * tube.radius * tube.radius);
  if (disc < 0) return r;
  for (const long double sign : {-1.0L, 1.0L}) {
    const long double t = (-b + sign * std::sqrt(disc)) / a, h = dot(f, axis) + t * dot(d, axis);
    r.margin = std::min({r.margin, std::abs(t), std::abs(h), std::abs(h - tube.length)});
    if (t > 0 && h >= 0 && h <= tube.length) {
      r.t = t;
      return r;
    }
  }
  return r;
}

TEST(Cylinders, AreHitWhereTheyAre) {
  RandomNumbers random(3);
  int hits = 0, misses = 0;
  for (int i = 0; i < 200000; ++i) {
    const Tube tube = random_tube(random);
    const SceneTables tables = tables_of(tube);
    const vec3 o = rounded(random.point(4)), d = rounded(random.direction());
    const Root truth = exact_root(tube, exact(o), exact(d));
    if (truth.margin < 1e-4) continue;
    const float t = intersect_quadric(tables.quadrics[0], o, d);
    (truth.t > 0 ? hits : misses)++;
    ASSERT_EQ(t > 0, truth.t > 0) << i;
    if (truth.t > 0) {
      ASSERT_NEAR(t, double(truth.t), 2e-4 * (1 + double(truth.t))) << i;
    }
  }
  EXPECT_GT(hits, 2000);
  EXPECT_GT(misses, 10000);
}

TEST(Cylinders, SurfacesAreOnThemWithinTheirError) {
  RandomNumbers random(4);
  int inside = 0, outside = 0;
  for (int i = 0; i < 100000; ++i) {
    const Tube tube = random_tube(random, i % 2 == 0 ? 2 : 200);
    SceneTables tables = tables_of(tube);
    const Scene scene = tables.scene();
    const Exact3 at = tube.end + random.uniform() * (tube.length * tube.axis);
    const vec3 o = rounded(at + (5 * random.uniform()) * random.direction()), d = rounded(random.direction());
    if (!(intersect_quadric(tables.quadrics[0], o, d) > 0)) continue;
    const Surface s = surface_at(&scene, 0, o, d);
    const Place p = place_of(tube, exact(s.p));
    ASSERT_LE(std::abs(double(p.off)), s.error);
    const Exact3 outward = normalize(exact(s.p) - tube.end - p.height * normalize(tube.axis));
    const double side = s.front ? 1 : -1;
    ASSERT_GT(side * double(dot(outward, exact(s.geometric))), 1 - 1e-4);
    ASSERT_LT(dot(exact(s.geometric), exact(d)), 1e-3L);
    (s.front ? outside : inside)++;
    const double slack = 1e-3 * (1 + double(length(tube.end)));
    ASSERT_NEAR(s.v, double(p.height / tube.length), slack / double(tube.length));
    const Quadric& q = tables.quadrics[0];
    const long double x = dot(outward, exact(q.x_axis)), y = dot(outward, exact(q.y_axis));
    ASSERT_NEAR(std::cos(2 * PI_F * s.u), double(x), slack / double(tube.radius));
    ASSERT_NEAR(std::sin(2 * PI_F * s.u), double(y), slack / double(tube.radius));
    // u grows along the axis times outward.
    ASSERT_GT(double(dot(exact(s.tangent), cross(normalize(tube.axis), outward))), 1 - 1e-3);
    // Leaving it, a ray does not meet it again at once.
    const vec3 up = leave_surface(s.p, s.geometric, s.error, s.geometric);
    if (s.front) {
      ASSERT_LT(intersect_quadric(q, up, s.geometric), 0.0f) << i;
    } else {
      const float t = intersect_quadric(q, up, s.geometric);
      ASSERT_TRUE(t < 0.0f || t > float(tube.radius)) << i << " " << t;
    }
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(outside, 1000);
}

TEST(Cylinders, AlongTheirAxisNothingIsHit) {
  const Tube tube{{0, 0, 0}, {0, 0, 1}, 1, 2};
  const SceneTables tables = tables_of(tube);
  EXPECT_LT(intersect_quadric(tables.quadrics[0], make_vec3(0.5f, 0, -1), make_vec3(0, 0, 1)), 0);
  EXPECT_LT(intersect_quadric(tables.quadrics[0], make_vec3(1, 0, -1), make_vec3(0, 0, 1)), 0);
  EXPECT_LT(intersect_quadric(tables.quadrics[0], make_vec3(3, 0, 2.5f), make_vec3(-1, 0, 0)), 0);
  EXPECT_EQ(intersect_quadric(tables.quadrics[0], make_vec3(3, 0, 1), make_vec3(-1, 0, 0)), 2);
  EXPECT_EQ(intersect_quadric(tables.quadrics[0], make_vec3(0, 0, 1), make_vec3(-1, 0, 0)), 1);
}

/// The box of a cylinder in the hierarchy holds every point that rays find.
TEST(Cylinders, AreFoundInHierarchies) {
  RandomNumbers random(5);
  SceneTables tables;
  for (int i = 0; i < 60; ++i) tables.quadrics.push_back(tables_of(random_tube(random)).quadrics[0]);
  tables.build_hierarchy();
  std::vector<TestRay> rays(20000);
  for (TestRay& ray : rays) {
    ray.origin = rounded(random.point(5));
    ray.direction = rounded(random.direction());
  }
  const std::vector<TestHit> truth = trace_one_by_one(tables, rays), found = trace_hierarchy(tables, rays),
                             whole = trace_whole(tables, rays);
  int hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(found[i].primitive, truth[i].primitive);
    ASSERT_EQ(whole[i].primitive, truth[i].primitive);
    hits += truth[i].primitive >= 0 ? 1 : 0;
  }
  EXPECT_GT(hits, 2000);
}

}  // namespace
}  // namespace penumbra::cylinder_test
