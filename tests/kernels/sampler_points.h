// A common interface to the samplers for their tests: the numbers of a (seed, pixel, sample, pair).
#pragma once

#include <cmath>
#include <cstdint>
#include <ostream>
#include <string>

#include "kernels/host/block_memory.h"
#include "tests/kernels/kernels_under_test.h"

namespace penumbra {

struct SampleAddress {
  std::uint32_t seed = 0, x = 0, y = 0, index = 0, pair = 0;
  std::uint32_t spp = 16;
};

struct Point2 {
  float u = 0, v = 0;
};

/// By sample_pair, as the integrators do; all lanes ask for the same address.
inline Point2 draw(int sampler, const SampleAddress& at) {
  static BlockMemory memory(FEATURE_ALL, LANES, 0);
  const PathState paths = memory.block().paths;
  for (int j = 0; j < LANES; ++j) {
    set_pixel_hash(&paths, j, int(pixel_sequence(sampler, at.seed, at.x, at.y)));
    set_sample_index(&paths, j, int(at.index));
  }
  float u[LANES], v[LANES];
  sample_pair(sampler, at.spp, one_point(at.pair), &paths, 0, u, v);
  return {u[0], v[0]};
}

/// The same without the lanes, for loops over many points.
inline Point2 draw_alone(int sampler, const SampleAddress& at) {
  const uint pixel = pixel_sequence(sampler, at.seed, at.x, at.y);
  Point2 p;
  switch (sampler) {
    case SAMPLER_INDEPENDENT:
      independent_pair(pixel, at.index, at.pair, &p.u, &p.v);
      break;
    case SAMPLER_STRATIFIED:
      stratified_pair(pixel, at.index, at.pair, at.spp, &p.u, &p.v);
      break;
    case SAMPLER_HALTON:
      halton_pair(pixel, at.index, at.pair, &p.u, &p.v);
      break;
    default:
      tile_pair(pixel, at.index, point_bits(at.spp), at.pair, &p.u, &p.v);
      break;
  }
  return p;
}

/// A smooth integrand: no periodicity, no product that a stratum's centre gets right.
inline double smooth(Point2 p) { return std::exp(-double(p.u) * p.u - double(p.v) * p.v); }
inline const double kSmoothTruth = std::pow(0.5 * std::sqrt(std::acos(-1.0)) * std::erf(1.0), 2);

constexpr int kSamplers[] = {SAMPLER_INDEPENDENT, SAMPLER_STRATIFIED, SAMPLER_HALTON, SAMPLER_SOBOL};

inline std::string sampler_name(int sampler) {
  const char* names[] = {"Independent", "Stratified", "Halton", "Sobol"};
  return names[sampler];
}

}  // namespace penumbra
