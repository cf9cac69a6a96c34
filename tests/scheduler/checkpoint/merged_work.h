// A film into which some of the passes are merged, for tests of checkpoints.
#pragma once

#include "scheduler/checkpoint/checkpoint.h"
#include "tests/support/fake_samples.h"

namespace penumbra {

constexpr int kX = 3, kY = 5, kWidth = 21, kHeight = 13;
constexpr std::uint32_t kSpp = 22, kSamplesPerPass = 4;

inline TileGrid small_grid() { return {kX, kY, kWidth, kHeight, 8, kSpp, kSamplesPerPass}; }

inline Merge empty_merge(FilmLayers layers = kFeatureLayers) {
  return {FilmAccumulator(kX, kY, kWidth, kHeight, layers), small_grid()};
}

/// What a worker would send.
inline SampleBuffer result(std::uint32_t tile, std::uint32_t pass, FilmLayers layers = kFeatureLayers) {
  return fake_samples(small_grid().unit(tile, pass), layers);
}

inline bool is_merged_first(std::uint32_t tile, std::uint32_t pass) {
  return pass < (tile * 4 + 2) % (small_grid().passes() + 1);
}

/// Every tile has another number of passes, none and all among them.
inline Merge half_merged(FilmLayers layers = kFeatureLayers) {
  Merge merge = empty_merge(layers);
  for (std::uint32_t tile = 0; tile < small_grid().tiles(); ++tile)
    for (std::uint32_t pass = 0; is_merged_first(tile, pass); ++pass)
      merge.add(tile, pass, result(tile, pass, layers));
  return merge;
}

inline RenderIdentity small_identity() {
  return {.version = "1.2", .worker = "abc", .scene = "def", .settings = {{"seed", "3"}, {"spp", "22"}}};
}

}  // namespace penumbra
