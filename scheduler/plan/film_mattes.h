// Merged counts of the mattes that the samples of each pixel hit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/plan/byte_stream.h"

namespace penumbra {

/// A matte of a device scene, from 1 on, and how many of the pixel's samples hit it: a whole number, exact,
/// but for a mean of two halves.
struct MatteWeight {
  std::uint64_t matte = 0;
  double weight = 0;
  friend bool operator==(const MatteWeight&, const MatteWeight&) = default;
};

/// That a pixel can have. Of more the first count, in the order of passes and in one pass of their numbers.
constexpr std::size_t kMostMattesOfPixel = 64;

class FilmMattes {
 public:
  FilmMattes() = default;
  /// Of a scene with so many mattes; 0: there are none and nothing is kept.
  FilmMattes(std::size_t pixels, int matte_count);

  [[nodiscard]] bool is_kept() const { return matte_count_ > 0; }
  [[nodiscard]] int matte_count() const { return matte_count_; }
  /// Of the memory that a pixel takes in pictures with a few mattes each; the list, and those that it has
  /// room for.
  static constexpr std::uint64_t kBytesPerPixel = sizeof(std::vector<MatteWeight>) + 4 * sizeof(MatteWeight);
  /// That write() makes of a pixel, at most.
  static constexpr std::uint64_t kMostBytesPerPixel =
      sizeof(std::uint64_t) + kMostMattesOfPixel * sizeof(MatteWeight);

  /// Adds the pairs of a row of pixels, the first of which is `first`, as SampleBuffer::mattes has them;
  /// returns what follows.
  std::span<const std::uint32_t> add(std::size_t first, std::size_t count,
                                     std::span<const std::uint32_t> pairs);
  /// In the order of their numbers.
  [[nodiscard]] std::span<const MatteWeight> at(std::size_t pixel) const { return pixels_[pixel]; }
  void clear(std::size_t first, std::size_t count);
  /// What the pixel has becomes `scale_a` times those of a and `scale_b` times those of b.
  void set_sum_of(std::size_t pixel, std::span<const MatteWeight> a, double scale_a,
                  std::span<const MatteWeight> b, double scale_b);

  [[nodiscard]] std::uint64_t hash(std::uint64_t seed) const;
  void write(ByteWriter& bytes) const;
  /// Takes the state of one of the same size. Errors: that is not what the bytes are.
  Expected<void> read(ByteReader& bytes);
  /// Whether no more samples met somebody than the pixel has.
  [[nodiscard]] bool are_of(std::size_t pixel, std::uint64_t samples) const;

 private:
  void add(std::vector<MatteWeight>& to, std::uint64_t matte, double weight);

  int matte_count_ = 0;
  std::vector<std::vector<MatteWeight>> pixels_;
};

}  // namespace penumbra
