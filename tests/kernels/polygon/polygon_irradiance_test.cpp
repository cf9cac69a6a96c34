// Irradiance from polygon lights: against Lambert's formula in 113 bits for triangles clipped one by one, and
// against published numbers.
#include <gtest/gtest.h>

#include <array>

#include "tests/kernels/polygon/polygon_lights.h"

namespace penumbra::polygon_irradiance_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEpsilon = 0x1p-52;
// Each edge adds an angle times a height, both good to a few roundings of numbers up to pi: at most
// 4 pi epsilon = 2.8e-15 for each of up to ten edges, halved in the end. Directions of edges that pass the
// receiver at a distance of 1e-6 of their length have that many times less digits, which happens in the tests
// with receivers close to the light's plane; what they lose is shared with the next edge.
constexpr double kTolerance = 1.4e-14;

const Exact3 kUp{0, 1, 0};

double truth_of(const PolygonLight& light, const ExactReceiver& r) {
  const double e = double(oracle_irradiance(quad(light.loops), quad_receiver(r)));
  return light.two_sided ? std::abs(e) : std::max(e, 0.0);
}

double irradiance_of(const PolygonLight& light, const ExactReceiver& r) {
  return polygon_terms_of(light, r).irradiance;
}

double of_triangle(const ExactReceiver& r, const std::vector<vec3>& p, bool two_sided) {
  return triangle_irradiance(double(r.x.x), double(r.x.y), double(r.x.z), double(r.n.x), double(r.n.y),
                             double(r.n.z), p[0], p[1], p[2], two_sided);
}

struct PublishedTriangle {
  std::array<Exact3, 3> corners;
  double exact;  ///< radiance of a floor of albedo 0.5 in the origin, for a light of radiance 1
};

// shared/ORACLES.md, section 1.
const PublishedTriangle kPublished[] = {
    {{{{-.443432L, .596366L, .495985L}, {-.320397L, .0677699L, -.229359L}, {.0341197L, .11415L, -.343049L}}},
     0.089839259},
    {{{{.461963L, .397843L, .412747L}, {-.0381582L, .851323L, -.156872L}, {.195443L, .891957L, -.260672L}}},
     0.022920040},
    {{{{.100871L, .289075L, -.422609L}, {-.308386L, .629587L, .423966L}, {-.373132L, .237287L, .351592L}}},
     0.053419540},
    {{{{-.17575L, .639397L, .151268L}, {.318604L, .732996L, .459771L}, {.139095L, .294498L, .478556L}}},
     0.020531391},
    {{{{-.17487L, .447916L, .367201L}, {-.405259L, .249607L, -.354079L}, {.356029L, .0918984L, -.132271L}}},
     0.261739859}};

TEST(PolygonIrradiance, PublishedTriangles) {
  const ExactReceiver floor{{0, 0, 0}, kUp};
  for (const PublishedTriangle& t : kPublished) {
    SCOPED_TRACE(t.exact);
    // The oracle by itself, for the decimal corners: half a unit of the last printed digit.
    const QuadLoops decimal{{quad(t.corners[0]), quad(t.corners[1]), quad(t.corners[2])}};
    EXPECT_NEAR(double(oracle_irradiance(decimal, quad_receiver(floor))) * .5 / kPi, t.exact, 5.1e-10);
    const PolygonLight light{{{rounded(t.corners[0]), rounded(t.corners[1]), rounded(t.corners[2])}}, false};
    const double irradiance = irradiance_of(light, floor);
    EXPECT_NEAR(irradiance, truth_of(light, floor), 1e-15 * kPi);
    // Corners rounded to float move by up to 5e-8 at a distance of 0.3 and more, along a perimeter of up to
    // 4 radians: 7e-7 in the irradiance at most.
    EXPECT_NEAR(irradiance * .5 / kPi, t.exact, 7e-7 * .5 / kPi);
    EXPECT_EQ(of_triangle(floor, light.loops[0], false), irradiance);
  }
}

