// Hits of primitives: positions within their stated error, sides, normals, and rays that leave the surface.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra {
namespace {

const double kOffsets[] = {0, 1, 1e3, 1e4, 1e6};

/// The true surface about a position: signed height above it, along the exact normal.
struct ExactTriangle {
  explicit ExactTriangle(const Triangle& t) : p0(exact(t.p0)) {
    area = cross(exact(t.p1) - p0, exact(t.p2) - p0);
    normal = normalize(area);
  }
  [[nodiscard]] long double height(const vec3& p) const { return dot(exact(p) - p0, normal); }
  Exact3 p0, area, normal;
};

struct TriangleCase {
  Triangle triangle;
  vec3 origin, direction;
};

/// A ray at a random interior point of a random triangle, everything about a point `offset` away from the
/// origin.
TriangleCase random_case(RandomNumbers& random, double offset) {
  const double size = std::max(1.0, offset * 1e-4) * std::pow(10.0, random.between(-1, 1));
  const Exact3 at = offset * random.direction();
  const auto vertex = [&] { return rounded(at + random.point(size)); };
  TriangleCase c{{}, rounded(at + random.point(5 * size)), {}};
  c.triangle.p0 = vertex();
  c.triangle.p1 = vertex();
  c.triangle.p2 = vertex();
  const long double b0 = random.uniform(), b1 = (1 - b0) * random.uniform();
  const Exact3 target =
      b0 * exact(c.triangle.p0) + b1 * exact(c.triangle.p1) + (1 - b0 - b1) * exact(c.triangle.p2);
  c.direction = rounded(normalize(target - exact(c.origin)));
  return c;
}

bool hits(const TriangleCase& c) {
  const Shear s = make_shear(c.direction);
  const TriangleHit h = intersect_sheared(shear_point(s, sub(c.triangle.p0, c.origin)),
                                          shear_point(s, sub(c.triangle.p1, c.origin)),
                                          shear_point(s, sub(c.triangle.p2, c.origin)));
  return h.inside && h.t > 0 && h.t < NO_LIMIT;
}

TEST(SurfaceOfATriangle, PositionIsWithinItsError) {
  RandomNumbers random(1);
  for (double offset : kOffsets) {
    int count = 0;
    double largest = 0;
    for (int i = 0; i < 40'000; ++i) {
      const TriangleCase c = random_case(random, offset);
      if (!hits(c)) continue;
      ++count;
      SceneTables tables;
      tables.triangles.push_back(c.triangle);
      tables.triangles[0].light = tables.triangles[0].normals = -1;
      const Scene scene = tables.scene();
      const Surface s = surface_at(&scene, 0, c.origin, c.direction);
      const ExactTriangle truth(c.triangle);
      ASSERT_TRUE(is_hit(s));
      const double share = double(std::abs(truth.height(s.p)) / s.error);
      largest = std::max(largest, share);
    }
    EXPECT_GT(count, 20'000);
    EXPECT_LT(largest, 1) << "height over its bound, at " << offset;
  }
}

TEST(SurfaceOfATriangle, PositionIsWhereTheRayIs) {
  RandomNumbers random(2);
  for (double offset : kOffsets)
    for (int i = 0; i < 20'000; ++i) {
      const TriangleCase c = random_case(random, offset);
      if (!hits(c)) continue;
      SceneTables tables;
      tables.triangles.push_back(c.triangle);
      tables.triangles[0].light = tables.triangles[0].normals = -1;
      const Scene scene = tables.scene();
      const Surface s = surface_at(&scene, 0, c.origin, c.direction);
      const ExactTriangle truth(c.triangle);
      const long double cosine = dot(truth.normal, exact(c.direction));
      const long double t = dot(truth.p0 - exact(c.origin), truth.normal) / cosine;
      const Exact3 on_ray = exact(c.origin) + t * exact(c.direction);
      // Sideways by the rounding of the sheared vertices, which the slant stretches; and by that of the
      // vertices' sum.
      const long double reach = length(truth.p0 - exact(c.origin)) + length(exact(c.triangle.p1) - truth.p0) +
                                length(exact(c.triangle.p2) - truth.p0);
      const long double error = 16 * 0x1p-24L * (reach / std::abs(cosine) + length(truth.p0) + reach);
      if (std::abs(cosine) < 1e-2L || length(truth.area) < 1e-3L * reach * reach) continue;
      ASSERT_LE(length(exact(s.p) - on_ray), error);
      ASSERT_LE(std::abs(s.distance - t), error);
      ASSERT_EQ(s.front, cosine < 0);
      ASSERT_GT(dot3(s.geometric, s.wo), 0);
      ASSERT_LE(length(exact(s.geometric) - (s.front ? 1 : -1) * truth.normal), 1e-3L);
    }
}

/// Rays that leave a surface start on the side they go to. `height` is signed along `outward`.
template <typename Height>
void expect_leaves(const Surface& s, const Exact3& outward, RandomNumbers& random, Height height) {
  for (int k = 0; k < 4; ++k) {
    // At any angle, the shallowest too.
    Exact3 direction = random.direction();
    if (k == 3)
      direction =
          normalize(direction - (dot(direction, outward) - 1e-4L * (random.uniform() - 0.5)) * outward);
    const vec3 d = rounded(direction);
    const vec3 start = leave_surface(s.p, s.geometric, s.error, d);
    const float side = dot3(d, s.geometric);
    if (side == 0) continue;
    const long double on_side = height(start) * (side > 0 ? 1 : -1);
    ASSERT_GE(on_side, 0) << "starts behind the surface, at cosine " << side;
    ASSERT_LE(on_side, 4 * s.error) << "starts too far away";
  }
}

TEST(SurfaceOfATriangle, LeavingRaysStartOnTheirSide) {
  RandomNumbers random(3);
  for (double offset : kOffsets)
    for (int i = 0; i < 20'000 && !testing::Test::HasFatalFailure(); ++i) {
      const TriangleCase c = random_case(random, offset);
      if (!hits(c)) continue;
      SceneTables tables;
      tables.triangles.push_back(c.triangle);
      tables.triangles[0].light = tables.triangles[0].normals = -1;
      const Scene scene = tables.scene();
      const Surface s = surface_at(&scene, 0, c.origin, c.direction);
      const ExactTriangle truth(c.triangle);
      // A sliver's normal is not well enough known.
      const long double edge =
          std::max(length(exact(c.triangle.p1) - truth.p0), length(exact(c.triangle.p2) - truth.p0));
      if (length(truth.area) < 1e-2L * edge * edge) continue;
      const long double side = s.front ? 1 : -1;
      expect_leaves(s, side * truth.normal, random, [&](const vec3& p) { return side * truth.height(p); });
    }
}

TEST(SurfaceOfASphere, PositionIsWithinItsErrorAndRaysLeave) {
  RandomNumbers random(4);
  for (double offset : kOffsets) {
    int count = 0;
    for (int i = 0; i < 20'000 && !testing::Test::HasFatalFailure(); ++i) {
      SceneTables tables;
      const float radius = float(std::max(1.0, offset * 1e-4) * random.between(0.1, 2));
      const vec3 center = rounded(offset * random.direction());
      tables.add_sphere(center, radius, random.below(2) != 0 ? 1.0f : -1.0f);
      tables.quadrics[0].light = -1;
      const Scene scene = tables.scene();
      const vec3 o = rounded(exact(center) + random.point(3 * radius));
      const vec3 d = rounded(normalize(exact(center) + (long double)radius * random.direction() - exact(o)));
      if (!(intersect_sphere(o, d, center, radius) > 0)) continue;
      ++count;
      const Surface s = surface_at(&scene, 0, o, d);
      const auto height = [&](const vec3& p) {
        return length(exact(p) - exact(center)) - (long double)radius;
      };
      ASSERT_LE(std::abs(height(s.p)), s.error);
      const Exact3 outward = normalize(exact(s.p) - exact(center));
      const long double facing = dot(outward, exact(s.wo));
      if (std::abs(facing) < 1e-3L) continue;
      ASSERT_EQ(s.front, (facing > 0) == (tables.quadrics[0].orientation > 0));
      ASSERT_GT(dot3(s.geometric, s.wo), 0);
      const long double side = facing > 0 ? 1 : -1;
      expect_leaves(s, side * outward, random, [&](const vec3& p) { return side * height(p); });
    }
    EXPECT_GT(count, 10'000);
  }
}

TEST(SurfaceOfASphere, ALeavingRayDoesNotMeetItAgainOutside) {
  // No primitive is skipped for quadrics: the offset alone has to do.
  RandomNumbers random(5);
  for (double offset : {0.0, 10.0, 1e4})
    for (int i = 0; i < 50'000; ++i) {
      SceneTables tables;
      const vec3 center = rounded(offset * random.direction());
      tables.add_sphere(center, float(random.between(0.5, 2)));
      const Scene scene = tables.scene();
      const Quadric& q = tables.quadrics[0];
      const vec3 o = rounded(exact(center) + 5.0L * random.direction());
      const vec3 d = rounded(normalize(exact(center) + 0.9L * q.radius * random.direction() - exact(o)));
      if (!(intersect_sphere(o, d, q.center, q.radius) > 0)) continue;
      const Surface s = surface_at(&scene, 0, o, d);
      const vec3 out = sample_cosine_hemisphere(s.geometric, random.unit_float(), random.unit_float());
      const vec3 start = leave_surface(s.p, s.geometric, s.error, out);
      ASSERT_LE(intersect_sphere(start, out, q.center, q.radius), 0) << "at " << offset << " ray " << i;
    }
}

TEST(SurfaceOfADisk, PositionIsWithinItsErrorAndRaysLeave) {
  RandomNumbers random(6);
  for (double offset : kOffsets) {
    int count = 0;
    for (int i = 0; i < 20'000 && !testing::Test::HasFatalFailure(); ++i) {
      SceneTables tables;
      const float radius = float(std::max(1.0, offset * 1e-4) * random.between(0.1, 2));
      const vec3 center = rounded(offset * random.direction()), normal = rounded(random.direction());
      tables.add_disk(center, normal, radius);
      const Scene scene = tables.scene();
      const vec3 o = rounded(exact(center) + random.point(3 * radius));
      const Exact3 in_plane = normalize(cross(exact(normal), random.direction()));
      const Exact3 target = exact(center) + (long double)(radius * random.uniform()) * in_plane;
      const vec3 d = rounded(normalize(target - exact(o)));
      if (!(intersect_disk(o, d, center, normal, radius) > 0)) continue;
      ++count;
      const Surface s = surface_at(&scene, 0, o, d);
      const Exact3 unit = normalize(exact(normal));
      const auto height = [&](const vec3& p) { return dot(exact(p) - exact(center), unit); };
      ASSERT_LE(std::abs(height(s.p)), s.error);
      ASSERT_EQ(s.front, dot3(normal, d) < 0);
      const long double side = s.front ? 1 : -1;
      expect_leaves(s, side * unit, random, [&](const vec3& p) { return side * height(p); });
    }
    EXPECT_GT(count, 10'000);
  }
}

TEST(ShadingNormals, AreInterpolatedWhereTheyFaceTheViewer) {
  RandomNumbers random(7);
  int faces[2] = {0, 0};
  for (int i = 0; i < 20'000; ++i) {
    TriangleCase c = random_case(random, 0);
    if (!hits(c)) continue;
    SceneTables tables;
    const ExactTriangle truth(c.triangle);
    c.triangle.normals = 0;
    c.triangle.light = -1;
    tables.triangles.push_back(c.triangle);
    Exact3 n[3];
    for (Exact3& at : n) at = normalize(truth.normal + 0.5L * random.direction());
    tables.normals.push_back({rounded(n[0]), rounded(n[1]), rounded(n[2])});
    const Scene scene = tables.scene();
    const Surface s = surface_at(&scene, 0, c.origin, c.direction);
    // Barycentric coordinates of the position, by areas.
    const Exact3 p1 = exact(c.triangle.p1), p2 = exact(c.triangle.p2), p = exact(s.p);
    const long double whole = dot(truth.area, truth.area);
    const long double edge = std::max(length(p1 - truth.p0), length(p2 - truth.p0));
    if (length(truth.area) < 1e-2L * edge * edge) continue;
    const long double b0 = dot(cross(p1 - p, p2 - p), truth.area) / whole;
    const long double b1 = dot(cross(p2 - p, truth.p0 - p), truth.area) / whole;
    const Exact3 expected = normalize(b0 * n[0] + b1 * n[1] + (1 - b0 - b1) * n[2]);
    const Exact3 shading = (s.front ? 1.0L : -1.0L) * expected, wo = exact(s.wo);
    if (std::abs(dot(shading, wo)) < 1e-3L) continue;  // either will do
    faces[dot(shading, wo) > 0 ? 1 : 0]++;
    ASSERT_LE(length(exact(s.shading) - (dot(shading, wo) > 0 ? shading : exact(s.geometric))), 1e-3L);
    ASSERT_GT(dot3(s.shading, s.wo), 0);
    ASSERT_NEAR(length3(s.shading), 1, 4e-7);
  }
  EXPECT_GT(faces[0], 100) << "the geometric one takes over";
  EXPECT_GT(faces[1], 5000);
}

TEST(ShadingNormals, ThatCancelFallBackToTheGeometricOne) {
  SceneTables tables;
  tables.add_triangle(make_vec3(-1, -1, 0), make_vec3(1, -1, 0), make_vec3(0, 1, 0));
  tables.triangles[0].normals = 0;
  tables.normals.push_back({make_vec3(0, 0, 0), make_vec3(0, 0, 0), make_vec3(0, 0, 0)});
  const Scene scene = tables.scene();
  const Surface s = surface_at(&scene, 0, make_vec3(0, 0, 1), make_vec3(0, 0, -1));
  EXPECT_EQ(s.shading.z, 1);
  EXPECT_EQ(s.geometric.z, 1);
}

TEST(NoSurface, NamesAMaterialWhateverIsThere) {
  // Kernels load the material of rays that miss before they drop it.
  SceneTables tables;
  for (int kind = 0; kind < 3; ++kind) {
    if (kind == 1) tables.add_triangle(make_vec3(0, 0, 0), make_vec3(1, 0, 0), make_vec3(0, 1, 0));
    if (kind == 2) {
      tables.triangles.clear();
      tables.add_sphere(make_vec3(0, 0, 0), 1);
    }
    const Scene scene = tables.scene();
    const Surface s = surface_at(&scene, -1, make_vec3(0, 0, 1), make_vec3(0, 0, 1));
    EXPECT_FALSE(is_hit(s));
    EXPECT_EQ(s.light, -1);
    EXPECT_EQ(s.material, 0);
  }
}

TEST(NoSurface, DoesNotReadAQuadricThatIsNotThere) {
  // A scene without primitives whose table of quadrics overlaps other data.
  SceneTables tables;
  Quadric other_data{};
  other_data.front = other_data.back = 0x3f000000;
  tables.quadrics.push_back(other_data);
  Scene scene = tables.scene();
  scene.header.tables.quadrics.count = 0;
  EXPECT_EQ(surface_at(&scene, -1, make_vec3(0, 0, 1), make_vec3(0, 0, 1)).material, 0);
}

}  // namespace
}  // namespace penumbra
