// Adaptive sampling: distributes the samples of an image among its tiles according to the errors of a pilot.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/host/error.h"
#include "kernels/host/sample_buffer.h"
#include "scheduler/plan/byte_stream.h"
#include "scheduler/plan/tile_grid.h"

namespace penumbra {

/// For a given total number of samples, the squared error of an image is minimal if each tile gets samples in
/// proportion to the standard deviation of one sample (J. Neyman, "On the two different aspects of the
/// representative method", 1934). That assumes that all samples have the same cost and that the squared error
/// falls as 1 / samples. But paths are longer in noisy regions, and the error of Sobol points falls faster,
/// so variance^0.4 is used here. The variance is estimated by a pilot: a first pass of two samples per pixel.
///
/// The pilot uses a random sequence of its own, and its samples are not part of the image. The image's
/// samples use another sequence, so their number does not depend on their values, and their mean is unbiased.
/// The number of samples per pixel of a tile is spp / 8, rounded down and at least 1, times a power of two,
/// and at most 16 spp; the tile's sequence is made for that number. If spp is a power of two, so are these
/// numbers, and Sobol points remain (t, m, s)-nets.
///
/// Errors are relative, as for a film: the squared error of a pixel over its squared mean + .01.
class SampleAllocation {
 public:
  static constexpr std::uint32_t kPilotPasses = 1, kPilotSpp = 2;

  /// The grid's samples per pixel become the mean over the image, without the pilot.
  explicit SampleAllocation(const TileGrid& grid);

  /// The result of a tile's pilot. Once the allocation is made, nothing changes it: a tile that is rendered
  /// again keeps its number of samples.
  void add_pilot(std::uint32_t tile, const SampleBuffer& result);
  /// The pilot will never come; the tile gets the mean variance.
  void skip_pilot(std::uint32_t tile) { end_pilot(tile, kUnknown); }
  /// The tile's pilot will be rendered again.
  void forget_pilot(std::uint32_t tile);

  /// Whether the pilots of all tiles have come. Then all units and the numbers of samples are known.
  [[nodiscard]] bool is_made() const { return pilots_missing_ == 0; }
  [[nodiscard]] bool has_pilot(std::uint32_t tile) const { return tiles_[tile].has_pilot; }
  /// Whether the allocation differs from that of an undisturbed render: a repeated pilot gave another result,
  /// or one is missing.
  [[nodiscard]] bool is_disturbed() const { return contradicted_ || has_gaps(); }
  [[nodiscard]] std::uint32_t spp(std::uint32_t tile) const { return tiles_[tile].spp; }
  /// The number of passes of a tile as far as it is known. The pilot's come first.
  [[nodiscard]] std::uint32_t passes(std::uint32_t tile) const;
  /// The largest number of passes that a tile may get.
  [[nodiscard]] std::uint32_t most_passes() const;
  /// Samples per pixel of the tile after so many passes: how many are in the film, and how many were
  /// rendered.
  [[nodiscard]] std::uint64_t counted(std::uint32_t tile, std::uint32_t passes) const;
  [[nodiscard]] std::uint64_t rendered(std::uint32_t tile, std::uint32_t passes) const;
  /// The unit of `pass` < passes(tile).
  [[nodiscard]] RenderUnit unit(std::uint32_t tile, std::uint32_t pass) const;

  void write(ByteWriter& bytes) const;
  Expected<void> read(ByteReader& bytes);

 private:
  struct Tile {
    bool has_pilot = false;      // its pilot has come, or never will
    double variance = kUnknown;  // relative variance of one sample
    std::uint32_t spp = 0;       // samples per pixel in the image; 0 before the allocation is made
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
