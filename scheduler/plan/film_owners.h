// Whom the samples of each pixel met: merged counts of owners.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/plan/byte_stream.h"

namespace penumbra {

/// An owner of a device scene, from 1 on, and how many of the pixel's samples met it: a whole number, exact,
/// but for a mean of two halves.
struct OwnerWeight {
  std::uint64_t owner = 0;
  double weight = 0;
  friend bool operator==(const OwnerWeight&, const OwnerWeight&) = default;
};

/// That a pixel can have. Of more the first count, in the order of passes and in one pass of their numbers.
constexpr std::size_t kMostOwnersOfPixel = 64;

class FilmOwners {
 public:
  FilmOwners() = default;
  /// Of a scene with so many owners; 0: there are none and nothing is kept.
  FilmOwners(std::size_t pixels, int owner_count);

  [[nodiscard]] bool is_kept() const { return owner_count_ > 0; }
  [[nodiscard]] int owner_count() const { return owner_count_; }
  /// Of the memory that a pixel takes in pictures with a few owners each; the list, and those that it has
  /// room for.
  static constexpr std::uint64_t kBytesPerPixel = sizeof(std::vector<OwnerWeight>) + 4 * sizeof(OwnerWeight);
  /// That write() makes of a pixel, at most.
  static constexpr std::uint64_t kMostBytesPerPixel =
      sizeof(std::uint64_t) + kMostOwnersOfPixel * sizeof(OwnerWeight);

  /// Adds the pairs of a row of pixels, the first of which is `first`, as SampleBuffer::owners has them;
  /// returns what follows.
  std::span<const std::uint32_t> add(std::size_t first, std::size_t count,
                                     std::span<const std::uint32_t> pairs);
  /// In the order of their numbers.
  [[nodiscard]] std::span<const OwnerWeight> at(std::size_t pixel) const { return pixels_[pixel]; }
  void clear(std::size_t first, std::size_t count);
  /// What the pixel has becomes `scale_a` times those of a and `scale_b` times those of b.
  void set_sum_of(std::size_t pixel, std::span<const OwnerWeight> a, double scale_a,
                  std::span<const OwnerWeight> b, double scale_b);

  [[nodiscard]] std::uint64_t hash(std::uint64_t seed) const;
  void write(ByteWriter& bytes) const;
  /// Takes the state of one of the same size. Errors: that is not what the bytes are.
  Expected<void> read(ByteReader& bytes);
  /// Whether no more samples met somebody than the pixel has.
  [[nodiscard]] bool are_of(std::size_t pixel, std::uint64_t samples) const;

 private:
  void add(std::vector<OwnerWeight>& to, std::uint64_t owner, double weight);

  int owner_count_ = 0;
  std::vector<std::vector<OwnerWeight>> pixels_;
};

}  // namespace penumbra
