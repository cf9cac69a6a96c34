#include "scheduler/plan/merge.h"

#include <algorithm>
#include <set>
#include <utility>

namespace penumbra {

Merge::Merge(FilmAccumulator film, TileGrid grid, std::optional<double> target_error, bool adaptive)
    : film_(std::move(film)), grid_(grid), target_error_(target_error), tiles_(grid.tiles()) {
  if (adaptive) allocation_.emplace(grid_);
}

/// Its halves, before its first pass.
void Merge::begin(std::uint32_t tile) {
  if (!target_error_ || tiles_[tile].is_done || tiles_[tile].adaptive) return;
  const RenderUnit area = grid_.unit(tile, 0);
  tiles_[tile].adaptive = std::make_unique<AdaptiveTile>(
      FilmAccumulator(area.x, area.y, area.width, area.height, film_.planes(), film_.matte_count()),
      *target_error_, grid_.passes());
}

/// Shows what there is of it, and decides whether that is enough.
void Merge::end_pass(std::uint32_t tile) {
  Tile& state = tiles_[tile];
  if (!state.adaptive) return;
  state.is_done = state.adaptive->decide(state.next_pass);
  state.adaptive->put_into(film_);
  if (state.is_done) state.adaptive.reset();
}

void Merge::add(std::uint32_t tile, std::uint32_t pass, SampleBuffer result) {
  tiles_[tile].samples += result.pixels() * result.sample_count;
  tiles_[tile].waiting.insert_or_assign(pass, std::move(result));
  merge_what_is_next(tile);
}

void Merge::skip(std::uint32_t tile, std::uint32_t pass) {
  tiles_[tile].skipped.push_back(pass);
  tiles_[tile].waiting.insert_or_assign(pass, std::nullopt);
  merge_what_is_next(tile);
}

std::uint64_t Merge::redo(std::uint32_t tile) {
  Tile& state = tiles_[tile];
  const RenderUnit area = grid_.unit(tile, 0);
  film_.clear(area.x, area.y, area.width, area.height);
  const std::uint64_t samples = state.samples;
  Tile fresh;
  fresh.skipped = std::move(state.skipped);
  for (const std::uint32_t pass : fresh.skipped) fresh.waiting.emplace(pass, std::nullopt);
  state = std::move(fresh);
  if (allocation_) allocation_->forget_pilot(tile);
  merge_what_is_next(tile);
  return samples;
}

void Merge::start_again() {
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile) {
    if (tiles_[tile].samples > 0) {
      const RenderUnit area = grid_.unit(tile, 0);
      film_.clear(area.x, area.y, area.width, area.height);
    }
    tiles_[tile] = Tile();
  }
  if (allocation_) allocation_.emplace(grid_);
}

void Merge::merge_pass(std::uint32_t tile, const std::optional<SampleBuffer>& result) {
  Tile& state = tiles_[tile];
  const RenderUnit area = grid_.unit(tile, 0);
  if (allocation_ && state.next_pass < SampleAllocation::kPilotPasses) {
    const bool was_made = allocation_->is_made();
    if (result)
      allocation_->add_pilot(tile, *result);
    else
      allocation_->skip_pilot(tile);
    allocated_now_ = allocated_now_ || allocation_->is_made() != was_made;
  }
  if (allocation_ && state.next_pass == SampleAllocation::kPilotPasses)
    film_.clear(area.x, area.y, area.width, area.height);
  if (!result) return;
  if (state.adaptive)
    state.adaptive->add(state.next_pass, *result);
  else if (!state.is_done)
    film_.add(area.x, area.y, *result);
}

void Merge::merge_what_is_next(std::uint32_t tile) {
  Tile& state = tiles_[tile];
  while (!state.waiting.empty() && state.waiting.begin()->first == state.next_pass) {
    begin(tile);
    merge_pass(tile, state.waiting.begin()->second);
    state.waiting.erase(state.waiting.begin());
    ++state.next_pass;
    end_pass(tile);
  }
}

