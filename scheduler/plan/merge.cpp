#include "scheduler/plan/merge.h"

#include <algorithm>
#include <utility>

namespace penumbra {

Merge::Merge(FilmAccumulator film, TileGrid grid)
    : film_(std::move(film)), grid_(grid), tiles_(grid.tiles()) {}

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
  merge_what_is_next(tile);
  return samples;
}

void Merge::start_again() {
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile) {
    if (tiles_[tile].samples > 0) {
      const RenderUnit area = grid_.unit(tile, 0);
      film_.clear(area.x, area.y, area.width, area.height);
    }
    tiles_[tile] = {};
  }
}

void Merge::merge_what_is_next(std::uint32_t tile) {
  Tile& state = tiles_[tile];
  while (!state.waiting.empty() && state.waiting.begin()->first == state.next_pass) {
    if (const auto& result = state.waiting.begin()->second) {
      const RenderUnit area = grid_.unit(tile, state.next_pass);
      film_.add(area.x, area.y, *result);
    }
    state.waiting.erase(state.waiting.begin());
    ++state.next_pass;
  }
}

std::uint32_t Merge::finished_passes() const {
  const auto least = std::ranges::min_element(tiles_, {}, &Tile::next_pass);
  return least == tiles_.end() ? 0 : least->next_pass;
}

std::size_t Merge::waiting() const {
  std::size_t count = 0;
  for (const Tile& tile : tiles_) count += tile.waiting.size();
  return count;
}

}  // namespace penumbra
