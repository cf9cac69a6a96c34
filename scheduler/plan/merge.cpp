#include "scheduler/plan/merge.h"

#include <algorithm>
#include <utility>

namespace penumbra {

Merge::Merge(FilmAccumulator film, TileGrid grid, const PlanOptions& plan)
    : film_(std::move(film)), grid_(grid), sampling_(make_tile_sampling(grid, plan)), tiles_(grid.tiles()) {}

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

void Merge::merge_what_is_next(std::uint32_t tile) {
  Tile& state = tiles_[tile];
  while (!state.waiting.empty() && state.waiting.begin()->first == state.next_pass) {
    const std::optional<SampleBuffer>& result = state.waiting.begin()->second;
    sampling_->add(tile, state.next_pass, result ? &*result : nullptr, film_);
    state.waiting.erase(state.waiting.begin());
    ++state.next_pass;
  }
}

std::uint64_t Merge::redo(std::uint32_t tile) {
  Tile& state = tiles_[tile];
  clear_film(tile);
  const std::uint64_t samples = state.samples;
  Tile fresh;
  fresh.skipped = std::move(state.skipped);
  for (const std::uint32_t pass : fresh.skipped) fresh.waiting.emplace(pass, std::nullopt);
  state = std::move(fresh);
  sampling_->forget(tile);
  merge_what_is_next(tile);
  return samples;
}

void Merge::start_again() {
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile) {
    if (tiles_[tile].samples > 0) clear_film(tile);
    tiles_[tile] = Tile();
  }
  sampling_->start_again();
}

void Merge::clear_film(std::uint32_t tile) {
  const RenderUnit area = grid_.unit(tile, 0);
  film_.clear(area.x, area.y, area.width, area.height);
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
  sampling_->write(bytes);
}

Expected<void> Merge::read(ByteReader& bytes) {
  const Expected<Skipped> skipped = read_passes(bytes);
  if (!skipped) return std::unexpected(skipped.error());
  if (auto read = film_.read(bytes); !read) return read;
  if (auto read = sampling_->read(bytes, merged_passes(), film_); !read) return read;
  for (std::uint32_t number = 0; number < tiles_.size(); ++number) {
    Tile& tile = tiles_[number];
    if (auto checked = check_samples(number, (*skipped)[number]); !checked) return checked;
    if ((*skipped)[number].empty()) {
      tile.samples = grid_.pixels(number) * sampling_->rendered(number, tile.next_pass);
    } else {
      clear_film(number);
      tile = Tile();
      sampling_->forget(number);
    }
  }
  // Start again, so that the image is that of an undisturbed render.
  if (!sampling_->is_undisturbed()) start_again();
  return {};
}

Expected<Merge::Skipped> Merge::read_passes(ByteReader& bytes) {
  if (bytes.u64() != tiles_.size()) return fail("another number of tiles");
  Skipped skipped(tiles_.size());
  for (std::size_t tile = 0; tile < tiles_.size(); ++tile) {
    const std::uint64_t passes = bytes.u64(), gaps = bytes.u64();
    if (passes > most_passes() || gaps > passes) return fail("a tile with more passes than there are");
    tiles_[tile].next_pass = std::uint32_t(passes);
    for (std::uint64_t gap = 0; gap < gaps && !bytes.failed(); ++gap) skipped[tile].insert(bytes.u64());
    if (skipped[tile].size() != gaps || (gaps > 0 && *skipped[tile].rbegin() >= passes))
      return fail("a tile with invalid gaps");
  }
  return skipped;
}

/// Checks that the tile's pixels have the samples of the merged passes.
Expected<void> Merge::check_samples(std::uint32_t tile, const std::set<std::uint64_t>& skipped) const {
  const std::uint32_t passes = tiles_[tile].next_pass;
  if (passes > sampling_->known_passes(tile)) return fail("a tile with more passes than there are");
  std::uint64_t of_passes = sampling_->counted(tile, passes);
  for (const std::uint64_t pass : skipped)
    if (pass >= sampling_->first_counted(passes)) of_passes -= unit(tile, std::uint32_t(pass)).sample_count;
  const RenderUnit area = grid_.unit(tile, 0);
  const std::uint64_t count = film_.at(area.x, area.y).count;
  bool is_right = sampling_->may_have(count, of_passes);
  for (int y = area.y; y < area.y + area.height; ++y)
    for (int x = area.x; x < area.x + area.width; ++x) is_right = is_right && film_.at(x, y).count == count;
  return is_right ? Expected<void>() : fail("a pixel whose samples are not those of its passes");
}

std::uint32_t Merge::passes_wanted(std::uint32_t tile) const {
  return sampling_->passes_wanted(tile, tiles_[tile].next_pass);
}

std::uint32_t Merge::passes_at_first() const { return sampling_->passes_at_first(); }

std::uint32_t Merge::most_passes() const { return sampling_->most_passes(); }

RenderUnit Merge::unit(std::uint32_t tile, std::uint32_t pass) const {
  if (tile >= tiles_.size() || pass >= sampling_->known_passes(tile)) return {};
  return sampling_->unit(tile, pass);
}

bool Merge::is_done() const {
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile)
    if (!sampling_->is_finished(tile, tiles_[tile].next_pass)) return false;
  return true;
}

std::uint32_t Merge::least_passes_wanted() const {
  std::uint32_t least = most_passes();
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile) least = std::min(least, passes_wanted(tile));
  return least;
}

bool Merge::is_undisturbed() const { return sampling_->is_undisturbed(); }

std::uint64_t Merge::spp_finished() const {
  std::uint64_t least = ~std::uint64_t(0);
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile)
    least = std::min(least, sampling_->counted(tile, tiles_[tile].next_pass));
  return least;
}

std::uint64_t Merge::spp_wanted() const { return sampling_->spp_wanted(); }

std::uint64_t Merge::samples_expected() const {
  std::uint64_t all = 0;
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile)
    all += grid_.pixels(tile) * sampling_->expected(tile, tiles_[tile].next_pass);
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
  if (!sampling_->is_uniform()) return {};
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
