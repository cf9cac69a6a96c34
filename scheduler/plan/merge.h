// Puts the results of work units into the film in pass order, whatever the order in which they arrive.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "kernels/host/sample_buffer.h"
#include "scheduler/plan/film_accumulator.h"
#include "scheduler/plan/tile_grid.h"
#include "scheduler/plan/tile_sampling.h"

namespace penumbra {

/// The film of one image and, for each tile, the results that are waiting for an earlier pass. The merged
/// film is a function of the results alone: the same bytes for every tile size and order of arrival.
///
/// How many passes a tile has is up to make_tile_sampling; passes of a tile after its last are discarded. With a
/// target error, or with adaptive sampling, the film is a function of the tile size as well.
class Merge {
 public:
  Merge(FilmAccumulator film, TileGrid grid, std::optional<double> target_error = {}, bool adaptive = false);

  /// The result of a unit, once for each unit (unless `redo` came between), of the size that the grid says.
  void add(std::uint32_t tile, std::uint32_t pass, SampleBuffer result);
  /// Declares that a unit will never come, so that the tile's later passes need not wait for it.
  void skip(std::uint32_t tile, std::uint32_t pass);
  /// Forgets everything that was added to a tile (not what was skipped): its units will come again. Returns
  /// how many samples, over all pixels, that was.
  std::uint64_t redo(std::uint32_t tile);

  /// Forgets everything, as if it were new: in time that what was merged takes to clear, and in its memory.
  void start_again();

  /// What is merged, to go on with it in another process; not what waits.
  void write(ByteWriter& bytes) const;
  /// Takes what one of the same film and grid has written; this one is new. A tile in which a pass was
  /// skipped begins anew: its film has no room for that pass any more. Error: that is not what the bytes are.
  /// It is to be thrown away then.
  Expected<void> read(ByteReader& bytes);

  /// Of each tile so many passes are needed before its results may tell of more.
  [[nodiscard]] std::uint32_t passes_at_first() const;
  /// How many passes a tile needs, as far as is known yet: those that are there if it is done.
  [[nodiscard]] std::uint32_t passes_wanted(std::uint32_t tile) const;
  /// The least of those.
  [[nodiscard]] std::uint32_t least_passes_wanted() const;
  /// That a tile may come to have.
  [[nodiscard]] std::uint32_t most_passes() const;
  /// What is to be rendered for a tile's pass; empty if it is not known, or never will be.
  [[nodiscard]] RenderUnit unit(std::uint32_t tile, std::uint32_t pass) const;
  /// Whether since the last call the results of one tile have told how many passes each needs.
  [[nodiscard]] bool take_allocation() { return sampling_->take_allocation(); }
  /// Whether every tile has come to its last pass, as its results and the settings want it.
  [[nodiscard]] bool is_done() const;
  /// Whether shares of samples are those of an undisturbed render, see SampleAllocation.
  [[nodiscard]] bool is_undisturbed() const;
  /// Samples that count of every pixel, those of its passes: how many are there, and, without a target error,
  /// will be.
  [[nodiscard]] std::uint64_t spp_finished() const;
  [[nodiscard]] std::uint64_t spp_wanted() const;
  /// Samples that all tiles will need together, by their errors so far.
  [[nodiscard]] std::uint64_t samples_expected() const;
  /// Of each tile, how many passes are merged (or skipped).
  [[nodiscard]] std::vector<std::uint32_t> merged_passes() const;
  /// Samples that are merged or wait, over all pixels.
  [[nodiscard]] std::uint64_t samples() const;
  /// How many passes, from the first, are merged (or skipped) in every tile.
  [[nodiscard]] std::uint32_t finished_passes() const;
  /// If what is merged are the first units in their order, pass by pass and tile by tile, and none was
  /// skipped or waits: how many.
  [[nodiscard]] std::optional<std::uint64_t> units_in_order() const;
  /// Results that wait for an earlier pass of their tile.
  [[nodiscard]] std::size_t waiting() const;
  [[nodiscard]] const FilmAccumulator& film() const { return film_; }
  /// The film; the object is then used up.
  [[nodiscard]] FilmAccumulator take_film() && { return std::move(film_); }

 private:
  struct Tile {
    std::uint32_t next_pass = 0;
    std::uint64_t samples = 0;                                     // over all pixels, merged or waiting
    std::map<std::uint32_t, std::optional<SampleBuffer>> waiting;  // by pass; no value: skipped
    std::vector<std::uint32_t> skipped;                            // passes, for redo()
  };

  void merge_what_is_next(std::uint32_t tile);
  void clear_film(std::uint32_t tile);
  /// The passes of each tile that were skipped.
  using Skipped = std::vector<std::set<std::uint64_t>>;
  [[nodiscard]] Expected<Skipped> read_passes(ByteReader& bytes);
  [[nodiscard]] Expected<void> check_samples(std::uint32_t tile, const std::set<std::uint64_t>& skipped) const;

  FilmAccumulator film_;
  TileGrid grid_;
  std::unique_ptr<TileSampling> sampling_;
  std::vector<Tile> tiles_;
};

}  // namespace penumbra
