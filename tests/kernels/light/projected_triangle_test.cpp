// Sampling by projected solid angle against Lambert's formula in extended precision, for triangles all over
// the hemisphere: across the horizon, around the zenith, beside it, and with the zenith on an edge.
#include "kernels/light/projected_triangle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "kernels/math/frame.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::projected_triangle_test {
namespace {

using Polygon = std::vector<Exact3>;
constexpr float kLargestDraw = ONE_MINUS_EPSILON;

/// Vertices relative to the receiver, whose normal is z; counter-clockwise as the receiver sees its front.
struct Triangle3 {
  vec3 p0, p1, p2;
};

std::ostream& operator<<(std::ostream& out, const Triangle3& t) {
  for (const vec3& p : {t.p0, t.p1, t.p2})
    out << std::hexfloat << "(" << p.x << ", " << p.y << ", " << p.z << ") ";
  return out << std::defaultfloat;
}

/// What is above the horizon, counter-clockwise from above.
Polygon clipped(const Triangle3& t) {
  const std::array<Exact3, 3> corners{exact(t.p0), exact(t.p2), exact(t.p1)};
  Polygon polygon;
  for (std::size_t i = 0; i < 3; ++i) {
    const Exact3 a = corners[i], b = corners[(i + 1) % 3];
    if (a.z > 0) polygon.push_back(a);
    if ((a.z > 0) != (b.z > 0)) {
      Exact3 crossing = a + (a.z / (a.z - b.z)) * (b - a);
      crossing.z = 0;
      polygon.push_back(crossing);
    }
  }
  return polygon;
}

long double arc(const Exact3& a, const Exact3& b) { return std::atan2(length(cross(a, b - a)), dot(a, b)); }

/// Lambert's sum over the edges; negative if the polygon is clockwise from above.
long double projected_area(const Polygon& p) {
  long double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Exact3 a = p[i], b = p[(i + 1) % p.size()], g = cross(a, b - a);
    if (length(g) > 0) sum += arc(a, b) * g.z / length(g) / 2;
  }
  return sum;
}

long double perimeter(const Polygon& p) {
  long double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) sum += arc(p[i], p[(i + 1) % p.size()]);
  return sum;
}

/// Angle by which w is outside the polygon; negative inside.
long double outside_by(const Polygon& p, const Exact3& w) {
  long double most = -1;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Exact3 a = p[i], b = p[(i + 1) % p.size()], g = cross(a, b - a);
    if (length(g) > 1e-12L * length(a) * length(b)) most = std::max(most, -dot(g, w) / length(g));
  }
  return most;
}

/// The sine of the smallest angle by which the zenith is inside of an edge.
long double zenith_depth(const Polygon& p) {
  long double least = 1;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Exact3 a = p[i], b = p[(i + 1) % p.size()];
    least = std::min(least, cross(a, b).z / (length(a) * length(b)));
  }
  return least;
}

/// The sine of the smallest angle between the zenith and an edge's great circle.
long double zenith_distance(const Polygon& p) {
  long double least = 1;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Exact3 a = p[i], b = p[(i + 1) % p.size()], g = cross(a, b - a);
    if (length(g) > 1e-12L * length(a) * length(b)) least = std::min(least, std::abs(g.z) / length(g));
  }
  return least;
}

/// How ill-posed the triangle is: an edge that passes near the receiver has an uncertain direction.
long double smallest_distance(const Polygon& p) {
  long double least = INFINITY;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Exact3 a = p[i], b = p[(i + 1) % p.size()];
    const long double size = std::max(length(a), length(b));
    if (length(b - a) > 0) least = std::min(least, length(cross(a, b)) / length(b - a) / size);
    least = std::min(least, length(a) / size);
  }
  return least;
}

ProjectedPolygon project(const Triangle3& t) { return project_triangle(t.p0, t.p1, t.p2); }

