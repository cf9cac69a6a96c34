#include "scheduler/plan/film_owners.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>

#include "kernels/scene_types.h"

namespace penumbra {

FilmOwners::FilmOwners(std::size_t pixels, int owner_count)
    : owner_count_(owner_count), pixels_(owner_count > 0 ? pixels : 0) {}

void FilmOwners::add(std::vector<OwnerWeight>& to, std::uint64_t owner, double weight) {
  const auto at = std::ranges::lower_bound(to, owner, {}, &OwnerWeight::owner);
  if (at != to.end() && at->owner == owner)
    at->weight += weight;
  else if (to.size() < kMostOwnersOfPixel)
    to.insert(at, {owner, weight});
}

std::span<const std::uint32_t> FilmOwners::add(std::size_t first, std::size_t count,
                                               std::span<const std::uint32_t> pairs) {
  for (std::size_t pixel = first; pixel < first + count; ++pixel) {
    const std::size_t end = 1 + 2 * std::size_t(pairs[0]);
    for (std::size_t k = 1; k < end; k += 2)
      if (pairs[k] != NOBODY) add(pixels_[pixel], pairs[k], pairs[k + 1]);
    pairs = pairs.subspan(end);
  }
  return pairs;
}

void FilmOwners::clear(std::size_t first, std::size_t count) {
  for (std::size_t pixel = first; is_kept() && pixel < first + count; ++pixel) pixels_[pixel].clear();
}

void FilmOwners::set_sum_of(std::size_t pixel, std::span<const OwnerWeight> a, double scale_a,
                            std::span<const OwnerWeight> b, double scale_b) {
  std::vector<OwnerWeight>& sum = pixels_[pixel];
  sum.clear();
  for (const OwnerWeight& each : a) add(sum, each.owner, scale_a * each.weight);
  for (const OwnerWeight& each : b) add(sum, each.owner, scale_b * each.weight);
}

std::uint64_t FilmOwners::hash(std::uint64_t seed) const {
  for (const auto& owners : pixels_) {
    const std::uint64_t size = owners.size();
    seed = XXH3_64bits_withSeed(&size, sizeof size, seed);
    seed = XXH3_64bits_withSeed(owners.data(), owners.size() * sizeof(OwnerWeight), seed);
  }
  return seed;
}

void FilmOwners::write(ByteWriter& bytes) const {
  for (const auto& owners : pixels_) {
    bytes.u64(owners.size());
    bytes.row(owners);
  }
}

Expected<void> FilmOwners::read(ByteReader& bytes) {
  for (auto& owners : pixels_) {
    const std::uint64_t size = bytes.u64();
    if (size > kMostOwnersOfPixel) return fail("a pixel of too many owners");
    owners.resize(std::size_t(size));
    if (!bytes.row(owners)) return fail("it ends in its owners");
    std::uint64_t before = NOBODY;
    for (const OwnerWeight& each : owners) {
      if (each.owner <= before || each.owner > std::uint64_t(owner_count_) || !(each.weight > 0) ||
          !std::isfinite(each.weight))
        return fail("a pixel with an owner that cannot be");
      before = each.owner;
    }
  }
  return {};
}

bool FilmOwners::are_of(std::size_t pixel, std::uint64_t samples) const {
  double all = 0;
  for (const OwnerWeight& each : pixels_[pixel]) all += each.weight;
  return all <= double(samples) * (1 + 1e-12);  // of a mean of two halves all is rounded
}

}  // namespace penumbra