TEST(PolygonIrradiance, RandomLights) {
  RandomNumbers random(1);
  int lit = 0;
  for (int i = 0; i < 3'000; ++i) {
    PolygonLight light = random_light(random);
    light.two_sided = random.below(2) == 0;
    const ExactReceiver r{{0, 0, 0}, random.direction()};
    const double truth = truth_of(light, r);
    ASSERT_NEAR(irradiance_of(light, r), truth, kTolerance) << r << light;
    lit += truth > 1e-6;
  }
  EXPECT_GT(lit, 1'000);
}

TEST(PolygonIrradiance, IsTheIntegralOverTheArea) {
  RandomNumbers random(2);
  int lit = 0;
  for (int i = 0; i < 100; ++i) {
    const PolygonLight light = random_light(random, random_plane(random, random.direction()), .5);
    ExactReceiver r{{0, 0, 0}, random.direction()};
    r.w = r.n;
    const double area = std::abs(quadrature_lobe(quad(light.loops), quad_receiver(r), 0, 1e-11));
    // The quadrature gives irradiance / pi; its tolerance is that of each of its parts.
    EXPECT_NEAR(irradiance_of(light, r) / kPi, area, 1e-10) << r << light;
    lit += area > 1e-3;
  }
  EXPECT_GT(lit, 20);
}

TEST(PolygonIrradiance, DiskBetweenPolygons) {
  // Of a disk seen under the angle theta it is pi sin^2 theta; N-gons inside and outside have N-gon
  // apothems shorter and longer by a factor of cos(pi / N), and areas by about as much.
  constexpr int kCorners = 1000;
  const double ratio = std::cos(kPi / kCorners);
  for (double theta : {0.01, 0.3, 0.8, 1.3, 1.5}) {
    const Plane plane{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}};
    const double radius = std::tan(theta), disk = kPi * std::sin(theta) * std::sin(theta);
    const ExactReceiver r{{0, 0, 0}, kUp};
    const double inner = irradiance_of({{ring(plane, kCorners, radius, radius)}}, r);
    const double outer = irradiance_of({{ring(plane, kCorners, radius / ratio, radius / ratio)}}, r);
    EXPECT_LT(inner, disk) << theta;
    EXPECT_GT(outer, disk) << theta;
    EXPECT_LT(outer - inner, 2 * disk * (1 / (ratio * ratio) - 1)) << theta;
  }
}

TEST(PolygonIrradiance, PartsAddUp) {
  RandomNumbers random(3);
  int crossing = 0;
  for (int i = 0; i < 500; ++i) {
    const Plane plane = random_plane(random, random.direction());
    const double size = std::pow(10.0, random.between(-2, 1));
    const std::vector<vec3> star = ring(plane, 10, size, .4 * size),
                            hole = ring(plane, 4, .3 * size, .2 * size);
    const ExactReceiver r{{0, 0, 0}, random.direction()};
    // The star's points and its inner pentagon, as triangles. All are seen from the same side.
    const PolygonLight whole{{star}};
    double sum = 0;
    for (std::size_t k = 0; k < 10; k += 2) {
      const vec3 &before = star[(k + 9) % 10], &after = star[(k + 1) % 10];
      sum += of_triangle(r, {before, star[k], after}, true) +
             of_triangle(r, {plane.at(0, 0), before, after}, true);
    }
    const double irradiance = irradiance_of(whole, r);
    EXPECT_NEAR(irradiance, sum, kTolerance) << r << whole;
    // A hole takes away what it would add.
    const PolygonLight rest{{star, {hole.rbegin(), hole.rend()}}};
    EXPECT_NEAR(irradiance_of(rest, r), irradiance - irradiance_of({{hole}}, r), kTolerance) << r << rest;
    int above = 0;
    for (const vec3& corner : star) above += dot(exact(corner), r.n) > 0;
    crossing += above > 0 && above < 10;
  }
  EXPECT_GT(crossing, 100);
}

TEST(PolygonIrradiance, SweepsThroughTheHorizon) {
  const Plane plane{{1.5L, .2L, .1L}, {0, 1, 0}, {0, .1L, 1}};
  const PolygonLight light{{ring(plane, 10, 1, .4), ring(plane, 4, .2, .1, true)}};
  constexpr int kSteps = 4000;
  double before = 0;
  for (int i = 0; i <= kSteps; ++i) {
    // The horizon meets every corner, and edges at all angles.
    const double t = 2 * kPi * i / kSteps;
    const ExactReceiver r{{0, 0, 0}, normalize(Exact3{std::cos(t), std::sin(t), .3L * std::sin(3 * t)})};
    const double irradiance = irradiance_of(light, r);
    ASSERT_NEAR(irradiance, truth_of(light, r), kTolerance) << r;
    // The normal turns by less than 1.4 radians for each of t, and the integral of |n.u - n'.u| over all
    // directions is at most pi times the angle.
    if (i > 0) {
      ASSERT_LT(std::abs(irradiance - before), 1.4 * kPi * 2 * kPi / kSteps);
    }
    before = irradiance;
  }
}