/// Random triangles of sizes from 0.003 to 10 at distance 1, some of them special; facing the receiver.
Triangle3 random_triangle(RandomNumbers& random) {
  const double size = std::pow(10.0, random.between(-2.5, 1));
  Exact3 center = random.direction();
  if (random.below(5) == 0) center = {random.between(-.02, .02), random.between(-.02, .02), 1};
  std::array<Exact3, 3> p;
  for (Exact3& corner : p) corner = center + size * random.point(1);
  if (random.below(8) == 0) p[1] = p[0] + 1e-3L * (p[1] - p[0]);               // a short edge
  if (random.below(10) == 0) p[0].z = p[1].z = 0;                              // an edge on the horizon
  if (random.below(10) == 0) p[1] = {p[0].x / 2, p[0].y / 2, p[1].z};          // an edge towards the zenith
  if (random.below(20) == 0) p[1] = {0, 0, 1};                                 // a vertex in the zenith
  if (random.below(20) == 0) p[1] = {-p[0].x, -p[0].y, std::abs(p[0].z) + 1};  // an edge through the zenith
  Triangle3 t{rounded(p[0]), rounded(p[1]), rounded(p[2])};
  if (projected_area(clipped(t)) < 0) std::swap(t.p1, t.p2);
  return t;
}

TEST(ProjectedTriangle, AreaIsLamberts) {
  RandomNumbers random(1);
  long double worst = 0;
  int used = 0, large = 0;
  for (int i = 0; i < 200'000; ++i) {
    const Triangle3 t = random_triangle(random);
    const Polygon polygon = clipped(t);
    const long double truth = projected_area(polygon), half = perimeter(polygon) / 2;
    const float area = project(t).area;
    if (smallest_distance(polygon) < 0.01L) continue;
    large += truth > 1.1L * SMALL_PROJECTED_AREA * half;
    if (truth > 1.1L * SMALL_PROJECTED_AREA * half) {
      ASSERT_GT(area, 0.0f) << t;
    }
    if (truth < 0.9L * SMALL_PROJECTED_AREA * half) {
      ASSERT_EQ(area, 0.0f) << t;
    }
    if (area == 0.0f) continue;
    ++used;
    // Relative to the perimeter: the stated 1.5e-7, and what rounding the clipped vertices adds where
    // an edge passes the receiver closely.
    const long double allowed = 1.5e-7L * 2 * half / std::min(1.0L, 3 * smallest_distance(polygon));
    ASSERT_LT(std::abs(area - truth), allowed) << t << (double)truth;
    worst = std::max(worst, std::abs(area - truth) / truth);
  }
  EXPECT_GT(used, 20'000);
  EXPECT_GT(large, 20'000);
  EXPECT_LT(worst, 1e-3L);
}

TEST(ProjectedTriangle, WholeHemisphereAndNothing) {
  // A triangle close above the receiver and far wider fills the hemisphere.
  const float h = 1e-3f;
  const ProjectedPolygon all =
      project_triangle(make_vec3(0, 100, h), make_vec3(90, -50, h), make_vec3(-90, -50, h));
  EXPECT_NEAR(all.area, std::numbers::pi, 1e-6);
  // From the back, below the horizon, in the horizon's plane, a point.
  EXPECT_EQ(project_triangle(make_vec3(0, 1, 1), make_vec3(-1, -1, 1), make_vec3(1, -1, 1)).area, 0.0f);
  EXPECT_EQ(project_triangle(make_vec3(0, 1, -1), make_vec3(1, -1, -1), make_vec3(-1, -1, -1)).area, 0.0f);
  EXPECT_EQ(project_triangle(make_vec3(2, 1, 0), make_vec3(1, -1, 0), make_vec3(3, -1, 0)).area, 0.0f);
  EXPECT_EQ(project_triangle(make_vec3(1, 1, 1), make_vec3(1, 1, 1), make_vec3(1, 1, 1)).area, 0.0f);
}

TEST(ProjectedTriangle, SamplesAreInside) {
  RandomNumbers random(2);
  const std::array extremes{0.0f, kLargestDraw, 0.5f, 0x1p-24f};
  long double worst = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Triangle3 t = random_triangle(random);
    const Polygon polygon = clipped(t);
    const ProjectedPolygon projected = project(t);
    if (projected.area == 0.0f || smallest_distance(polygon) < 0.01L) continue;
    for (int k = 0; k < 8; ++k) {
      const float u = k < 4 ? extremes[std::size_t(k)] : random.unit_float();
      const float v = k == 7 ? random.unit_float() : extremes[random.below(extremes.size())];
      const Exact3 w = exact(sample_projected_polygon(projected, u, v));
      ASSERT_NEAR((double)length(w), 1, 1e-6) << t << u << ", " << v;
      ASSERT_GE(w.z, 0) << t << u << ", " << v;
      // Azimuths are good to some 5e-7; an arc that passes the zenith at a small distance moves as many times
      // farther.
      const long double outside = outside_by(polygon, w);
      ASSERT_LT(outside, 1e-5L + 5e-7L / std::max(zenith_distance(polygon), 1e-5L)) << t << u << ", " << v;
      worst = std::max(worst, outside);
    }
  }
  RecordProperty("farthest_outside", std::to_string((double)worst));
}

/// The part of the polygon whose azimuth is smaller than w's, for a zenith outside.
long double part_before(const Polygon& p, const Exact3& w) {
  const auto before = [&](const Exact3& a) { return a.x * w.y - a.y * w.x; };
  Polygon part;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Exact3 a = p[i], b = p[(i + 1) % p.size()];
    const long double at_a = before(a), at_b = before(b);
    if (at_a >= 0) part.push_back(a);
    if ((at_a >= 0) != (at_b >= 0)) part.push_back(a + (at_a / (at_a - at_b)) * (b - a));
  }
  return part.size() < 3 ? 0 : projected_area(part) / projected_area(p);
}

