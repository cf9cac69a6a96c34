// Free flights through homogeneous media: distances, and weights by the balance heuristic over channels.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra {
namespace {

TEST(FlightDepth, IsTheLogarithmOfMoreThanANumbersDigits) {
  RandomNumbers random(1);
  for (int i = 0; i < 200'000; ++i) {
    // Every scale of u and of 1 - u.
    const double size = std::pow(10.0, random.between(-7.2, 0));
    const double from = i % 2 == 0 ? size : 1 - size;
    const float u = std::min(float(std::floor(from * 16777216) / 16777216), ONE_MINUS_EPSILON);
    const float fine = unit_float(hash_uint(unsigned(i)));
    const double number = double(u) + double(fine) / 16777216, truth = -std::log1p(-number);
    // Sums of u and finer digits round to 2^-24 of them; the logarithms are within 3e-7.
    EXPECT_NEAR(flight_depth(u, fine), truth, truth * 5e-7) << u << " " << fine;
  }
  EXPECT_EQ(flight_depth(0, 0), 0);
  EXPECT_NEAR(flight_depth(ONE_MINUS_EPSILON, ONE_MINUS_EPSILON), 48 * std::log(2.0), 1e-4);
}

FlightWeight start() { return {make_vec3(1, 1, 1), make_vec3(1, 1, 1), 1}; }

double channel(const vec3& v, int k) { return channel_of(v, k); }

// What a slab of thickness L lets through and what scatters within it, by all heroes together, against
// exp(-sigma L) and albedo (1 - exp(-sigma L)).
TEST(FlightWeight, GivesEveryChannelItsTransmittanceAndItsScattering) {
  const vec3 extinction = make_vec3(0.2f, 1.5f, 7), albedo = make_vec3(1, 0.5f, 0.8f);
  for (const double length : {1e-3, 0.3, 2.0, 9.0}) {
    double passed[3] = {}, scattered[3] = {};
    for (int hero = 0; hero < 3; ++hero) {
      const double sigma = channel(extinction, hero);
      const FlightWeight through = weigh_homogeneous(start(), extinction, albedo, float(length), false);
      // Simpson's rule over the depth at which it scatters, by the hero's density.
      constexpr int kSteps = 2000;
      for (int k = 0; k < 3; ++k) passed[k] += std::exp(-sigma * length) * channel(through.throughput, k) / 3;
      for (int i = 0; i <= kSteps; ++i) {
        const double t = length * i / kSteps;
        const FlightWeight at = weigh_homogeneous(start(), extinction, albedo, float(t), true);
        const double weight = (i == 0 || i == kSteps ? 1 : (i % 2 == 1 ? 4 : 2)) * length / kSteps / 3;
        for (int k = 0; k < 3; ++k) {
          EXPECT_LE(channel(at.throughput, k), 3.0001 * channel(albedo, k));
          scattered[k] += weight * sigma * std::exp(-sigma * t) * channel(at.throughput, k) / 3;
        }
      }
    }
    for (int k = 0; k < 3; ++k) {
      const double truth = std::exp(-channel(extinction, k) * length);
      EXPECT_NEAR(passed[k], truth, 2e-6 * std::max(truth, 1e-6)) << length;
      EXPECT_NEAR(scattered[k], channel(albedo, k) * (1 - truth), 2e-6) << length;
    }
  }
}

TEST(FlightWeight, OfWhatOnlyAbsorbsIsTheTransmittanceForEveryHero) {
  const vec3 extinction = make_vec3(0.2f, 0, 7);
  FlightWeight before = start();
  before.channels = make_vec3(0.5f, 1, 1.5f);
  before.throughput = make_vec3(3, 2, 1);
  for (const float length : {1e-3f, 0.3f, 9.0f, 1e3f}) {
    const FlightWeight after = weigh_homogeneous(before, extinction, make_vec3(0, 0, 0), length, false);
    for (int k = 0; k < 3; ++k) {
      const double truth = channel(before.throughput, k) * std::exp(-channel(extinction, k) * double(length));
      EXPECT_NEAR(channel(after.throughput, k), truth,
                  1e-6 * (1 + channel(extinction, k) * length) * truth + 1e-37);
      EXPECT_FLOAT_EQ(float(channel(after.channels, k)), float(channel(before.channels, k)));
    }
    EXPECT_FLOAT_EQ(after.density, before.density);
  }
}

TEST(FlightWeight, NothingUnderflowsThatIsAlike) {
  const vec3 albedo = make_vec3(1, 0.9f, 0.1f);
  for (const float sigma : {1e-8f, 1.0f, 1e8f})
    for (const float length : {1e-8f, 1.0f, 1e8f}) {
      const vec3 extinction = make_vec3(sigma, sigma, sigma);
      const FlightWeight passed = weigh_homogeneous(start(), extinction, albedo, length, false);
      const FlightWeight scattered = weigh_homogeneous(start(), extinction, albedo, length, true);
      for (int k = 0; k < 3; ++k) {
        EXPECT_FLOAT_EQ(float(channel(passed.throughput, k)), 1);
        EXPECT_FLOAT_EQ(float(channel(scattered.throughput, k)), float(channel(albedo, k)));
        EXPECT_FLOAT_EQ(float(channel(passed.channels, k)), 1);
      }
      const double depth = double(sigma) * length;
      EXPECT_NEAR(passed.density, std::exp(-depth), 4e-7 * (1 + depth) * std::exp(-depth) + 1e-37);
    }
}

TEST(FlightWeight, OfAHeroThatNothingStopsIsZeroInOtherChannels) {
  const vec3 extinction = make_vec3(0, 1, 2), albedo = make_vec3(1, 1, 1);
  const FlightWeight w = weigh_homogeneous(start(), extinction, albedo, NO_LIMIT, false);
  EXPECT_FLOAT_EQ(w.throughput.x, 3);
  EXPECT_EQ(w.throughput.y, 0);
  EXPECT_EQ(w.throughput.z, 0);
}

}  // namespace
}  // namespace penumbra
