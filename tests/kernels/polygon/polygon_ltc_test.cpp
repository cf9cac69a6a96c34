// Linearly transformed cosines under polygon lights: against quadrature of their density over the light's
// area, and against Lambert's formula in 113 bits in the cosine's space.
#include <gtest/gtest.h>

#include <algorithm>

#include "scenes/device/ltc/ltc_fit.h"
#include "scenes/device/ltc/ltc_table.h"
#include "tests/kernels/polygon/polygon_lights.h"

namespace penumbra::polygon_ltc_test {
namespace {

/// The receiver's lobe in the tests' own terms.
struct TestLobe {
  Exact3 t, b, n;
  ltc::Transform transform;
};

TestLobe lobe_of(const ExactReceiver& r) {
  TestLobe lobe;
  lobe.n = r.n;
  lobe.t = normalize(r.w - dot(r.w, r.n) * r.n);
  lobe.b = cross(lobe.n, lobe.t);
  lobe.transform = {1 / r.inverse_x, 1 / r.inverse_y, r.shift};
  return lobe;
}

/// A receiver in the origin with the lobe of some roughness from 1e-3 to 1 under some angle, now and then
/// next to the normal or to grazing; turned so that the lobe is towards `toward` for one in two.
ExactReceiver random_receiver(RandomNumbers& random, const Exact3& toward) {
  ExactReceiver r{{0, 0, 0}, random.direction()};
  if (random.below(2) == 0) r.n = normalize(normalize(toward) + random.uniform() * random.direction());
  Exact3 w = random.below(2) == 0 ? normalize(toward) : random.direction();
  if (random.below(6) == 0) w = r.n + std::pow(10.0, random.between(-6, -1)) * random.direction();
  if (random.below(6) == 0) w = w + (std::pow(10.0, random.between(-5, -1)) - dot(w, r.n)) * r.n;
  if (dot(w, r.n) < 0) w = -1.0L * w;
  r.w = normalize(w);
  const double alpha = std::pow(10.0, random.between(-3, 0)), cosine = double(dot(r.w, r.n));
  const ltc::Cell cell{
      .lean = random.uniform(), .width_x = random.between(.5, 1.2), .width_y = random.between(.5, 1.2)};
  const ltc::Transform m = ltc::transform_of(cell, alpha, std::max(cosine, 1e-4));
  r.inverse_x = 1 / m.width_x;
  r.inverse_y = 1 / m.width_y;
  r.shift = m.shift;
  return r;
}

double truth_of(const PolygonLight& light, const ExactReceiver& r) {
  const TestLobe lobe = lobe_of(r);
  QuadLoops loops = quad(light.loops);
  const Quad3 t = quad(lobe.t), b = quad(lobe.b), n = quad(lobe.n);
  for (QuadLoop& loop : loops)
    for (Quad3& p : loop) {
      const Quad z = dot(n, p);
      p = {(dot(t, p) - r.shift * z) * r.inverse_x, dot(b, p) * r.inverse_y, z};
    }
  const double e = double(oracle_irradiance(loops, quad_receiver({{0, 0, 0}, {0, 0, 1}}))) / std::numbers::pi;
  return light.two_sided ? std::abs(e) : std::max(e, 0.0);
}

// As polygon_irradiance_test's for pi times the integral, with edges that the transform turns towards the
// receiver: the axis t is rounded to double, which the lobe's width makes 1000 times as much.
constexpr double kTolerance = 2e-12;

TEST(PolygonLtc, LambertInTheCosinesSpace) {
  RandomNumbers random(1);
  int lit = 0, crossing = 0;
  for (int i = 0; i < 4'000; ++i) {
    PolygonLight light = random_light(random);
    light.two_sided = random.below(3) != 0;
    const ExactReceiver r = random_receiver(random, exact(light.loops[0][0]));
    const double truth = truth_of(light, r);
    ASSERT_NEAR(polygon_terms_of(light, r).lobe, truth, kTolerance) << r << light;
    lit += truth > 1e-3;
    const auto above = [&](const vec3& p) { return dot(exact(p), r.n) > 0; };
    crossing += std::any_of(light.loops[0].begin(), light.loops[0].end(), above) &&
                !std::all_of(light.loops[0].begin(), light.loops[0].end(), above);
  }
  EXPECT_GT(lit, 800);
  EXPECT_GT(crossing, 400);
}

TEST(PolygonLtc, IsTheIntegralOfItsDensity) {
  RandomNumbers random(2);
  int lit = 0, clipped = 0;
  for (int i = 0; i < 300; ++i) {
    const Exact3 center = random.direction();
    PolygonLight light = random_light(random, random_plane(random, center), random.between(.02, .6));
    const ExactReceiver r = random_receiver(random, center);
    const TestLobe lobe = lobe_of(r);
    const auto density = [&](double x, double y, double z) {
      const Exact3 u{x, y, z};
      const double height = double(dot(u, lobe.n));
      if (height <= 0) return 0.0;
      return lobe.transform({double(dot(u, lobe.t)), double(dot(u, lobe.b)), height}) / height;
    };
    // Only lobes that the quadrature can resolve.
    if (r.inverse_y > 100 || r.inverse_x > 100) continue;
    const double e = quadrature(quad(light.loops), quad_receiver(r), density, 1e-12);
    const double truth = std::abs(e), form = polygon_terms_of(light, r).lobe;
    EXPECT_NEAR(form, truth, 1e-9 * truth + 1e-11) << r << light;
    lit += truth > 1e-3;
    clipped += dot(exact(light.loops[0][0]), r.n) < 0 ? 1 : 0;
  }
  EXPECT_GT(lit, 80);
  EXPECT_GT(clipped, 20);
}

TEST(PolygonLtc, AllDirectionsAreOne) {
  // A square so large that it covers the hemisphere but for a rim below it.
  RandomNumbers random(3);
  for (int i = 0; i < 200; ++i) {
    ExactReceiver r = random_receiver(random, random.direction());
    r.n = {0, 1, 0};
    const Exact3 across = normalize(Exact3{random.between(-1, 1), 0, random.between(-1, 1)});
    r.w = normalize(across + random.uniform() * r.n);
    const Plane ceiling{{0, 1e-3L, 0}, {1, 0, 0}, {0, 0, 1}};
    const PolygonLight light{{ring(ceiling, 8, 1e9, 1e9)}};
    // Beyond an elevation of 1e-12 of the plane: at most that times the largest density over the cosine
    // there.
    const double rim = 1e-12 * r.inverse_x * r.inverse_y * (1 + r.shift * r.shift);
    EXPECT_NEAR(polygon_terms_of(light, r).lobe, 1, 1e-11 + rim) << r;
  }
}

TEST(PolygonLtc, LanesAreIndependent) {
  RandomNumbers random(4);
  for (int i = 0; i < 50; ++i) {
    const PolygonLight light = random_light(random);
    std::vector<ExactReceiver> receivers;
    for (int j = 0; j < 16; ++j) {
      ExactReceiver r = random_receiver(random, exact(light.loops[0][0]));
      if (j % 3 == 1) r.inverse_x = r.inverse_y = 0, r.exponent = 7.5;  // a Phong lobe
      if (j % 3 == 2) r.inverse_x = r.inverse_y = 0;                    // none
      receivers.push_back(r);
    }
    const std::vector<PolygonTerms> together = polygon_terms_of(light, receivers);
    for (std::size_t j = 0; j < receivers.size(); ++j) {
      const PolygonTerms alone = polygon_terms_of(light, receivers[j]);
      EXPECT_EQ(together[j].lobe, alone.lobe) << j;
      EXPECT_EQ(together[j].irradiance, alone.irradiance) << j;
    }
  }
}

}  // namespace
}  // namespace penumbra::polygon_ltc_test
