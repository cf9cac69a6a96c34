// Ray-triangle intersection against Moeller and Trumbore's in extended precision.
#include "tests/kernels/kernels_under_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/kernels/random_numbers.h"

namespace penumbra {
namespace {

struct ExactHit {
  long double t = 0, b0 = 0, b1 = 0,
              b2 = 0;  ///< distance and barycentric coordinates of the ray's meeting with the plane
  [[nodiscard]] long double depth() const {
    return std::min({b0, b1, b2});
  }  ///< negative outside the triangle
};

/// Moeller and Trumbore 1997, either side.
ExactHit exact_hit(const Exact3& o, const Exact3& d, const Exact3& a, const Exact3& b, const Exact3& c) {
  const Exact3 e1 = b - a, e2 = c - a, p = cross(d, e2), s = o - a, q = cross(s, e1);
  const long double inverse = 1 / dot(e1, p);
  ExactHit hit;
  hit.b1 = inverse * dot(s, p);
  hit.b2 = inverse * dot(d, q);
  hit.b0 = 1 - hit.b1 - hit.b2;
  hit.t = inverse * dot(e2, q);
  return hit;
}

TriangleHit kernel_hit(const vec3& o, const vec3& d, const vec3& a, const vec3& b, const vec3& c) {
  const Shear s = make_shear(d);
  return intersect_sheared(shear_point(s, sub(a, o)), shear_point(s, sub(b, o)), shear_point(s, sub(c, o)));
}

/// Rounding of a sheared vertex, relative to its distance from the origin: the difference, the shear factor
/// (2), the product and the sum, and the same again for the direction's own length.
constexpr double kShearError = 8 * 0x1p-24;

struct RayAndTriangle {
  vec3 o, d, a, b, c;
};

/// False where rounding may decide: edge-on, on the rim.
bool expect_agreement(const RayAndTriangle& in) {
  const Exact3 o = exact(in.o), d = exact(in.d), a = exact(in.a), b = exact(in.b), c = exact(in.c);
  const ExactHit truth = exact_hit(o, d, a, b, c);
  const TriangleHit hit = kernel_hit(in.o, in.d, in.a, in.b, in.c);
  const Exact3 area = cross(b - a, c - a);
  const long double size = std::max({length(b - a), length(c - a), length(c - b)});
  const long double reach = std::max({length(a - o), length(b - o), length(c - o)});
  // Moving every vertex by `error` sideways moves an edge by as much; a barycentric coordinate is a distance
  // from an edge over the triangle's height, seen under the angle of incidence.
  const long double error = kShearError * reach;
  const long double incidence = std::abs(dot(normalize(area), d)) / length(d);
  const long double height = length(area) / size * incidence;
  if (incidence < 1e-3L || height < 100 * error) return false;  // edge-on
  const long double margin = 4 * error / height;
  if (std::abs(truth.depth()) < margin) return false;
  EXPECT_EQ(hit.inside, truth.depth() > 0) << double(truth.depth());
  if (!hit.inside) return true;
  EXPECT_LE(std::abs(hit.t - truth.t) * incidence, 4 * error);
  EXPECT_LE(std::abs(hit.u / hit.det - truth.b0), margin);
  EXPECT_LE(std::abs(hit.v / hit.det - truth.b1), margin);
  EXPECT_LE(std::abs(hit.w / hit.det - truth.b2), margin);
  return true;
}

TEST(Triangle, AgreesWithMoellerTrumbore) {
  RandomNumbers random(1);
  int decided = 0;
  for (int i = 0; i < 300'000 && !testing::Test::HasFailure(); ++i) {
    RayAndTriangle in{rounded(random.point(2)), rounded(random.direction()), rounded(random.point(1)),
                      rounded(random.point(1)), rounded(random.point(1))};
    if (i % 2 == 0) {  // is_directed at the triangle
      const Exact3 target = 0.4L * exact(in.a) + 0.3L * exact(in.b) + 0.3L * exact(in.c);
      in.d = rounded(normalize(target - exact(in.o)));
    }
    decided += expect_agreement(in) ? 1 : 0;
  }
  EXPECT_GT(decided, 290'000);
}

TEST(Triangle, AgreesAtAnyScaleAndDistance) {
  RandomNumbers random(2);
  int decided = 0;
  for (int i = 0; i < 200'000 && !testing::Test::HasFailure(); ++i) {
    const double size = std::pow(10.0, random.between(-4, 5)),
                 offset = size * std::pow(10.0, random.between(-1, 5));
    const Exact3 at = offset * random.direction();
    const auto vertex = [&] { return rounded(at + random.point(size)); };
    RayAndTriangle in{rounded(at + random.point(20 * size)), {}, vertex(), vertex(), vertex()};
    const long double b0 = random.uniform(), b1 = (1 - b0) * random.uniform();
    const Exact3 target = b0 * exact(in.a) + b1 * exact(in.b) + (1 - b0 - b1) * exact(in.c);
    in.d = rounded(normalize(target - exact(in.o)));
    decided += expect_agreement(in) ? 1 : 0;
  }
  EXPECT_GT(decided, 150'000);
}

TEST(Triangle, BothSidesAreHit) {
  const vec3 a = make_vec3(0, 0, 0), b = make_vec3(1, 0, 0), c = make_vec3(0, 1, 0);
  const TriangleHit above = kernel_hit(make_vec3(0.25f, 0.25f, 2), make_vec3(0, 0, -1), a, b, c);
  const TriangleHit below = kernel_hit(make_vec3(0.25f, 0.25f, -2), make_vec3(0, 0, 1), a, b, c);
  EXPECT_TRUE(above.inside);
  EXPECT_TRUE(below.inside);
  EXPECT_EQ(above.t, 2);
  EXPECT_EQ(below.t, 2);
}

TEST(Triangle, AnEdgeBelongsToBothItsTriangles) {
  // The edge function of a shared edge is 0 or has opposite signs for the two.
  RandomNumbers random(3);
  for (int i = 0; i < 200'000; ++i) {
    const vec3 o = rounded(random.point(3)), a = rounded(random.point(1)), b = rounded(random.point(1));
    const long double s = random.uniform();
    const vec3 d = rounded(normalize((1 - s) * exact(a) + s * exact(b) - exact(o)));
    const Shear shear = make_shear(d);
    const vec3 va = shear_point(shear, sub(a, o)), vb = shear_point(shear, sub(b, o));
    const vec3 vc = shear_point(shear, sub(rounded(random.point(1)), o));
    EXPECT_EQ(intersect_sheared(va, vb, vc).w, -intersect_sheared(vb, va, vc).w);
  }
}

TEST(Triangle, NoTriangleSeenEdgeOnHasADistance) {
  const vec3 a = make_vec3(0, 0, 0), b = make_vec3(1, 0, 0), c = make_vec3(0, 1, 0);
  for (const vec3& d : {make_vec3(1, 0, 0), make_vec3(0, -1, 0), make_vec3(0.6f, 0.8f, 0)})
    for (float height : {0.0f, -0.0f, 0.5f}) {
      const TriangleHit h = kernel_hit(make_vec3(-2, 0.25f, height), d, a, b, c);
      EXPECT_FALSE(h.inside && h.t > 0 && h.t < NO_LIMIT) << h.t;
    }
}

TEST(Triangle, CollapsedTrianglesAreNeverHit) {
  RandomNumbers random(4);
  for (int i = 0; i < 100'000; ++i) {
    const vec3 o = rounded(random.point(2)), a = rounded(random.point(1)), b = rounded(random.point(1));
    const vec3 d = rounded(normalize(exact(a) - exact(o)));
    for (const TriangleHit& h :
         {kernel_hit(o, d, a, a, a), kernel_hit(o, d, a, a, b), kernel_hit(o, d, a, b, a)})
      ASSERT_FALSE(h.inside && h.t > 0 && h.t < NO_LIMIT);
  }
}

TEST(Shear, MapsTheDirectionToTheAxis) {
  RandomNumbers random(5);
  for (int i = 0; i < 10'000; ++i) {
    const vec3 d = rounded(random.direction());
    const vec3 along = shear_point(make_shear(d), scale(d, 4.0f));
    EXPECT_NEAR(along.x, 0, 4 * 2 * kShearError);
    EXPECT_NEAR(along.y, 0, 4 * 2 * kShearError);
    EXPECT_NEAR(along.z, 4, 4 * 2 * kShearError);
  }
  for (int axis = 0; axis < 3; ++axis)
    for (float sign : {1.0f, -1.0f}) {
      const vec3 d = make_vec3(axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0);
      const Shear s = make_shear(d);
      EXPECT_EQ(s.axis, axis);
      EXPECT_EQ(s.z, sign);
      EXPECT_EQ(s.x, 0);
      EXPECT_EQ(s.y, 0);
    }
}

TEST(Shear, TiesBetweenAxesStayFinite) {
  const float h = std::sqrt(0.5f), t = std::sqrt(1.0f / 3);
  for (const vec3& d : {make_vec3(h, h, 0), make_vec3(h, 0, -h), make_vec3(0, -h, h), make_vec3(t, -t, t)}) {
    const Shear s = make_shear(d);
    EXPECT_LE(std::abs(s.x), 1.0f);
    EXPECT_LE(std::abs(s.y), 1.0f);
    EXPECT_TRUE(std::isfinite(s.z));
  }
}

}  // namespace
}  // namespace penumbra