TEST(PolygonIrradiance, CornersOnTheHorizon) {
  // Exactly: corners with n.p = 0, one, two or all, where the rest is above or below.
  const ExactReceiver r{{0, 0, 0}, kUp};
  const vec3 a = make_vec3(1, 0, -1), b = make_vec3(1, 0, 1), c = make_vec3(2, 0, .5f);
  const vec3 high = make_vec3(1, 1, .25f), low = make_vec3(1, -1, .25f), higher = make_vec3(1, 2, -.5f);
  for (const std::vector<vec3>& loop : std::vector<std::vector<vec3>>{{a, b, high},
                                                                      {a, high, higher},
                                                                      {a, high, low},
                                                                      {a, b, low},
                                                                      {a, low, make_vec3(1, -2, 0)},
                                                                      {a, high, b, low},
                                                                      {a, higher, high, b}}) {
    const PolygonLight light{{loop}};
    EXPECT_NEAR(irradiance_of(light, r), truth_of(light, r), 1e-15) << light;
  }
  EXPECT_EQ(irradiance_of({{{a, b, low}}}, r), 0.0);
  EXPECT_EQ(irradiance_of({{{a, b, c}}}, r), 0.0);  // the light's plane is the horizon's
}

TEST(PolygonIrradiance, DoesNotDependOnTheFirstCornerOrTheAxes) {
  RandomNumbers random(4);
  for (int i = 0; i < 500; ++i) {
    PolygonLight light = random_light(random);
    ExactReceiver r{{0, 0, 0}, random.direction()};
    const double irradiance = irradiance_of(light, r);
    PolygonLight shifted = light;
    for (std::vector<vec3>& loop : shifted.loops) std::rotate(loop.begin(), loop.begin() + 1, loop.end());
    ASSERT_NEAR(irradiance_of(shifted, r), irradiance, kTolerance) << r << light;
    // A turn about (1, 1, 1) and one about z: exact for corners in float.
    const auto turned = [](auto v) { return decltype(v){v.y, -v.z, -v.x}; };
    for (std::vector<vec3>& loop : light.loops)
      for (vec3& corner : loop) corner = turned(corner);
    r.n = turned(r.n);
    ASSERT_NEAR(irradiance_of(light, r), irradiance, kTolerance) << r << light;
  }
}

TEST(PolygonIrradiance, DoesNotDependOnTheScaleOrTheOrigin) {
  RandomNumbers random(5);
  for (int i = 0; i < 300; ++i) {
    // Corners are multiples of 1/8 up to 16: as floats they can be moved by 2^20 exactly.
    PolygonLight light{{{}}};
    for (int k = 0; k < 5; ++k) {
      const auto coordinate = [&] { return float(int(random.below(256)) - 128) / 8; };
      const float x = coordinate(), y = coordinate();
      light.loops[0].push_back(make_vec3(x, y, coordinate()));
    }
    ExactReceiver r{{random.between(-4, 4), random.between(-4, 4), random.between(-4, 4)},
                    random.direction()};
    for (long double* x : {&r.x.x, &r.x.y, &r.x.z}) *x = std::round(*x * 0x1p20L) * 0x1p-20L;
    const double irradiance = irradiance_of(light, r);
    for (float scale : {0x1p-14f, 0x1p17f}) {
      PolygonLight scaled = light;
      for (vec3& corner : scaled.loops[0]) corner = penumbra::scale(corner, scale);
      const ExactReceiver there{(long double)scale * r.x, r.n};
      ASSERT_EQ(irradiance_of(scaled, there), irradiance) << r << light;
    }
    for (float shift : {1024.0f, 0x1p20f}) {
      PolygonLight moved = light;
      const vec3 by = make_vec3(shift, -shift, shift);
      for (vec3& corner : moved.loops[0]) corner = add(corner, by);
      ASSERT_EQ(irradiance_of(moved, {r.x + exact(by), r.n}), irradiance) << r << light;
    }
  }
}

TEST(PolygonIrradiance, SmallLightsKeepTheirDigits) {
  RandomNumbers random(6);
  for (double size : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    double worst = 0;
    for (int i = 0; i < 200; ++i) {
      const Exact3 center = random.direction(), u = normalize(cross(center, random.direction()));
      const Plane plane{center, u, normalize(cross(center, u) + random.between(-2, 2) * center)};
      const PolygonLight light{{ring(plane, 4, size / 2, size / 2)}};
      // Not in the origin: differences of floats would be exact.
      const ExactReceiver r{1e-3L * random.direction(), normalize(center + .8L * random.direction())};
      const double truth = truth_of(light, r);
      worst = std::max(worst, std::abs(irradiance_of(light, r) / truth - 1));
    }
    // The sum of four edges of angles of about 0.7 size, each rounded a few times, is some size^2 / 4.
    EXPECT_LT(worst, 10 * kEpsilon / size) << size;
  }
}

