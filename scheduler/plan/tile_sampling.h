// Determines how many passes each tile of an image gets, and which of their samples are in the film.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "kernels/host/error.h"
#include "kernels/host/sample_buffer.h"
#include "scheduler/plan/byte_stream.h"
#include "scheduler/plan/film_accumulator.h"
#include "scheduler/plan/plan_options.h"
#include "scheduler/plan/tile_grid.h"

namespace penumbra {

/// The sampling strategy of an image. Merge passes it the results of each tile in pass order. `done` is the
/// number of passes of a tile that it has received.
class TileSampling {
 public:
  virtual ~TileSampling() = default;

  /// Adds the tile's next pass to `film`. A null result means that the pass was skipped.
  virtual void add(std::uint32_t tile, std::uint32_t pass, const SampleBuffer* result,
                   FilmAccumulator& film) = 0;
  /// The tile's passes will be added again from the first.
  virtual void forget(std::uint32_t tile) = 0;
  /// The same for all tiles, as for a new object.
  virtual void start_again() = 0;

  /// The number of passes that each tile needs before its results may ask for more.
  [[nodiscard]] virtual std::uint32_t passes_at_first() const = 0;
  /// The number of passes of the tile whose units are known.
  [[nodiscard]] virtual std::uint32_t known_passes(std::uint32_t tile) const = 0;
  /// The number of passes that the tile needs, according to its results; `done` if it is finished.
  [[nodiscard]] virtual std::uint32_t passes_wanted(std::uint32_t tile, std::uint32_t done) const = 0;
  /// The largest number of passes of any tile.
  [[nodiscard]] virtual std::uint32_t most_passes() const = 0;
  [[nodiscard]] virtual bool is_finished(std::uint32_t tile, std::uint32_t done) const = 0;
  /// The unit of `pass` < known_passes(tile).
  [[nodiscard]] virtual RenderUnit unit(std::uint32_t tile, std::uint32_t pass) const = 0;

  /// Samples per pixel of a tile after so many passes: how many are in the film, and how many were rendered.
  [[nodiscard]] virtual std::uint64_t counted(std::uint32_t tile, std::uint32_t passes) const = 0;
  [[nodiscard]] virtual std::uint64_t rendered(std::uint32_t tile, std::uint32_t passes) const = 0;
  /// The expected final number of rendered samples per pixel.
  [[nodiscard]] virtual std::uint64_t expected(std::uint32_t tile, std::uint32_t done) const = 0;
  /// The number of samples that every pixel of the film will have.
  [[nodiscard]] virtual std::uint64_t spp_wanted() const = 0;
  /// Whether all tiles have the same passes, and all of their samples are in the film.
  [[nodiscard]] virtual bool is_uniform() const = 0;

  /// Whether, since the last call, a result has determined the numbers of passes of all tiles.
  virtual bool take_allocation() { return false; }
  /// Whether the numbers of samples are those of an undisturbed render.
  [[nodiscard]] virtual bool is_undisturbed() const { return true; }

  /// The first pass whose samples are in the film after `done` passes; earlier ones have been replaced.
  [[nodiscard]] virtual std::uint32_t first_counted(std::uint32_t /*done*/) const { return 0; }
  /// Whether a tile may have `count` samples per pixel in the film if its passes contain `of_passes`.
  [[nodiscard]] virtual bool may_have(std::uint64_t count, std::uint64_t of_passes) const {
    return count == of_passes;
  }

  virtual void write(ByteWriter& bytes) const = 0;
  /// Reads the state written with the same settings. `done`: for each tile. Error: the bytes are not such a
  /// state.
  virtual Expected<void> read(ByteReader& bytes, std::span<const std::uint32_t> done,
                              const FilmAccumulator& film) = 0;
};

/// The strategy for the settings: the same passes for each tile; with a target error, each tile stops by
/// itself (AdaptiveTile); with `adaptive`, samples are allocated by a pilot (SampleAllocation). Target error
/// and `adaptive` exclude each other.
std::unique_ptr<TileSampling> make_tile_sampling(const TileGrid& grid, const PlanOptions& plan);

}  // namespace penumbra