void Merge::write(ByteWriter& bytes) const {
  bytes.u64(tiles_.size());
  for (const Tile& tile : tiles_) {
    bytes.u64(tile.next_pass);
    const auto is_over = [&](std::uint32_t pass) { return pass < tile.next_pass; };
    bytes.u64(std::uint64_t(std::ranges::count_if(tile.skipped, is_over)));
    for (const std::uint32_t pass : tile.skipped)
      if (is_over(pass)) bytes.u64(pass);
  }
  film_.write(bytes);
  if (target_error_) write_adaptive(bytes);
  if (allocation_) allocation_->write(bytes);
}

void Merge::write_adaptive(ByteWriter& bytes) const {
  for (const Tile& tile : tiles_) {
    bytes.u64(tile.is_done ? 1 : 0);
    if (tile.adaptive) tile.adaptive->write(bytes);
  }
}

Expected<void> Merge::read_adaptive(ByteReader& bytes) {
  for (std::uint32_t number = 0; number < tiles_.size(); ++number) {
    Tile& tile = tiles_[number];
    tile.is_done = bytes.u64() != 0;
    if (tile.is_done || tile.next_pass == 0) continue;
    begin(number);
    if (auto read = tile.adaptive->read(bytes); !read) return read;
  }
  return {};
}

Expected<void> Merge::read(ByteReader& bytes) {
  if (bytes.u64() != tiles_.size()) return fail("another number of tiles");
  std::vector<std::set<std::uint64_t>> skipped(tiles_.size());
  for (std::size_t tile = 0; tile < tiles_.size(); ++tile) {
    const std::uint64_t passes = bytes.u64(), gaps = bytes.u64();
    if (passes > most_passes() || gaps > passes) return fail("a tile with more passes than there are");
    tiles_[tile].next_pass = std::uint32_t(passes);
    for (std::uint64_t gap = 0; gap < gaps && !bytes.failed(); ++gap) skipped[tile].insert(bytes.u64());
    if (skipped[tile].size() != gaps || (gaps > 0 && *skipped[tile].rbegin() >= passes))
      return fail("a tile whose gaps are none");
  }
  if (auto read = film_.read(bytes); !read) return read;
  if (target_error_)
    if (auto read = read_adaptive(bytes); !read) return read;
  if (allocation_)
    if (auto read = allocation_->read(bytes); !read) return read;
  for (std::uint32_t number = 0; number < tiles_.size(); ++number) {
    Tile& tile = tiles_[number];
    const RenderUnit area = grid_.unit(number, 0);
    if (tile.next_pass > known_passes(number)) return fail("a tile with more passes than there are");
    std::uint64_t of_each_pixel = counted(number, tile.next_pass);
    const std::uint64_t first_counted =
        allocation_ && tile.next_pass > SampleAllocation::kPilotPasses ? SampleAllocation::kPilotPasses : 0;
    for (const std::uint64_t pass : skipped[number])
      if (pass >= first_counted) of_each_pixel -= unit(number, std::uint32_t(pass)).sample_count;
    if (target_error_ ? !has_equal_samples(area, of_each_pixel) : !has_samples(area, of_each_pixel))
      return fail("a pixel whose samples are not those of its passes");
    if (skipped[number].empty()) {
      tile.samples = grid_.pixels(number) * rendered(number, tile.next_pass);
    } else {
      film_.clear(area.x, area.y, area.width, area.height);
      tile = Tile();
      if (allocation_) allocation_->forget_pilot(number);
    }
    if (allocation_ && !allocation_->is_made() && allocation_->has_pilot(number) != (tile.next_pass > 0))
      return fail("a tile whose pilot is none");
  }
  // With every pilot shares are others: then it is the image of an undisturbed render.
  if (allocation_ && allocation_->is_disturbed()) start_again();
  return {};
}

bool Merge::has_samples(const RenderUnit& area, std::uint64_t of_each_pixel) const {
  for (int y = area.y; y < area.y + area.height; ++y)
    for (int x = area.x; x < area.x + area.width; ++x)
      if (film_.at(x, y).count != of_each_pixel) return false;
  return true;
}

/// Of a tile whose halves may have stopped before its last pass.
bool Merge::has_equal_samples(const RenderUnit& area, std::uint64_t at_most) const {
  const std::uint64_t count = film_.at(area.x, area.y).count;
  return count <= at_most && has_samples(area, count);
}

std::uint32_t Merge::passes_wanted(std::uint32_t tile) const {
  const Tile& state = tiles_[tile];
  if (!target_error_) return known_passes(tile);
  return state.is_done ? state.next_pass : AdaptiveTile::next_decision(state.next_pass, grid_.passes());
}