TEST(PolygonIrradiance, SliversAndRepeatedCorners) {
  RandomNumbers random(7);
  for (int i = 0; i < 500; ++i) {
    const Plane plane = random_plane(random, random.direction());
    const double thin = random.below(2) == 0 ? 1e-7 : 1e-5;
    const vec3 a = plane.at(-1, 0), b = plane.at(1, thin), c = plane.at(random.between(-1, 1), -thin);
    const ExactReceiver r{{0, 0, 0}, random.direction()};
    const PolygonLight sliver{{{a, b, c}}};
    const double irradiance = irradiance_of(sliver, r);
    ASSERT_NEAR(irradiance, truth_of(sliver, r), kTolerance) << r << sliver;
    ASSERT_EQ(irradiance_of({{{a, a, b, c, c, c}}}, r), irradiance) << r << sliver;
    ASSERT_EQ(irradiance_of({{{a, a, a}}}, r), 0.0) << r;
    ASSERT_LT(irradiance_of({{{a, b, a, b}}}, r), kTolerance) << r;
  }
}

TEST(PolygonIrradiance, FrontAndBack) {
  RandomNumbers random(8);
  int front = 0, back = 0;
  for (int i = 0; i < 300; ++i) {
    PolygonLight light = random_light(random);
    const ExactReceiver r{{0, 0, 0}, random.direction()};
    const double both = irradiance_of(light, r);
    light.two_sided = false;
    const double one = irradiance_of(light, r);
    for (std::vector<vec3>& loop : light.loops) std::reverse(loop.begin(), loop.end());
    const double other = irradiance_of(light, r);
    ASSERT_NEAR(one + other, both, kTolerance);
    ASSERT_NEAR(std::min(one, other), 0, kTolerance);
    front += one > 1e-3;
    back += other > 1e-3;
  }
  EXPECT_GT(front, 20);
  EXPECT_GT(back, 20);
}

TEST(PolygonIrradiance, ReceiverInTheLightsPlane) {
  // The light is on the floor, its front up; receivers are in its plane or on its outline.
  const std::vector<vec3> square{make_vec3(-1, 0, -1), make_vec3(-1, 0, 1), make_vec3(1, 0, 1),
                                 make_vec3(1, 0, -1)};
  RandomNumbers random(9);
  for (int i = 0; i < 300; ++i) {
    const Exact3 n = random.direction();
    for (bool two_sided : {false, true}) {
      const PolygonLight light{{square}, two_sided};
      // Outside: nothing of it is seen.
      for (const Exact3& x : {Exact3{3, 0, .5L}, Exact3{1.5L, 0, -4}, Exact3{-1, 0, 2}, Exact3{2, 0, 2}})
        EXPECT_NEAR(irradiance_of(light, {x, n}), 0, kTolerance);
      // Inside: half of all directions, either those below or, from the back of it, those above.
      const double inside = irradiance_of(light, {{.25L, 0, -.5L}, n});
      const double below = kPi * double(1 - n.y) / 2, above = kPi * double(1 + n.y) / 2;
      EXPECT_LT(std::min(std::abs(inside - below), std::abs(inside - (two_sided ? above : 0))), kTolerance)
          << inside << " " << below << " " << above;
      // On an edge or a corner: anything that a light can do.
      for (const Exact3& x : {Exact3{1, 0, .25L}, Exact3{0, 0, -1}, Exact3{1, 0, 1}, Exact3{-1, 0, 1}}) {
        const double edge = irradiance_of(light, {x, n});
        EXPECT_TRUE(edge >= 0 && edge <= kPi) << edge;
      }
    }
  }
}

TEST(PolygonIrradiance, AntipodalCorners) {
  // The receiver is on an edge between two corners exactly; the limits from in front and from behind.
  const PolygonLight light{{{make_vec3(-1, 0, 0), make_vec3(2, 0, 0), make_vec3(0, 1, -1)}}};
  const ExactReceiver r{{0, 0, 0}, kUp};
  const double there = irradiance_of(light, r);
  EXPECT_TRUE(there >= 0 && there <= kPi) << there;
  for (double distance : {1e-3, 1e-6, 1e-9, 1e-12}) {
    for (double side : {1.0, -1.0}) {
      const ExactReceiver close{{0, side * distance, side * distance * .5}, kUp};
      EXPECT_NEAR(irradiance_of(light, close), truth_of(light, close), kTolerance) << distance;
    }
  }
}

TEST(PolygonIrradiance, TrianglesOneByOneAreTheSame) {
  RandomNumbers random(10);
  for (int i = 0; i < 1000; ++i) {
    const Plane plane = random_plane(random, random.direction());
    std::vector<vec3> p;
    for (int k = 0; k < 3; ++k) p.push_back(plane.at(random.between(-2, 2), random.between(-2, 2)));
    const ExactReceiver r{random.point(.5), random.direction()};
    for (bool two_sided : {false, true})
      ASSERT_EQ(of_triangle(r, p, two_sided), irradiance_of({{p}, two_sided}, r));
  }
}

}  // namespace
}  // namespace penumbra::polygon_irradiance_test
