// Phong lobes under polygon lights: against Arvo's recurrence in 113 bits for triangles clipped one by one,
// against quadrature over the light's area, and against closed forms.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/kernels/polygon/polygon_lights.h"

namespace penumbra::polygon_lobe_test {
namespace {

constexpr double kPi = std::numbers::pi;
// In units of a lobe that reflects all that it gets. An arc that crosses the lobe has an error below 1e-10 of
// the quadrature and 1e-11 of the cut; low exponents amplify both by up to 3.7, but their rules of 16 nodes
// are good to 1e-12. Only a few arcs of an outline can cross the lobe at the lengths that are worst for their
// rule.
constexpr double kTolerance = 2e-10;
// Below, an area's quadrature ends, which it does for each of some ten parts.
constexpr double kAreaTolerance = 1e-11;

double truth_of(const PolygonLight& light, const ExactReceiver& r) {
  const double lobe = double(oracle_lobe(quad(light.loops), quad_receiver(r), int(r.exponent)));
  return light.two_sided ? std::abs(lobe) : std::max(lobe, 0.0);
}

double lobe_of(const PolygonLight& light, const ExactReceiver& r) { return polygon_terms_of(light, r).lobe; }

/// A direction some 1e-17 to 0.1 away from `d`.
Exact3 beside(RandomNumbers& random, const Exact3& d) {
  return normalize(normalize(d) + std::pow(10.0, random.between(-17, -1)) * random.direction());
}

/// Turns n or w to the same side.
ExactReceiver facing(RandomNumbers& random, ExactReceiver r) {
  Exact3& other = random.below(2) == 0 ? r.n : r.w;
  if (dot(r.n, r.w) < 0) other = -1.0L * other;
  return r;
}

/// Receivers in the origin that are hard in different ways for this light, `kinds` of them.
constexpr int kKinds = 8;
ExactReceiver hard_receiver(RandomNumbers& random, const PolygonLight& light, int kind, double exponent) {
  const Exact3 a = exact(light.loops[0][0]), b = exact(light.loops[0][1]), c = exact(light.loops[0][2]);
  const Exact3 on_edge = a + random.uniform() * (b - a),
               inside = a + random.uniform() * (on_edge + c - 2 * a);
  ExactReceiver r{{0, 0, 0}, random.direction(), random.direction(), exponent};
  switch (kind) {
    case 0:  // the lobe about the normal
      r.w = r.n;
      break;
    case 1:  // about a corner
      r.w = beside(random, a);
      break;
    case 2:  // about a point of an edge
      r.w = beside(random, on_edge);
      break;
    case 3:
      r.w = beside(random, inside);
      break;
    case 4:  // an edge along the lobe's own horizon
      r.w = beside(random, cross(a, b));
      break;
    case 5:  // grazing reflection
      r.w = beside(random, on_edge);
      r.n = beside(random, cross(r.w, random.direction()));
      break;
    case 6:  // an edge along the horizon
      r.w = beside(random, inside);
      r.n = beside(random, cross(a, b));
      break;
    default:
      break;
  }
  return facing(random, r);
}

struct ExponentCase {
  int exponent, lights;
};

void PrintTo(const ExponentCase& c, std::ostream* out) { *out << c.exponent; }

class PolygonLobeExponent : public testing::TestWithParam<ExponentCase> {};

TEST_P(PolygonLobeExponent, ArvosRecurrence) {
  RandomNumbers random(100);
  int lit = 0;
  for (int i = 0; i < GetParam().lights; ++i) {
    PolygonLight light = random_light(random);
    light.two_sided = random.below(4) != 0;
    const ExactReceiver r = hard_receiver(random, light, i % kKinds, GetParam().exponent);
    const double truth = truth_of(light, r);
    ASSERT_NEAR(lobe_of(light, r), truth, kTolerance) << "kind " << i % kKinds << " " << r << light;
    lit += truth > 1e-3;
  }
  EXPECT_GT(lit, GetParam().lights / 20);
}

INSTANTIATE_TEST_SUITE_P(Exponents, PolygonLobeExponent,
                         testing::Values(ExponentCase{0, 1200}, ExponentCase{1, 1200}, ExponentCase{2, 1200},
                                         ExponentCase{3, 1200}, ExponentCase{5, 1200}, ExponentCase{7, 1200},
                                         ExponentCase{8, 1200}, ExponentCase{9, 1200}, ExponentCase{10, 1200},
                                         ExponentCase{30, 1200}, ExponentCase{100, 800},
                                         ExponentCase{1000, 200}, ExponentCase{10000, 40}),
                         [](const auto& test) { return std::to_string(test.param.exponent); });

/// The smallest w.u over the light's corners.
long double lowest(const PolygonLight& light, const Exact3& w) {
  long double least = 1;
  for (const std::vector<vec3>& loop : light.loops)
    for (const vec3& corner : loop) least = std::min(least, dot(normalize(exact(corner)), w));
  return least;
}

TEST(PolygonLobe, AnyRealExponent) {
  RandomNumbers random(1);
  for (double exponent : {0.01, 0.3, 0.5, 1.5, 3.7, 7.999, 8.001, 33.3, 777.7, 4321.5}) {
    const double width = 1 / std::sqrt(std::max(exponent, 1.0));
    int lit = 0;
    for (int i = 0; i < 60; ++i) {
      const Exact3 center = random.direction();
      const PolygonLight light =
          random_light(random, random_plane(random, center), random.between(.3, .8) * width);
      ExactReceiver r = hard_receiver(random, light, 1 + i % 3, exponent);
      // The area's quadrature needs a smooth integrand: low exponents only up to the lobe's own horizon.
      if (exponent < 4) {
        do r.w = random.direction();
        while (lowest(light, r.w) < .02);
      }
      r = facing(random, r);
      if (exponent < 4 && lowest(light, r.w) < 0) r.n = -1.0L * r.n, r.w = -1.0L * r.w;
      const double truth =
          std::abs(quadrature_lobe(quad(light.loops), quad_receiver(r), exponent, kAreaTolerance));
      EXPECT_NEAR(lobe_of(light, r), truth, kTolerance + 10 * kAreaTolerance) << r << light;
      lit += truth > 1e-3;
    }
    EXPECT_GT(lit, 10) << exponent;
  }
}

TEST(PolygonLobe, OracleIsTheIntegralOverTheArea) {
  RandomNumbers random(2);
  for (int exponent : {0, 1, 2, 7, 40}) {
    for (int i = 0; i < 12; ++i) {
      const PolygonLight light = random_light(random, random_plane(random, random.direction()), .4);
      const ExactReceiver r = hard_receiver(random, light, i % 4, exponent);
      const double area = quadrature_lobe(quad(light.loops), quad_receiver(r), exponent, kAreaTolerance);
      EXPECT_NEAR(double(oracle_lobe(quad(light.loops), quad_receiver(r), exponent)), area,
                  10 * kAreaTolerance)
          << r << light;
    }
  }
}

TEST(PolygonLobe, ExponentZeroIsIrradiance) {
  RandomNumbers random(3);
  int lit = 0;
  for (int i = 0; i < 500; ++i) {
    const PolygonLight light = random_light(random);
    ExactReceiver r{{0, 0, 0}, random.direction(), {}, 0};
    r.w = r.n;
    const PolygonTerms terms = polygon_terms_of(light, r);
    ASSERT_NEAR(terms.lobe, terms.irradiance / kPi, kTolerance) << r << light;
    lit += terms.lobe > 1e-3;
  }
  EXPECT_GT(lit, 100);
}

/// The inside of the cube of half-width 1.
std::vector<PolygonLight> box() {
  std::vector<PolygonLight> faces;
  for (int axis = 0; axis < 3; ++axis) {
    for (float side : {-1.0f, 1.0f}) {
      std::vector<vec3> loop;
      for (int i = 0; i < 4; ++i) {
        const float a = i == 1 || i == 2 ? side : -side, b = i < 2 ? -1 : 1;
        loop.push_back(axis == 0   ? make_vec3(side, b, a)
                       : axis == 1 ? make_vec3(a, side, b)
                                   : make_vec3(b, a, side));
      }
      faces.push_back({{loop}, false});
    }
  }
  return faces;
}

TEST(PolygonLobe, WholeHemisphere) {
  const std::vector<PolygonLight> faces = box();
  RandomNumbers random(4);
  const auto sum = [&](const ExactReceiver& r) {
    PolygonTerms total;
    for (const PolygonLight& face : faces) {
      const PolygonTerms terms = polygon_terms_of(face, r);
      total.irradiance += terms.irradiance;
      total.lobe += terms.lobe;
    }
    return total;
  };
  for (int i = 0; i < 100; ++i) {
    ExactReceiver r{random.point(.9), random.direction(), random.direction()};
    r = facing(random, r);
    EXPECT_NEAR(sum(r).irradiance, kPi, 1e-13);
    // e = 0: half of what the cosine weighs, and the part between the two horizons. e = 1: Cho and Saul's
    // (2009) arc-cosine kernel of order 1.
    const double cosine = double(dot(r.n, r.w)), angle = std::acos(cosine);
    r.exponent = 0;
    EXPECT_NEAR(sum(r).lobe, (1 + cosine) / 2, 6 * kTolerance) << r;
    r.exponent = 1;
    EXPECT_NEAR(sum(r).lobe, (std::sin(angle) + (kPi - angle) * cosine) / kPi, 6 * kTolerance) << r;
    // About the normal a lobe reflects all that it gets.
    r.w = r.n;
    for (double exponent : {0.0, 0.5, 1.0, 2.0, 5.5, 10.0, 100.0, 1234.5, 1e4, 1e6}) {
      r.exponent = exponent;
      EXPECT_NEAR(sum(r).lobe, 1, 6 * kTolerance) << r;
    }
  }
}

TEST(PolygonLobe, LightThatFillsTheLobe) {
  // The integral of (w.u)^e u over the half sphere about w is 2 pi w / (e + 2).
  RandomNumbers random(5);
  for (double exponent : {1e3, 1e4, 1e5, 1e6, 1e8, 1e10}) {
    const double reach = 8 / std::sqrt(exponent);  // beyond it is e^-32 of the lobe
    for (int i = 0; i < 30; ++i) {
      ExactReceiver r{{0, 0, 0}, random.direction(), random.direction(), exponent};
      r = facing(random, r);
      if (dot(r.n, r.w) < 3 * reach) continue;
      const Plane plane{r.w, normalize(cross(r.w, random.direction())), {}};
      const PolygonLight light{{ring({plane.origin, plane.u, cross(r.w, plane.u)}, 4, 2 * reach, 2 * reach)}};
      EXPECT_NEAR(lobe_of(light, r), double(dot(r.n, r.w)), kTolerance) << r;
    }
  }
}

TEST(PolygonLobe, SmallLightsKeepTheirDigits) {
  RandomNumbers random(6);
  for (int exponent : {0, 1, 2, 6, 10, 100, 1000, 10000}) {
    for (double size : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
      const double width = 1 / std::sqrt(std::max(exponent, 1));
      if (size > .3 * width) continue;
      double worst = 0;
      for (int i = 0; i < (exponent > 1000 ? 10 : 40); ++i) {
        const Exact3 center = random.direction(), u = normalize(cross(center, random.direction()));
        const Plane plane{center, u, normalize(cross(center, u) + random.between(-2, 2) * center)};
        const PolygonLight light{{ring(plane, 4, size / 2, size / 2)}};
        // Not in the origin: differences of floats would be exact.
        ExactReceiver r{1e-3L * random.direction(), normalize(center + .5L * random.direction()), {}};
        r.w = normalize(center + random.uniform() * std::min(2 * width, .5) * random.direction());
        r.exponent = exponent;
        worst = std::max(worst, std::abs(lobe_of(light, r) / truth_of(light, r) - 1));
      }
      // As for irradiance: edges of length `size` that are good to a few roundings add up to its square.
      EXPECT_LT(worst, 12 * 0x1p-52 / size) << exponent << ", " << size;
    }
  }
}

TEST(PolygonLobe, SweepsOfTheAxis) {
  // w passes corners, edges and a hole, and the lobe's horizon all of them.
  const Plane plane{{0, 1.5L, 0}, {1, 0, 0}, {0, .1L, 1}};
  const PolygonLight light{{ring(plane, 10, 1, .4), ring(plane, 4, .2, .1, true)}};
  for (int exponent : {0, 1, 4, 50}) {
    double before = 0;
    constexpr int kSteps = 300;
    for (int i = 0; i <= kSteps; ++i) {
      const double t = -1.5 + 3.0 * i / kSteps;
      const ExactReceiver r{{0, 0, 0}, {0, 1, 0}, {std::sin(t), std::cos(t), 0}, double(exponent)};
      const double lobe = lobe_of(light, r);
      ASSERT_NEAR(lobe, truth_of(light, r), kTolerance) << r;
      // Each step moves a lobe of width 1 / sqrt(e) by 0.01; a lobe's total variation along a line is below
      // its number of widths times its largest value, 2.
      if (i > 0) {
        ASSERT_LT(std::abs(lobe - before), .01 * 2 * std::sqrt(exponent + 1.0)) << r;
      }
      before = lobe;
    }
  }
}

TEST(PolygonLobe, LanesDoNotDependOnEachOther) {
  // Neither on the exponents nor on the crossings of the others: LANES may differ between devices.
  RandomNumbers random(7);
  for (int i = 0; i < 60; ++i) {
    const PolygonLight light = random_light(random);
    std::vector<ExactReceiver> receivers;
    for (int k = 0; k < 3 * LANES; ++k) {
      const double exponents[] = {-1, 0, 3, 20, 500, 3e4};
      ExactReceiver r = hard_receiver(random, light, k % kKinds, exponents[random.below(6)]);
      r.x = random.point(.3);
      receivers.push_back(r);
    }
    const std::vector<PolygonTerms> together = polygon_terms_of(light, receivers);
    for (std::size_t k = 0; k < receivers.size(); ++k) {
      const PolygonTerms alone = polygon_terms_of(light, receivers[k]);
      ASSERT_EQ(together[k].irradiance, alone.irradiance) << receivers[k] << light;
      ASSERT_EQ(together[k].lobe, alone.lobe) << receivers[k] << light;
      if (receivers[k].exponent < 0) {
        ASSERT_EQ(alone.lobe, 0.0);
      }
      ASSERT_TRUE(std::isfinite(alone.lobe) && alone.lobe >= 0 && alone.lobe < 2) << receivers[k] << light;
    }
  }
}

TEST(PolygonLobe, FrontAndBackAndFirstCorner) {
  RandomNumbers random(8);
  int front = 0, back = 0;
  for (int i = 0; i < 400; ++i) {
    PolygonLight light = random_light(random);
    const ExactReceiver r = hard_receiver(random, light, i % kKinds, 12);
    const double both = lobe_of(light, r);
    light.two_sided = false;
    const double one = lobe_of(light, r);
    for (std::vector<vec3>& loop : light.loops) {
      std::reverse(loop.begin(), loop.end());
      std::rotate(loop.begin(), loop.begin() + 1, loop.end());
    }
    const double other = lobe_of(light, r);
    // Another first corner joins other crossings of the horizon, by arcs with errors of their own.
    ASSERT_NEAR(one + other, both, kTolerance) << r << light;
    ASSERT_NEAR(std::min(one, other), 0, kTolerance) << r << light;
    front += one > 1e-3;
    back += other > 1e-3;
  }
  EXPECT_GT(front, 20);
  EXPECT_GT(back, 20);
}

TEST(PolygonLobe, DoesNotDependOnTheScaleOrTheOrigin) {
  RandomNumbers random(9);
  const Plane plane{{3, 4, 2}, {1, 0, 0}, {0, 1, 0}};
  const PolygonLight light{{{plane.at(-2, -1), plane.at(3, -1.5L), plane.at(.5L, 2.25L)}}};
  for (int i = 0; i < 200; ++i) {
    ExactReceiver r = hard_receiver(random, light, i % kKinds, 30);
    const double lobe = lobe_of(light, r);
    for (float scale : {0x1p-14f, 0x1p17f}) {
      PolygonLight scaled = light;
      for (vec3& corner : scaled.loops[0]) corner = penumbra::scale(corner, scale);
      ASSERT_EQ(lobe_of(scaled, r), lobe) << r;
    }
    PolygonLight moved = light;
    const vec3 by = make_vec3(0x1p20f, -0x1p20f, 0x1p20f);
    for (vec3& corner : moved.loops[0]) corner = add(corner, by);
    r.x = exact(by);
    ASSERT_EQ(lobe_of(moved, r), lobe) << r;
  }
}

TEST(PolygonLobe, DegenerateLightsAndReceiversOnThem) {
  const std::vector<vec3> square{make_vec3(-1, 0, -1), make_vec3(-1, 0, 1), make_vec3(1, 0, 1),
                                 make_vec3(1, 0, -1)};
  RandomNumbers random(10);
  for (int i = 0; i < 200; ++i) {
    for (double exponent : {0.0, 1.0, 40.0, 5e3}) {
      ExactReceiver r{{0, 0, 0}, random.direction(), random.direction(), exponent};
      if (i % 4 == 0) r.w = {0, 1, 0};
      if (i % 4 == 1) r.n = {0, -1, 0};
      r = facing(random, r);
      const vec3 a = make_vec3(1, 1, 0), b = make_vec3(-1, 1, .5f);
      ASSERT_EQ(lobe_of({{{a, a, a}}}, r), 0.0) << r;
      ASSERT_NEAR(lobe_of({{{a, b, b}}}, r), 0, 1e-14) << r;  // there and back
      const PolygonLight triangle{{{a, b, make_vec3(0, 1, 2)}}};
      ASSERT_NEAR(lobe_of({{{a, a, b, b, b, make_vec3(0, 1, 2)}}}, r), lobe_of(triangle, r), 1e-15) << r;
      const PolygonLight sliver{{{a, b, make_vec3(0, 1, .25f + 1e-7f)}}};
      // Its area is some 1e-7; even a lobe within it reflects less than (e + 2) / (2 pi) times its angle.
      ASSERT_LT(lobe_of(sliver, r), 1e-6 * (exponent + 2)) << r;
      // In the plane of a light outside, inside, on an edge and on a corner.
      for (const Exact3& x :
           {Exact3{3, 0, .5L}, Exact3{.25L, 0, -.5L}, Exact3{1, 0, .25L}, Exact3{1, 0, 1}}) {
        r.x = x;
        const double lobe = lobe_of({{square}}, r);
        ASSERT_TRUE(lobe >= 0 && lobe <= 2) << lobe << " " << r;
        if (x.x == 3) {
          ASSERT_NEAR(lobe, 0, kTolerance) << r;
        }
      }
    }
  }
}

}  // namespace
}  // namespace penumbra::polygon_lobe_test
