// Errors from pilots whose distribution is known.
#include "scheduler/advise/pilot_error.h"

#include <gtest/gtest.h>

#include <random>

#include "scheduler/image/metrics/error_metrics.h"

namespace penumbra {
namespace {

const std::vector<PilotTile> kTiles = {{0, 0, 8, 8}, {64, 32, 8, 8}, {8, 0, 8, 8}, {16, 8, 8, 8}};
constexpr std::size_t kValues = 4 * 64 * 3;

/// Batches' means with this mean and variance.
Pilot normal_pilot(double mean, double variance, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> value(mean, std::sqrt(variance));
  Pilot pilot;
  for (int b = 0; b < kPilotBatches; ++b) {
    auto& means = pilot.means.emplace_back(kValues);
    for (float& each : means) each = float(value(random));
  }
  pilot.within.assign(kValues, 0);
  return pilot;
}

double sum(const std::vector<TileError>& errors, double TileError::*part) {
  double all = 0;
  for (const TileError& error : errors) all += error.*part;
  return all;
}

// The sum over V = 768 values of sample variances of B = 4 batches has the relative standard deviation
// sqrt(2 / (B - 1) / V) = 2.9 %. 5 of them are exceeded by chance in 6 of 10^7 cases.
constexpr double kTolerance = 5 * 0.0295;

TEST(PilotError, IsTheRelativeVarianceOfASample) {
  const double mean = 2, variance = 0.01;
  const Pilot pilot = normal_pilot(mean, variance, 1);
  const std::vector<double> reference(kValues, mean);
  const auto errors = tile_errors(pilot, false, kTiles, reference);
  const double expected = 4 * 64 * variance * kPilotSamples / (mean * mean + kRelativeEpsilon);
  EXPECT_NEAR(sum(errors, &TileError::paths), expected, kTolerance * expected);
  EXPECT_EQ(sum(errors, &TileError::photons), 0);
}

TEST(PilotError, TellsPhotonsFromPaths) {
  Pilot pilot = normal_pilot(1, 0.04, 2);
  pilot.within.assign(kValues, 0.01);  // what the samples of a batch show
  const auto errors = tile_errors(pilot, true, kTiles, std::vector<double>(kValues, 1.0));
  const double pixels = 4 * 64, weight = 1 / (1 + kRelativeEpsilon);
  EXPECT_NEAR(sum(errors, &TileError::photons), pixels * 0.03 * weight, kTolerance * pixels * 0.04);
  EXPECT_NEAR(sum(errors, &TileError::paths), pixels * 0.01 * kPilotSamples * weight, 1e-6);
}

TEST(PilotError, ReferenceIsTheMeanOfBlocks) {
  Pilot pilot = normal_pilot(0, 0, 3);
  for (auto& means : pilot.means) means[0] = 16;  // red of the first pixel
  const Pilot* const pilots[] = {&pilot};
  const auto reference = pilot_reference(pilots, kTiles);
  double all = 0;
  for (const double value : reference) all += value;
  EXPECT_DOUBLE_EQ(reference[0], 1);
  EXPECT_DOUBLE_EQ(reference[3 * (3 * 8 + 3)], 1) << "the fourth pixel of the fourth row";
  EXPECT_DOUBLE_EQ(reference[3 * 4], 0) << "the next block";
  EXPECT_DOUBLE_EQ(all, 16);
}

TEST(PilotError, WhatIsMissedIsTheDarkerOnes) {
  const Pilot dark = normal_pilot(1, 1e-4, 4), bright = normal_pilot(3, 1e-4, 5);
  const std::vector<double> reference(kValues, 2.0);
  std::vector<TileError> of_dark(kTiles.size()), of_bright(kTiles.size());
  add_missed(dark, bright, kTiles, reference, of_dark);
  add_missed(bright, dark, kTiles, reference, of_bright);
  const double expected = 4 * 64 * 4.0 / (4 + kRelativeEpsilon) * kPilotBatches * kPilotSamples;
  EXPECT_NEAR(sum(of_dark, &TileError::missed), expected, 0.01 * expected);
  EXPECT_EQ(sum(of_bright, &TileError::missed), 0);
}

TEST(PilotError, NothingIsMissedWithinTheNoise) {
  // The square of the difference has the mean of its variance, so excesses are of its order in some tiles: at
  // most 20 times that in all (a chi-square of one degree of freedom exceeds 20 in 8 of 10^6 cases).
  const double variance = 0.04;
  const Pilot a = normal_pilot(1, variance, 6), b = normal_pilot(1, variance, 7);
  std::vector<TileError> errors(kTiles.size());
  add_missed(a, b, kTiles, std::vector<double>(kValues, 1.0), errors);
  const double of_a_tile = 2 * variance / 64 / kPilotBatches;  // variance of a difference of tiles' means
  const double most = 20 * of_a_tile * 4 * 64 * kPilotBatches * kPilotSamples;
  EXPECT_LT(sum(errors, &TileError::missed), most);
}

}  // namespace
}  // namespace penumbra