TEST(ProjectedTriangle, NewtonsMethodConverges) {
  RandomNumbers random(3);
  int tried = 0, exact_enough = 0;
  for (int i = 0; i < 200'000; ++i) {
    const Triangle3 t = random_triangle(random);
    const Polygon polygon = clipped(t);
    const ProjectedPolygon projected = project(t);
    if (projected.area == 0.0f || smallest_distance(polygon) < 0.01L || zenith_depth(polygon) > -1e-5L)
      continue;
    ++tried;
    const float u = random.unit_float();
    const Exact3 w = exact(sample_projected_polygon(projected, u, random.unit_float()));
    // Rounded vertices alone change the area by some 1e-7 of the perimeter.
    const long double error = std::abs(part_before(polygon, w) - u);
    const long double rounding = 1 + perimeter(polygon) / projected.area;
    ASSERT_LT(error, 1e-3L * std::min(rounding, 4.0L)) << t << u << " area " << projected.area;
    exact_enough += error < 1e-5L * rounding;
  }
  EXPECT_GT(tried, 20'000);
  EXPECT_GE(exact_enough, tried * 0.998);
}

struct Configuration {
  std::string name;
  Triangle3 triangle;
};

void PrintTo(const Configuration& configuration, std::ostream* out) { *out << configuration.name; }

class ProjectedTriangleDensity : public testing::TestWithParam<Configuration> {};

/// Density cos / A is uniform in the plane of the horizon: counts in a grid about the projected polygon.
TEST_P(ProjectedTriangleDensity, ChiSquare) {
  constexpr int kCells = 12, kFine = 100, kSamples = 200'000;
  Triangle3 t = GetParam().triangle;
  if (projected_area(clipped(t)) < 0) std::swap(t.p1, t.p2);
  const Polygon polygon = clipped(t);
  const ProjectedPolygon projected = project(t);
  ASSERT_GT(projected.area, 0.0f);
  RandomNumbers random(4);
  std::vector<vec3> samples;
  double low[2] = {1, 1}, high[2] = {-1, -1};
  for (int i = 0; i < kSamples; ++i) {
    const float u = random.unit_float(), v = random.unit_float();
    const vec3 w = sample_projected_polygon(projected, u, v);
    samples.push_back(w);
    low[0] = std::min(low[0], double(w.x)), high[0] = std::max(high[0], double(w.x));
    low[1] = std::min(low[1], double(w.y)), high[1] = std::max(high[1], double(w.y));
  }
  const double dx = (high[0] - low[0]) / kCells, dy = (high[1] - low[1]) / kCells;
  std::vector<double> observed(kCells * kCells), expected(kCells * kCells);
  for (const vec3& w : samples) {
    const int x = std::min(int((w.x - low[0]) / dx), kCells - 1),
              y = std::min(int((w.y - low[1]) / dy), kCells - 1);
    observed[std::size_t(y * kCells + x)] += 1;
  }
  double total = 0;
  for (int y = 0; y < kCells * kFine; ++y) {
    for (int x = 0; x < kCells * kFine; ++x) {
      const double px = low[0] + (x + .5) * dx / kFine, py = low[1] + (y + .5) * dy / kFine;
      const double z2 = 1 - px * px - py * py;
      if (z2 < 0 || outside_by(polygon, {px, py, std::sqrt(z2)}) > 0) continue;
      expected[std::size_t(y / kFine * kCells + x / kFine)] += 1;
      total += 1;
    }
  }
  // The grid covers the polygon: its area is that of the points inside.
  EXPECT_NEAR(total * dx * dy / (kFine * kFine) / projected.area, 1, 0.01);
  for (double& e : expected) e = std::max(e * kSamples / total, 1e-9);
  EXPECT_GT(statistics::chi_square_test(observed, expected).p, statistics::sidak_significance(0.01, 14));
}

INSTANTIATE_TEST_SUITE_P(
    Configurations, ProjectedTriangleDensity,
    testing::Values(
        Configuration{"Overhead",
                      {make_vec3(.4f, .1f, 1), make_vec3(.9f, .3f, 1), make_vec3(.5f, .9f, 1.2f)}},
        Configuration{"ZenithInside",
                      {make_vec3(-.6f, -.3f, 1), make_vec3(.9f, -.4f, 1), make_vec3(.1f, .8f, .7f)}},
        Configuration{"ZenithOnEdge",
                      {make_vec3(-.5f, -.5f, 1), make_vec3(.5f, .5f, 1), make_vec3(-.3f, .8f, 1)}},
        Configuration{"ZenithIsVertex",
                      {make_vec3(0, 0, 1), make_vec3(.8f, .2f, 1), make_vec3(.1f, .9f, .5f)}},
        Configuration{"OneBelow", {make_vec3(1, .2f, .8f), make_vec3(.3f, 1, .6f), make_vec3(1, 1, -.7f)}},
        Configuration{"TwoBelow",
                      {make_vec3(1, .2f, .8f), make_vec3(.3f, 1, -.6f), make_vec3(1.4f, -1, -.7f)}},
        Configuration{"OneBelowAroundZenith",
                      {make_vec3(-1, .2f, .8f), make_vec3(1, .1f, .5f), make_vec3(0, 3, -.4f)}},
        Configuration{"TwoBelowAroundZenith",
                      {make_vec3(.1f, -.4f, .3f), make_vec3(-2, 1, -.1f), make_vec3(2, 1, -.2f)}},
        Configuration{"OnHorizon", {make_vec3(1, -.5f, 0), make_vec3(1, .7f, 0), make_vec3(.9f, .1f, .4f)}},
        Configuration{"Grazing", {make_vec3(1, -.5f, .01f), make_vec3(1, .7f, .03f), make_vec3(1, .1f, .2f)}},
        Configuration{"Sliver", {make_vec3(-1, .3f, .6f), make_vec3(1, .31f, .6f), make_vec3(1, .37f, .6f)}},
        Configuration{"Wide", {make_vec3(-50, .01f, .2f), make_vec3(50, .01f, .2f), make_vec3(0, 80, .3f)}},
        Configuration{"Small",
                      {make_vec3(.3f, .2f, .7f), make_vec3(.33f, .2f, .7f), make_vec3(.32f, .23f, .7f)}},
        Configuration{"VerticalEdge",
                      {make_vec3(.8f, .4f, .2f), make_vec3(.4f, .2f, 1), make_vec3(.9f, -.2f, .5f)}}),
    [](const auto& tested) { return tested.param.name; });

TEST(Frame, ToFrameUndoesFromFrame) {
  RandomNumbers random(5);
  for (int i = 0; i < 10'000; ++i) {
    const vec3 n = rounded(random.direction()), v = rounded(random.point(1));
    const vec3 local = to_frame(n, from_frame(n, v.x, v.y, v.z));
    // Six roundings of numbers below sqrt(3), and a frame that is orthonormal to some 2e-7.
    EXPECT_NEAR(local.x, v.x, 2e-6);
    EXPECT_NEAR(local.y, v.y, 2e-6);
    EXPECT_NEAR(local.z, v.z, 2e-6);
  }
}

}  // namespace
}  // namespace penumbra::projected_triangle_test
