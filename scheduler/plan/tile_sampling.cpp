#include "scheduler/plan/tile_sampling.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "scheduler/plan/adaptive_tile.h"
#include "scheduler/plan/sample_allocation.h"

namespace penumbra {
namespace {

class UniformSampling : public TileSampling {
 public:
  explicit UniformSampling(const TileGrid& grid) : grid_(grid) {}

  void add(std::uint32_t tile, std::uint32_t /*pass*/, const SampleBuffer* result,
           FilmAccumulator& film) override {
    const RenderUnit area = grid_.unit(tile, 0);
    if (result != nullptr) film.add(area.x, area.y, *result);
  }
  void forget(std::uint32_t /*tile*/) override {}
  void start_again() override {}

  [[nodiscard]] std::uint32_t passes_at_first() const override { return grid_.passes(); }
  [[nodiscard]] std::uint32_t known_passes(std::uint32_t /*tile*/) const override { return grid_.passes(); }
  [[nodiscard]] std::uint32_t passes_wanted(std::uint32_t /*tile*/, std::uint32_t /*done*/) const override {
    return grid_.passes();
  }
  [[nodiscard]] std::uint32_t most_passes() const override { return grid_.passes(); }
  [[nodiscard]] bool is_finished(std::uint32_t /*tile*/, std::uint32_t done) const override {
    return done >= grid_.passes();
  }
  [[nodiscard]] RenderUnit unit(std::uint32_t tile, std::uint32_t pass) const override {
    return grid_.unit(tile, pass);
  }

  [[nodiscard]] std::uint64_t counted(std::uint32_t /*tile*/, std::uint32_t passes) const override {
    return grid_.samples_of_pixel(passes);
  }
  [[nodiscard]] std::uint64_t rendered(std::uint32_t /*tile*/, std::uint32_t passes) const override {
    return grid_.samples_of_pixel(passes);
  }
  [[nodiscard]] std::uint64_t expected(std::uint32_t /*tile*/, std::uint32_t /*done*/) const override {
    return grid_.spp();
  }
  [[nodiscard]] std::uint64_t spp_wanted() const override { return grid_.spp(); }
  [[nodiscard]] bool is_uniform() const override { return true; }

  void write(ByteWriter& /*bytes*/) const override {}
  Expected<void> read(ByteReader& /*bytes*/, std::span<const std::uint32_t> /*done*/,
                      const FilmAccumulator& /*film*/) override {
    return {};
  }

 protected:
  const TileGrid grid_;
};

/// Renders each tile until its error is small enough.
class TargetErrorSampling final : public UniformSampling {
 public:
  TargetErrorSampling(const TileGrid& grid, double target_error)
      : UniformSampling(grid), target_error_(target_error), tiles_(grid.tiles()) {}

  void add(std::uint32_t tile, std::uint32_t pass, const SampleBuffer* result,
           FilmAccumulator& film) override {
    Tile& state = tiles_[tile];
    if (state.is_finished) return;
    begin(tile, film);
    if (result != nullptr) state.halves->add(pass, *result);
    state.is_finished = state.halves->decide(pass + 1);
    state.halves->put_into(film);
    if (state.is_finished) state.halves.reset();
  }
  void forget(std::uint32_t tile) override { tiles_[tile] = Tile(); }
  void start_again() override { tiles_ = std::vector<Tile>(grid_.tiles()); }

  [[nodiscard]] std::uint32_t passes_at_first() const override {
    return AdaptiveTile::next_decision(0, grid_.passes());
  }
  [[nodiscard]] std::uint32_t passes_wanted(std::uint32_t tile, std::uint32_t done) const override {
    return tiles_[tile].is_finished ? done : AdaptiveTile::next_decision(done, grid_.passes());
  }
  [[nodiscard]] bool is_finished(std::uint32_t tile, std::uint32_t /*done*/) const override {
    return tiles_[tile].is_finished;
  }
  [[nodiscard]] std::uint64_t expected(std::uint32_t tile, std::uint32_t done) const override {
    const Tile& state = tiles_[tile];
    const std::uint32_t passes = state.is_finished ? done
                                 : state.halves    ? state.halves->passes_expected()
                                                   : grid_.passes();
    return grid_.samples_of_pixel(passes);
  }
  [[nodiscard]] bool is_uniform() const override { return false; }
  /// Its halves may have stopped before its last pass.
  [[nodiscard]] bool may_have(std::uint64_t count, std::uint64_t of_passes) const override {
    return count <= of_passes;
  }

  void write(ByteWriter& bytes) const override {
    for (const Tile& tile : tiles_) {
      bytes.u64(tile.is_finished ? 1 : 0);
      if (tile.halves) tile.halves->write(bytes);
    }
  }
  Expected<void> read(ByteReader& bytes, std::span<const std::uint32_t> done,
                      const FilmAccumulator& film) override {
    for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile) {
      tiles_[tile].is_finished = bytes.u64() != 0;
      if (tiles_[tile].is_finished || done[tile] == 0) continue;
      begin(tile, film);
      if (auto read = tiles_[tile].halves->read(bytes); !read) return read;
    }
    return {};
  }

