// Pieces of curves against quadrics, the distance to what they are, and the splines that they are made of.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "kernels/host/bounds.h"
#include "scenes/device/curve_pieces.h"
#include "scenes/device/to_vec3.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra::curve_test {
namespace {

constexpr double kPi = std::numbers::pi;

vec3 same(const glm::dvec3& p, double) { return to_vec3(p); }

Curves one(CurveForm form, Curve curve) { return {form, {std::move(curve)}}; }

/// A straight spline from (0, 0, 0) to (0, 0, length).
Curve straight(double length, double first, double last) {
  Curve curve;
  for (int i = -1; i <= 2; ++i) curve.push_back({{0, 0, i * length}, std::lerp(first, last, double(i))});
  return curve;
}

struct Ray {
  vec3 o, d;
};
/// From a sphere of radius `far` about the middle of the curve, to within `reach` of it.
Ray random_ray(RandomNumbers& random, const Exact3& middle, double far, double reach) {
  const vec3 o = rounded(middle + (long double)far * random.direction());
  const Exact3 to = middle + random.point(reach);
  return {o, rounded(normalize(to - exact(o)))};
}

struct Found {
  int piece = -1;
  float t = std::numeric_limits<float>::infinity();
};
Found nearest(const std::vector<Quadric>& pieces, const Ray& ray) {
  Found found;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const float t = intersect_quadric(pieces[i], ray.o, ray.d);
    if (t > 0 && t < found.t) found = {int(i), t};
  }
  return found;
}

TEST(CurvePieces, AStraightTubeIsACylinder) {
  const std::vector<Quadric> pieces = curve_pieces(one(CurveForm::kRound, straight(2, 0.25, 0.25)), same);
  Quadric q{};
  q.kind = QUADRIC_CYLINDER;
  q.normal = make_vec3(0, 0, 1);
  q.radius = 0.25f;
  q.length = 2;
  q.orientation = 1;
  RandomNumbers random(1);
  int hits = 0;
  for (int k = 0; k < 50'000; ++k) {
    const Ray ray = random_ray(random, {0, 0, 1}, 5, 1.2);
    const Found found = nearest(pieces, ray);
    const float t = intersect_quadric(q, ray.o, ray.d);
    const Exact3 at = exact(ray.o) + (long double)std::abs(t) * exact(ray.d);
    // Through an open end a ray meets the inside of a cylinder, but not of a curve.
    const bool outside = t > 0 && dot(exact(ray.d), Exact3{at.x, at.y, 0}) < 0;
    const long double edge = std::min(std::abs(at.z), std::abs(at.z - 2));
    const long double grazing = std::abs(dot(exact(ray.d), Exact3{at.x, at.y, 0}));
    if (t > 0 && (edge < 1e-5 || grazing < 1e-3)) continue;
    ASSERT_EQ(found.piece >= 0, outside) << k;
    if (!outside) continue;
    ++hits;
    ASSERT_NEAR(found.t, t, 1e-5);
    const PrimitivePoint r = point_on_curve(pieces[std::size_t(found.piece)], ray.o, ray.d);
    ASSERT_NEAR(r.normal.x, double(at.x) / 0.25, 1e-4);
    ASSERT_NEAR(r.normal.y, double(at.y) / 0.25, 1e-4);
    ASSERT_NEAR(r.b1, double(at.z) / 2, 1e-5);
    ASSERT_EQ(r.distance, found.t);
  }
  EXPECT_GT(hits, 5000);
}

/// The least of |x - c(s)| - r(s) over a straight piece, by golden sections: it has one minimum.
long double distance_to_balls(const Quadric& q, const Exact3& x) {
  const Exact3 a = exact(q.center), b = exact(q.x_axis);
  const auto off = [&](long double s) {
    return length(x - a - s * (b - a)) - ((1 - s) * q.radius + s * q.length);
  };
  long double low = 0, high = 1;
  constexpr long double kGolden = 0.61803398874989485L;
  for (int i = 0; i < 60; ++i) {
    const long double m = high - kGolden * (high - low), n = low + kGolden * (high - low);
    (off(m) < off(n) ? high : low) = off(m) < off(n) ? n : m;
  }
  return std::min({off(low), off(0), off(1)});
}

