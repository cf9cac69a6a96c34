// Merges the results of work units into the film in pass order, whatever the order in which they arrive.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "kernels/host/sample_buffer.h"
#include "scheduler/plan/film_accumulator.h"
#include "scheduler/plan/plan_options.h"
#include "scheduler/plan/tile_grid.h"
#include "scheduler/plan/tile_sampling.h"

namespace penumbra {

/// The film of one image and, for each tile, the results that wait for an earlier pass. The merged film
/// depends only on the results: it is bitwise the same for every tile size and order of arrival.
///
/// make_tile_sampling determines the number of passes of a tile. Passes after a tile's last one are
/// discarded. With a target error or with adaptive sampling, the film also depends on the tile size.
class Merge {
 public:
  Merge(FilmAccumulator film, TileGrid grid, const PlanOptions& plan = {});

  /// Adds the result of a unit, at most once per unit (unless `redo` was called in between). Its size must be
  /// that of the grid's unit.
  void add(std::uint32_t tile, std::uint32_t pass, SampleBuffer result);
  /// Declares that a unit will never come, so that later passes of the tile need not wait for it.
  void skip(std::uint32_t tile, std::uint32_t pass);
  /// Forgets all results of a tile (but not the skipped passes), because its units will be rendered again.
  /// Returns the number of samples, over all pixels, that were forgotten.
  std::uint64_t redo(std::uint32_t tile);

  /// Forgets everything, like a new object, but keeps the memory. It takes the time to clear what was merged.
  void start_again();

  /// Writes the merged state, so that another process can resume. Waiting results are not written.
  void write(ByteWriter& bytes) const;
  /// Reads the state written for the same film and grid into this new object. A tile in which a pass was
  /// skipped starts again, because the pass can no longer be inserted. Error: the bytes are not such a state;
  /// this object must then be discarded.
  Expected<void> read(ByteReader& bytes);

  /// The number of passes that every tile needs before its results may ask for more.
  [[nodiscard]] std::uint32_t passes_at_first() const;
  /// The number of passes that a tile needs, as far as is known; for a finished tile the number that it has.
  [[nodiscard]] std::uint32_t passes_wanted(std::uint32_t tile) const;
  /// The minimum of passes_wanted over all tiles.
  [[nodiscard]] std::uint32_t least_passes_wanted() const;
  /// The largest number of passes that a tile may get.
  [[nodiscard]] std::uint32_t most_passes() const;
  /// The work unit of a tile's pass. Empty if it is not known yet, or never will be.
  [[nodiscard]] RenderUnit unit(std::uint32_t tile, std::uint32_t pass) const;
  /// Whether, since the last call, a result has determined the numbers of passes of all tiles.
  [[nodiscard]] bool take_allocation() { return sampling_->take_allocation(); }
  /// Whether every tile has all passes that its results and the settings require.
  [[nodiscard]] bool is_done() const;
  /// Whether the numbers of samples are those of an undisturbed render; see SampleAllocation.
  [[nodiscard]] bool is_undisturbed() const;
  /// Samples per pixel of the image: how many every pixel has, and, without a target error, how many it will
  /// have.
  [[nodiscard]] std::uint64_t spp_finished() const;
  [[nodiscard]] std::uint64_t spp_wanted() const;
  /// The expected total of samples over all tiles, from their errors so far.
  [[nodiscard]] std::uint64_t samples_expected() const;
  /// For each tile the number of passes that are merged or skipped.
  [[nodiscard]] std::vector<std::uint32_t> merged_passes() const;
  /// The number of samples over all pixels, merged or waiting.
  [[nodiscard]] std::uint64_t samples() const;
  /// The number of passes that are merged or skipped in every tile.
  [[nodiscard]] std::uint32_t finished_passes() const;
  /// The number of merged units, if they are the first units in issue order (pass by pass, tile by tile) and
  /// none was skipped or waits.
  [[nodiscard]] std::optional<std::uint64_t> units_in_order() const;
  /// The number of results that wait for an earlier pass of their tile.
  [[nodiscard]] std::size_t waiting() const;
  [[nodiscard]] const FilmAccumulator& film() const { return film_; }
  /// Moves the film out. The object must not be used any more.
  [[nodiscard]] FilmAccumulator take_film() && { return std::move(film_); }

 private:
  struct Tile {
    std::uint32_t next_pass = 0;
    std::uint64_t samples = 0;                                     // over all pixels, merged or waiting
    std::map<std::uint32_t, std::optional<SampleBuffer>> waiting;  // keyed by pass; no value: skipped
    std::vector<std::uint32_t> skipped;                            // skipped passes, for redo()
  };

  void merge_what_is_next(std::uint32_t tile);
  void clear_film(std::uint32_t tile);
  /// For each tile the passes that were skipped.
  using Skipped = std::vector<std::set<std::uint64_t>>;
  [[nodiscard]] Expected<Skipped> read_passes(ByteReader& bytes);
  [[nodiscard]] Expected<void> check_samples(std::uint32_t tile,
                                             const std::set<std::uint64_t>& skipped) const;

  FilmAccumulator film_;
  TileGrid grid_;
  std::unique_ptr<TileSampling> sampling_;
  std::vector<Tile> tiles_;
};

}  // namespace penumbra