 private:
  struct Tile {
    bool is_finished = false;
    std::unique_ptr<AdaptiveTile> halves;  // exists from the tile's first pass until it is finished
  };

  void begin(std::uint32_t tile, const FilmAccumulator& film) {
    if (tiles_[tile].halves) return;
    const RenderUnit area = grid_.unit(tile, 0);
    tiles_[tile].halves = std::make_unique<AdaptiveTile>(
        film.empty_like(area.x, area.y, area.width, area.height), target_error_, grid_.passes());
  }

  double target_error_;
  std::vector<Tile> tiles_;
};

/// Adaptive sampling by a pilot. The film shows the pilot until the image's own samples are there.
class PilotSampling final : public UniformSampling {
 public:
  explicit PilotSampling(const TileGrid& grid) : UniformSampling(grid), allocation_(grid) {}

  void add(std::uint32_t tile, std::uint32_t pass, const SampleBuffer* result,
           FilmAccumulator& film) override {
    if (pass < kPilotPasses) {
      const bool was_made = allocation_.is_made();
      if (result != nullptr)
        allocation_.add_pilot(tile, *result);
      else
        allocation_.skip_pilot(tile);
      allocated_now_ = allocated_now_ || allocation_.is_made() != was_made;
    }
    if (pass == kPilotPasses) {
      const RenderUnit area = grid_.unit(tile, 0);
      film.clear(area.x, area.y, area.width, area.height);
    }
    UniformSampling::add(tile, pass, result, film);
  }
  void forget(std::uint32_t tile) override { allocation_.forget_pilot(tile); }
  void start_again() override { allocation_ = SampleAllocation(grid_); }

  [[nodiscard]] std::uint32_t passes_at_first() const override { return kPilotPasses; }
  [[nodiscard]] std::uint32_t known_passes(std::uint32_t tile) const override {
    return allocation_.passes(tile);
  }
  [[nodiscard]] std::uint32_t passes_wanted(std::uint32_t tile, std::uint32_t /*done*/) const override {
    return allocation_.passes(tile);
  }
  [[nodiscard]] std::uint32_t most_passes() const override { return allocation_.most_passes(); }
  [[nodiscard]] bool is_finished(std::uint32_t tile, std::uint32_t done) const override {
    return allocation_.is_made() && done >= allocation_.passes(tile);
  }
  [[nodiscard]] RenderUnit unit(std::uint32_t tile, std::uint32_t pass) const override {
    return allocation_.unit(tile, pass);
  }

  [[nodiscard]] std::uint64_t counted(std::uint32_t tile, std::uint32_t passes) const override {
    return allocation_.counted(tile, passes);
  }
  [[nodiscard]] std::uint64_t rendered(std::uint32_t tile, std::uint32_t passes) const override {
    return allocation_.rendered(tile, passes);
  }
  [[nodiscard]] std::uint64_t expected(std::uint32_t tile, std::uint32_t /*done*/) const override {
    return rendered(tile, allocation_.passes(tile)) + (allocation_.is_made() ? 0 : grid_.spp());
  }
  [[nodiscard]] std::uint64_t spp_wanted() const override {
    std::uint32_t least = grid_.spp();
    for (std::uint32_t tile = 0; allocation_.is_made() && tile < grid_.tiles(); ++tile)
      least = std::min(least, allocation_.spp(tile));
    return least;
  }
  [[nodiscard]] bool is_uniform() const override { return false; }
  bool take_allocation() override { return std::exchange(allocated_now_, false); }
  [[nodiscard]] bool is_undisturbed() const override { return !allocation_.is_disturbed(); }
  [[nodiscard]] std::uint32_t first_counted(std::uint32_t done) const override {
    return done > kPilotPasses ? kPilotPasses : 0;
  }

  void write(ByteWriter& bytes) const override { allocation_.write(bytes); }
  Expected<void> read(ByteReader& bytes, std::span<const std::uint32_t> done,
                      const FilmAccumulator& /*film*/) override {
    if (auto read = allocation_.read(bytes); !read) return read;
    for (std::uint32_t tile = 0; tile < done.size(); ++tile)
      if (!allocation_.is_made() && allocation_.has_pilot(tile) != (done[tile] > 0))
        return fail("a tile with an invalid pilot");
    return {};
  }

 private:
  static constexpr std::uint32_t kPilotPasses = SampleAllocation::kPilotPasses;

  SampleAllocation allocation_;
  bool allocated_now_ = false;
};

}  // namespace

std::unique_ptr<TileSampling> make_tile_sampling(const TileGrid& grid, const PlanOptions& plan) {
  if (plan.adaptive) return std::make_unique<PilotSampling>(grid);
  if (plan.target_error) return std::make_unique<TargetErrorSampling>(grid, *plan.target_error);
  return std::make_unique<UniformSampling>(grid);
}

}  // namespace penumbra