TEST(CurvePieces, BallsAreMetAtTheirSurface) {
  RandomNumbers random(2);
  int hits = 0, misses = 0;
  for (int k = 0; k < 1500; ++k) {
    const double first = random.between(0, 0.4), last = random.between(0.01, 0.4);
    const Exact3 a = random.point(1), b = a + random.point(0.6);
    const auto point = [](const Exact3& p, double radius) {
      return ControlPoint{{double(p.x), double(p.y), double(p.z)}, radius};
    };
    const std::vector<Quadric> pieces =
        curve_pieces(one(CurveForm::kBalls, {point(a, first), point(b, last)}), same);
    if (pieces.empty()) continue;
    const Quadric& q = pieces[0];
    const Ray ray = random_ray(random, 0.5L * (a + b), 4, 0.4);
    const float t = intersect_quadric(q, ray.o, ray.d);
    const auto at = [&](long double s) { return exact(ray.o) + s * exact(ray.d); };
    if (t > 0) {
      ++hits;
      ASSERT_NEAR(double(distance_to_balls(q, at((long double)t))), 0, 2e-5) << k;
      // Before, the ray is outside.
      for (int i = 1; i < 8; ++i) ASSERT_GT(distance_to_balls(q, at(t * i / 8.0L)), -1e-5L);
      const PrimitivePoint r = point_on_curve(q, ray.o, ray.d);
      ASSERT_NEAR(double(length(exact(r.p) - at((long double)t))), 0, 2e-5);
      ASSERT_LE(dot3(r.normal, ray.d), 1e-3f);
    } else {
      ++misses;
      // The ray is outside all the way; between the points that are looked at, it is off by s^2 / 8 r.
      long double least = 1;
      for (long double z = 2; z < 6; z += 0.02L) least = std::min(least, distance_to_balls(q, at(z)));
      ASSERT_GT(least, -1e-3L) << k;
    }
  }
  EXPECT_GT(hits, 200);
  EXPECT_GT(misses, 200);
}

TEST(CurvePieces, ATubeIsAsThickAsItsSplineSays) {
  // Of a straight spline from radius 0.1 to 0.3: the balls' envelope, cut at z = 0 and 2.
  const std::vector<Quadric> pieces = curve_pieces(one(CurveForm::kRound, straight(2, 0.1, 0.3)), same);
  RandomNumbers random(3);
  int hits = 0;
  for (int k = 0; k < 20'000; ++k) {
    const Ray ray = random_ray(random, {0, 0, 1}, 5, 1);
    const Found found = nearest(pieces, ray);
    if (found.piece < 0) continue;
    ++hits;
    const Exact3 at = exact(ray.o) + (long double)found.t * exact(ray.d);
    // cos rho = r0 - sin z, with a sine of -0.1.
    const long double rho = std::hypot(at.x, at.y), sine = -0.1L;
    ASSERT_NEAR(double(std::sqrt(1 - sine * sine) * rho - (0.1L - sine * at.z)), 0, 1e-5);
    ASSERT_GT(at.z, -1e-5);
    ASSERT_LT(at.z, 2 + 1e-5);
  }
  EXPECT_GT(hits, 3000);
}

TEST(CurvePieces, ARibbonFacesEveryRay) {
  // A ray meets it where it passes the axis within the width; the depth is that of the axis there.
  const std::vector<Quadric> pieces = curve_pieces(one(CurveForm::kFlat, straight(2, 0.2, 0.2)), same);
  RandomNumbers random(4);
  int hits = 0;
  for (int k = 0; k < 50'000; ++k) {
    const Ray ray = random_ray(random, {0, 0, 1}, 5, 1.2);
    const Exact3 o = exact(ray.o), d = exact(ray.d), z{0, 0, 1};
    const Exact3 across = cross(d, z);
    const long double apart = dot(o, across) / length(across);
    // Where the lines are nearest to each other.
    const long double t = -(d.x * o.x + d.y * o.y) / (d.x * d.x + d.y * d.y);
    const long double height = o.z + t * d.z;
    // In the plane across the ray, the ends are cut across the axis, through its ends.
    const long double lean = 1 - d.z * d.z;
    const bool expected = std::abs(apart) < 0.2L && height > 0 && height < 2;
    const long double margin =
        std::min({std::abs(std::abs(apart) - 0.2L), std::abs(height), std::abs(height - 2)});
    if (margin < 1e-4L || lean < 1e-3L) continue;
    const Found found = nearest(pieces, ray);
    ASSERT_EQ(found.piece >= 0, expected) << k;
    if (!expected) continue;
    ++hits;
    const PrimitivePoint r = point_on_curve(pieces[std::size_t(found.piece)], ray.o, ray.d);
    // b0 is along the axis, b1 across.
    ASSERT_NEAR(r.b0, double(height) / 2, 1e-3);
    ASSERT_NEAR(std::abs(2 * r.b1 - 1), double(std::abs(apart)) / 0.2, 1e-4);
    ASSERT_NEAR(r.normal.z, 0, 1e-5);
    ASSERT_NEAR(dot3(r.normal, ray.d), -double(std::sqrt(lean)), 1e-4);
    // The offset is where the normal, then the tangent, make a right-handed frame.
    const vec3 side = cross3(r.normal, make_vec3(0, 0, 1));
    ASSERT_GE(double(dot3(r.p, side)) * (r.b1 - 0.5), -1e-4);
  }
  EXPECT_GT(hits, 5000);
}

