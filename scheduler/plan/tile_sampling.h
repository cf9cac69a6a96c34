// How many passes each tile of an image gets, and which of their samples the film shows.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "kernels/host/error.h"
#include "kernels/host/sample_buffer.h"
#include "scheduler/plan/byte_stream.h"
#include "scheduler/plan/film_accumulator.h"
#include "scheduler/plan/tile_grid.h"

namespace penumbra {

/// Merge gives it the results of a tile in pass order. `done`: how many passes of the tile it has been given.
class TileSampling {
 public:
  virtual ~TileSampling() = default;

  /// The tile's next pass, whose result goes into `film`; null: it was skipped.
  virtual void add(std::uint32_t tile, std::uint32_t pass, const SampleBuffer* result,
                   FilmAccumulator& film) = 0;
  /// The tile's passes come again.
  virtual void forget(std::uint32_t tile) = 0;
  /// Those of all tiles do, as if nothing had been added.
  virtual void start_again() = 0;

  /// Passes of each tile that are needed before its results may ask for more.
  [[nodiscard]] virtual std::uint32_t passes_at_first() const = 0;
  /// Passes of the tile whose units are known.
  [[nodiscard]] virtual std::uint32_t known_passes(std::uint32_t tile) const = 0;
  /// Passes that the tile needs, as far as its results tell; `done` if it is finished.
  [[nodiscard]] virtual std::uint32_t passes_wanted(std::uint32_t tile, std::uint32_t done) const = 0;
  /// At most, of any tile.
  [[nodiscard]] virtual std::uint32_t most_passes() const = 0;
  [[nodiscard]] virtual bool is_finished(std::uint32_t tile, std::uint32_t done) const = 0;
  /// What is to be rendered, of `pass` < known_passes(tile).
  [[nodiscard]] virtual RenderUnit unit(std::uint32_t tile, std::uint32_t pass) const = 0;

  /// Samples of each pixel of a tile after so many passes: how many are in the film, and were rendered.
  [[nodiscard]] virtual std::uint64_t counted(std::uint32_t tile, std::uint32_t passes) const = 0;
  [[nodiscard]] virtual std::uint64_t rendered(std::uint32_t tile, std::uint32_t passes) const = 0;
  /// How many will be rendered in the end, by what is known.
  [[nodiscard]] virtual std::uint64_t expected(std::uint32_t tile, std::uint32_t done) const = 0;
  /// How many of every pixel will be in the film.
  [[nodiscard]] virtual std::uint64_t spp_wanted() const = 0;
  /// Whether every tile has the same passes, and all of their samples are in the film.
  [[nodiscard]] virtual bool is_uniform() const = 0;

  /// Whether since the last call the results of one tile have told how many passes every tile needs.
  virtual bool take_allocation() { return false; }
  /// Whether the numbers of samples are those of a render that nothing disturbed.
  [[nodiscard]] virtual bool is_undisturbed() const { return true; }

  /// The first pass whose samples are in the film after `done`: those of earlier ones have been replaced.
  [[nodiscard]] virtual std::uint32_t first_counted(std::uint32_t /*done*/) const { return 0; }
  /// Whether a tile may have `count` samples of each pixel in the film where its passes have `of_passes`.
  [[nodiscard]] virtual bool may_have(std::uint64_t count, std::uint64_t of_passes) const {
    return count == of_passes;
  }

  virtual void write(ByteWriter& bytes) const = 0;
  /// Takes the state of one of the same settings; `done`: of each tile. Error: that is not what the bytes are.
  virtual Expected<void> read(ByteReader& bytes, std::span<const std::uint32_t> done,
                              const FilmAccumulator& film) = 0;
};

/// The passes of the grid for each tile; with a target error each tile stops by itself, see AdaptiveTile;
/// with `adaptive` tiles get samples by the errors of a pilot, see SampleAllocation. Not both.
std::unique_ptr<TileSampling> make_tile_sampling(const TileGrid& grid, std::optional<double> target_error,
                                                 bool adaptive);

}  // namespace penumbra
