#include "scheduler/plan/film_mattes.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>

#include "kernels/scene_types.h"

namespace penumbra {

FilmMattes::FilmMattes(std::size_t pixels, int matte_count)
    : matte_count_(matte_count), pixels_(matte_count > 0 ? pixels : 0) {}

void FilmMattes::add(std::vector<MatteWeight>& to, std::uint64_t matte, double weight) {
  const auto at = std::ranges::lower_bound(to, matte, {}, &MatteWeight::matte);
  if (at != to.end() && at->matte == matte)
    at->weight += weight;
  else if (to.size() < kMostMattesOfPixel)
    to.insert(at, {matte, weight});
}

std::span<const std::uint32_t> FilmMattes::add(std::size_t first, std::size_t count,
                                               std::span<const std::uint32_t> pairs) {
  for (std::size_t pixel = first; pixel < first + count; ++pixel) {
    const std::size_t end = 1 + 2 * std::size_t(pairs[0]);
    for (std::size_t k = 1; k < end; k += 2)
      if (pairs[k] != NO_MATTE) add(pixels_[pixel], pairs[k], pairs[k + 1]);
    pairs = pairs.subspan(end);
  }
  return pairs;
}

void FilmMattes::clear(std::size_t first, std::size_t count) {
  for (std::size_t pixel = first; is_kept() && pixel < first + count; ++pixel) pixels_[pixel].clear();
}

void FilmMattes::set_sum_of(std::size_t pixel, std::span<const MatteWeight> a, double scale_a,
                            std::span<const MatteWeight> b, double scale_b) {
  std::vector<MatteWeight>& sum = pixels_[pixel];
  sum.clear();
  for (const MatteWeight& each : a) add(sum, each.matte, scale_a * each.weight);
  for (const MatteWeight& each : b) add(sum, each.matte, scale_b * each.weight);
}

std::uint64_t FilmMattes::hash(std::uint64_t seed) const {
  for (const auto& mattes : pixels_) {
    const std::uint64_t size = mattes.size();
    seed = XXH3_64bits_withSeed(&size, sizeof size, seed);
    seed = XXH3_64bits_withSeed(mattes.data(), mattes.size() * sizeof(MatteWeight), seed);
  }
  return seed;
}

void FilmMattes::write(ByteWriter& bytes) const {
  for (const auto& mattes : pixels_) {
    bytes.u64(mattes.size());
    bytes.row(mattes);
  }
}

Expected<void> FilmMattes::read(ByteReader& bytes) {
  for (auto& mattes : pixels_) {
    const std::uint64_t size = bytes.u64();
    if (size > kMostMattesOfPixel) return fail("a pixel of too many mattes");
    mattes.resize(std::size_t(size));
    if (!bytes.row(mattes)) return fail("it ends in its mattes");
    std::uint64_t before = NO_MATTE;
    for (const MatteWeight& each : mattes) {
      if (each.matte <= before || each.matte > std::uint64_t(matte_count_) || !(each.weight > 0) ||
          !std::isfinite(each.weight))
        return fail("a pixel with a matte that cannot be");
      before = each.matte;
    }
  }
  return {};
}

bool FilmMattes::are_of(std::size_t pixel, std::uint64_t samples) const {
  double all = 0;
  for (const MatteWeight& each : pixels_[pixel]) all += each.weight;
  return all <= double(samples) * (1 + 1e-12);  // in a mean of two halves the counts are rounded
}

}  // namespace penumbra