/// A closed spline, nearly a circle of radius 1 in the plane z = 0.
Curve circle(double radius) {
  constexpr int kPoints = 12;
  Curve curve;
  // A uniform B-spline of points at a radius R passes at R (2 + cos(2 pi / n)) / 3.
  const double far = 3 / (2 + std::cos(2 * kPi / kPoints));
  for (int i = 0; i < kPoints + 3; ++i)
    curve.push_back(
        {{far * std::cos(2 * kPi * i / kPoints), far * std::sin(2 * kPi * i / kPoints), 0}, radius});
  return curve;
}

TEST(CurvePieces, ACircleIsAnAnnulusFromAbove) {
  // Between the knots the spline is off by up to 1e-4; pieces are within 0.01 radii of it.
  constexpr double kRadius = 0.05, kOff = 1e-3 + 0.011 * kRadius;
  RandomNumbers random(5);
  for (const CurveForm form : {CurveForm::kRound, CurveForm::kFlat, CurveForm::kCylinder}) {
    const std::vector<Quadric> pieces = curve_pieces(one(form, circle(kRadius)), same);
    for (int k = 0; k < 20'000; ++k) {
      const double rho = random.between(0.9, 1.1), phi = random.between(0, 2 * kPi);
      const Ray ray{make_vec3(float(rho * std::cos(phi)), float(rho * std::sin(phi)), 3),
                    make_vec3(0, 0, -1)};
      if (std::abs(std::abs(rho - 1) - kRadius) < kOff) continue;
      const Found found = nearest(pieces, ray);
      ASSERT_EQ(found.piece >= 0, std::abs(rho - 1) < kRadius) << rho << ' ' << phi << ' ' << int(form);
      if (found.piece < 0) continue;
      const double h = (rho - 1) / kRadius;
      const double height = form == CurveForm::kRound ? kRadius * std::sqrt(1 - h * h) : 0.0;
      // The slope of the height is at most h / sqrt(1 - h^2).
      ASSERT_NEAR(3 - found.t, height, 2 * kOff / std::sqrt(1 - h * h)) << h;
    }
  }
}

TEST(CurvePieces, NeighboursLeaveNoGap) {
  // A strand that bends, seen from all sides: rays at its axis meet it.
  const Curve strand = {{{0, 0, 0}, 0.01},
                        {{0.2, 0, 0.3}, 0.01},
                        {{0, 0.3, 0.6}, 0.01},
                        {{-0.3, 0, 0.9}, 0.01},
                        {{0.1, 0.1, 1.3}, 0.01}};
  RandomNumbers random(6);
  for (const CurveForm form : {CurveForm::kRound, CurveForm::kFlat}) {
    const std::vector<Quadric> pieces = curve_pieces(one(form, strand), same);
    ASSERT_GT(pieces.size(), 10u);
    for (int k = 0; k < 100'000; ++k) {
      const Quadric& q = pieces[random.below(pieces.size())];
      const vec3 at = mix3(q.center, q.x_axis, random.unit_float());
      const bool at_end =
          length3(sub(at, pieces.front().center)) < 0.03f || length3(sub(at, pieces.back().x_axis)) < 0.03f;
      const Exact3 way = random.direction();
      // Rays along the strand may enter by its open ends.
      if (at_end || std::abs(dot(way, exact(q.normal))) > 0.9L) continue;
      const Ray ray{rounded(exact(at) - 3.0L * way), rounded(way)};
      const Found found = nearest(pieces, ray);
      ASSERT_GE(found.piece, 0) << k << " form " << int(form);
      // Boxes hold what is met.
      const Quadric& met = pieces[std::size_t(found.piece)];
      const Box box = bounds_of(met);
      const vec3 p = add_scaled(ray.o, found.t, ray.d);
      const float reach = form == CurveForm::kFlat ? 0.02f : 1e-5f;  // a ribbon may be met before its box
      ASSERT_TRUE(p.x > box.low[0] - reach && p.x < box.high[0] + reach && p.y > box.low[1] - reach &&
                  p.y < box.high[1] + reach && p.z > box.low[2] - reach && p.z < box.high[2] + reach);
    }
  }
}

