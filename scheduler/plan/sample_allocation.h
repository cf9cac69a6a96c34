// How the samples of an image are shared out among its tiles, by the errors that a pilot shows.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/host/error.h"
#include "kernels/host/sample_buffer.h"
#include "scheduler/plan/byte_stream.h"
#include "scheduler/plan/tile_grid.h"

namespace penumbra {

/// For a given number of samples the squared error of an image is least where each tile gets them in
/// proportion to the root of the variance of one (J. Neyman, "On the two different aspects of the
/// representative method", 1934). That holds where every sample costs the same and the error falls as
/// 1 / samples. But paths are longer where it is noisy, and the error of Sobol points falls faster, so it is
/// variance^0.4 here. The variance is that of a pilot: a first pass of two samples of each pixel.
///
/// The pilot has a sequence of random numbers of its own, and the samples that count have another one: how
/// many they are does not depend on them, so their mean has no bias from being chosen. The pilot counts for
/// nothing else. The sequence of a tile is made for its own number of samples, which is spp / 8, rounded
/// down and at least 1, times a power of two, at most 16 spp: where spp is a power of two, so are they, and
/// Sobol points stay the nets that they are.
///
/// Errors are relative, as a film's: of a pixel's squared one over the squared mean + .01.
class SampleAllocation {
 public:
  static constexpr std::uint32_t kPilotPasses = 1, kPilotSpp = 2;

  /// The grid's samples of a pixel are the mean of those that count.
  explicit SampleAllocation(const TileGrid& grid);

  /// The result of a tile's pilot. Once the allocation is made nothing changes it: a tile that is done again
  /// keeps its share.
  void add_pilot(std::uint32_t tile, const SampleBuffer& result);
  /// It will never come: the tile counts as one of the mean variance.
  void skip_pilot(std::uint32_t tile) { end_pilot(tile, kUnknown); }
  /// The tile's pilot begins anew.
  void forget_pilot(std::uint32_t tile);

  /// Whether every tile's pilot has come; then how many samples of a pixel count, and all units, are known.
  [[nodiscard]] bool is_made() const { return pilots_missing_ == 0; }
  [[nodiscard]] bool has_pilot(std::uint32_t tile) const { return tiles_[tile].has_pilot; }
  /// Whether it is not what an undisturbed render has: a pilot was another one when it was done again, or
  /// there is none.
  [[nodiscard]] bool is_disturbed() const { return contradicted_ || has_gaps(); }
  [[nodiscard]] std::uint32_t spp(std::uint32_t tile) const { return tiles_[tile].spp; }
  /// Passes of a tile, as far as they are known: those of the pilot come first.
  [[nodiscard]] std::uint32_t passes(std::uint32_t tile) const;
  /// That a tile may come to have.
  [[nodiscard]] std::uint32_t most_passes() const;
  /// Of a pixel of the tile, after so many passes: how many are in the film, and how many were rendered.
  [[nodiscard]] std::uint64_t counted(std::uint32_t tile, std::uint32_t passes) const;
  [[nodiscard]] std::uint64_t rendered(std::uint32_t tile, std::uint32_t passes) const;
  /// Of `pass` < passes(tile).
  [[nodiscard]] RenderUnit unit(std::uint32_t tile, std::uint32_t pass) const;

  void write(ByteWriter& bytes) const;
  Expected<void> read(ByteReader& bytes);

 private:
  struct Tile {
    bool has_pilot = false;      // or will never have it
    double variance = kUnknown;  // relative, of one sample
    std::uint32_t spp = 0;       // that count; 0 before the allocation is made
  };
  static constexpr double kUnknown = -1;

  void end_pilot(std::uint32_t tile, double variance);
  [[nodiscard]] bool has_gaps() const;
  void allocate();

  TileGrid grid_;
  std::uint32_t least_spp_, most_spp_;
  std::uint32_t pilots_missing_;
  bool contradicted_ = false;
  std::vector<Tile> tiles_;
};

}  // namespace penumbra