std::uint32_t Merge::passes_at_first() const {
  if (allocation_) return SampleAllocation::kPilotPasses;
  return target_error_ ? AdaptiveTile::next_decision(0, grid_.passes()) : grid_.passes();
}

std::uint32_t Merge::most_passes() const { return allocation_ ? allocation_->most_passes() : grid_.passes(); }

std::uint32_t Merge::known_passes(std::uint32_t tile) const {
  return allocation_ ? allocation_->passes(tile) : grid_.passes();
}

RenderUnit Merge::unit(std::uint32_t tile, std::uint32_t pass) const {
  if (tile >= tiles_.size() || pass >= known_passes(tile)) return {};
  return allocation_ ? allocation_->unit(tile, pass) : grid_.unit(tile, pass);
}

std::uint64_t Merge::counted(std::uint32_t tile, std::uint32_t passes) const {
  return allocation_ ? allocation_->counted(tile, passes) : grid_.samples_of_pixel(passes);
}

std::uint64_t Merge::rendered(std::uint32_t tile, std::uint32_t passes) const {
  return allocation_ ? allocation_->rendered(tile, passes) : grid_.samples_of_pixel(passes);
}

bool Merge::is_done() const {
  if (!allocation_) return std::ranges::all_of(tiles_, &Tile::is_done);
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile)
    if (tiles_[tile].next_pass < allocation_->passes(tile)) return false;
  return allocation_->is_made();
}

std::uint32_t Merge::least_passes_wanted() const {
  std::uint32_t least = most_passes();
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile) least = std::min(least, passes_wanted(tile));
  return least;
}

bool Merge::is_undisturbed() const { return !allocation_ || !allocation_->is_disturbed(); }

std::uint64_t Merge::spp_finished() const {
  std::uint64_t least = ~std::uint64_t(0);
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile)
    least = std::min(least, counted(tile, tiles_[tile].next_pass));
  return least;
}

std::uint64_t Merge::spp_wanted() const {
  if (!allocation_ || !allocation_->is_made()) return grid_.spp();
  std::uint64_t least = grid_.spp();
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile)
    least = std::min<std::uint64_t>(least, allocation_->spp(tile));
  return least;
}

std::uint64_t Merge::samples_expected() const {
  std::uint64_t all = 0;
  for (std::uint32_t number = 0; number < tiles_.size(); ++number) {
    const Tile& tile = tiles_[number];
    const std::uint32_t passes = allocation_     ? allocation_->passes(number)
                                 : tile.is_done  ? tile.next_pass
                                 : tile.adaptive ? tile.adaptive->passes_expected()
                                                 : grid_.passes();
    all += grid_.pixels(number) * rendered(number, passes);
  }
  if (allocation_ && !allocation_->is_made()) all += grid_.samples(grid_.passes());
  return all;
}

std::vector<std::uint32_t> Merge::merged_passes() const {
  std::vector<std::uint32_t> passes;
  for (const Tile& tile : tiles_) passes.push_back(tile.next_pass);
  return passes;
}

std::uint64_t Merge::samples() const {
  std::uint64_t all = 0;
  for (const Tile& tile : tiles_) all += tile.samples;
  return all;
}

std::uint32_t Merge::finished_passes() const {
  const auto least = std::ranges::min_element(tiles_, {}, &Tile::next_pass);
  return least == tiles_.end() ? 0 : least->next_pass;
}

std::optional<std::uint64_t> Merge::units_in_order() const {
  if (target_error_ || allocation_) return {};  // how many of a tile count is another matter
  const std::uint32_t whole = finished_passes();
  std::uint64_t more = 0;
  for (const Tile& tile : tiles_) {
    const std::uint32_t own = tile.next_pass - whole;
    const bool follows = own == 0 || more == std::uint64_t(&tile - tiles_.data());
    if (own > 1 || !follows || !tile.skipped.empty() || !tile.waiting.empty()) return {};
    more += own;
  }
  return std::uint64_t(whole) * tiles_.size() + more;
}

std::size_t Merge::waiting() const {
  std::size_t count = 0;
  for (const Tile& tile : tiles_) count += tile.waiting.size();
  return count;
}

}  // namespace penumbra