TEST(CurvePieces, LightThatIsInsideATubeLeavesIt) {
  const std::vector<Quadric> pieces = curve_pieces(one(CurveForm::kRound, circle(0.05)), same);
  RandomNumbers random(7);
  for (int k = 0; k < 20'000; ++k) {
    const double phi = random.between(0, 2 * kPi);
    const Ray ray{make_vec3(float(std::cos(phi)), float(std::sin(phi)), 0), rounded(random.direction())};
    const Found found = nearest(pieces, ray);
    // It may meet another part of the ring, further away.
    if (found.piece >= 0) ASSERT_GT(found.t, 0.05f);
  }
}

TEST(CurvePieces, ExtremesAreLeftOutOrMetAsFiniteNumbers) {
  const auto tube = [](std::vector<glm::dvec3> points, double radius) {
    Curve curve;
    for (const glm::dvec3& p : points) curve.push_back({p, radius});
    return curve;
  };
  EXPECT_TRUE(curve_pieces(one(CurveForm::kRound, straight(1, 0, 0)), same).empty()) << "no thickness";
  EXPECT_TRUE(
      curve_pieces(one(CurveForm::kFlat, tube({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, 0.1)), same)
          .empty())
      << "no length";
  const std::vector<Curve> odd = {tube({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}}, 0.2),
                                  tube({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {1, 0, 0}}, 0.2),
                                  tube({{0, 0, 0}, {1, 0, 0}, {1.0001, 0, 0}, {0, 0, 0.0001}}, 3),
                                  tube({{1e7, 1e7, 0}, {1e7, 1e7, 1}, {1e7, 1e7, 2}, {1e7, 1e7, 3}}, 1),
                                  tube({{0, 0, 0}, {1e-6, 0, 0}, {2e-6, 0, 0}, {3e-6, 0, 0}}, 1e-8),
                                  tube({{0, 0, 0}, {1e15, 0, 0}, {2e15, 1e15, 0}, {3e15, 0, 0}}, 1e14)};
  RandomNumbers random(8);
  for (const CurveForm form : {CurveForm::kRound, CurveForm::kBalls, CurveForm::kFlat, CurveForm::kCylinder})
    for (const Curve& curve : odd)
      for (const Quadric& q : curve_pieces(one(form, curve), same)) {
        const Box box = bounds_of(q);
        for (int k = 0; k < 3; ++k) ASSERT_TRUE(std::isfinite(box.low[k]) && box.low[k] < box.high[k]);
        const double size = double(length3(sub(q.x_axis, q.center))) + q.radius;
        for (int k = 0; k < 50; ++k) {
          const Exact3 at = exact(q.center) + random.point(size);
          const vec3 o = rounded(at + (long double)(3 * size) * random.direction());
          const vec3 d = rounded(normalize(at - exact(o)));
          const float t = intersect_quadric(q, o, d);
          ASSERT_FALSE(std::isnan(t));
          if (!(t > 0)) continue;
          const PrimitivePoint r = point_on_curve(q, o, d);
          ASSERT_TRUE(is_finite3(r.p) && is_finite3(r.normal) && std::isfinite(r.b0) && std::isfinite(r.b1));
          ASSERT_NEAR(length3(r.normal), 1, 1e-3);
        }
      }
}

}  // namespace
}  // namespace penumbra::curve_test
