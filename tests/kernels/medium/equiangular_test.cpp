// Equiangular sampling of distances along a ray.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra {
namespace {

struct Case {
  vec3 origin, direction, place;
  float length, size;
};

Case random_case(RandomNumbers& random) {
  const auto anywhere = [&](double size) {
    return make_vec3(float(random.between(-size, size)), float(random.between(-size, size)),
                     float(random.between(-size, size)));
  };
  return {anywhere(1), normalize3(anywhere(1)), anywhere(std::pow(10.0, random.between(-2, 2))),
          random.below(4) == 0 ? NO_LIMIT : float(std::pow(10.0, random.between(-3, 3))),
          random.below(2) == 0 ? 0.0f : float(std::pow(10.0, random.between(-3, 0)))};
}

/// The share of the angle that a part of the ray takes up to `distance`, in double.
double share_before(const EquiangularSegment& s, double length, double distance) {
  const double away = s.away, along = s.along;
  const double from = std::atan2(-along, away), to = std::atan2(length - along, away);
  return (std::atan2(distance - along, away) - from) / (to - from);
}

TEST(EquiangularSegment, DistancesShareTheAngleEvenlyByTheirDensity) {
  RandomNumbers random(3);
  for (int i = 0; i < 20'000; ++i) {
    const Case c = random_case(random);
    const EquiangularSegment s = equiangular_segment(c.origin, c.direction, c.length, c.place, c.size);
    ASSERT_GT(s.angle, 0);
    const double away = s.away, along = s.along, length = c.length;
    const double whole = std::atan2(length - along, away) - std::atan2(-along, away);
    // Differences of nearly equal angles in double round to 1e-16, the function's to some 1e-6 of them.
    EXPECT_NEAR(s.angle, whole, 2e-6 * whole + 1e-15) << i;
    const float u = float(random.uniform());
    const double distance = equiangular_distance(s, u);
    EXPECT_GE(distance, 0);
    EXPECT_LE(distance, length * (1 + 1e-4));
    EXPECT_NEAR(share_before(s, length, distance), u, 4e-6) << i;
    const double beyond = distance - along, density = away / (whole * (away * away + beyond * beyond));
    EXPECT_NEAR(equiangular_pdf(s, float(distance)), density, 1e-4 * density) << i;
  }
}

TEST(EquiangularSegment, ThereIsNoneFromWhereTheRayStarts) {
  const EquiangularSegment s =
      equiangular_segment(make_vec3(1, 2, 3), make_vec3(0, 0, 1), 1, make_vec3(1, 2, 3), 0);
  EXPECT_EQ(s.angle, 0);
}

// By Simpson's rule over both ways of choosing a distance, as in FlightWeight's tests: albedo (1 - exp(-sigma
// L)) of every channel, whatever the shares.
TEST(EquiangularSegment, WeightsGiveEveryChannelItsScattering) {
  const vec3 extinction = make_vec3(0.2f, 1.5f, 7), albedo = make_vec3(1, 0.5f, 0.8f);
  for (const float length : {0.3f, 2.0f, 9.0f}) {
    const EquiangularSegment s =
        equiangular_segment(make_vec3(0, 0, 0), make_vec3(0, 0, 1), length, make_vec3(0.4f, 0, 0.25f), 0);
    const vec3 shares = equiangular_shares(s, length, extinction);
    double scattered[3] = {};
    for (int hero = 0; hero < 3; ++hero) {
      const double sigma = channel_of(extinction, hero), equiangular = channel_of(shares, hero);
      ASSERT_GE(equiangular, 0);
      ASSERT_LE(equiangular, 0.9);
      constexpr int kSteps = 4000;
      for (int i = 0; i <= kSteps; ++i) {
        const double t = double(length) * i / kSteps;
        const double density =
            (1 - equiangular) * sigma * std::exp(-sigma * t) -
            equiangular * std::expm1(-sigma * double(length)) * double(equiangular_pdf(s, float(t)));
        const FlightWeight at = weigh_equiangular({make_vec3(1, 1, 1), make_vec3(1, 1, 1), 1}, extinction,
                                                  albedo, s, shares, length, float(t));
        const double weight =
            (i == 0 || i == kSteps ? 1 : (i % 2 == 1 ? 4 : 2)) * double(length) / kSteps / 3;
        for (int k = 0; k < 3; ++k) {
          EXPECT_LE(channel_of(at.throughput, k), 30.001f * channel_of(albedo, k));
          scattered[k] += weight * density * double(channel_of(at.throughput, k)) / 3;
        }
      }
    }
    for (int k = 0; k < 3; ++k) {
      const double sigma = channel_of(extinction, k);
      EXPECT_NEAR(scattered[k], double(channel_of(albedo, k)) * -std::expm1(-sigma * double(length)), 4e-6)
          << length;
    }
  }
}

}  // namespace
}  // namespace penumbra
