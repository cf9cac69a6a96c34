// Counts, for each pixel, how many samples hit each matte (Cryptomatte).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/plan/byte_stream.h"

namespace penumbra {

/// A matte ID, from 1 on, and the number of the pixel's samples that hit it. The number is an integer and
/// exact, except in a mean of two halves.
struct MatteWeight {
  std::uint64_t matte = 0;
  double weight = 0;
  friend bool operator==(const MatteWeight&, const MatteWeight&) = default;
};

/// The largest number of mattes per pixel. If there are more, those that come first are kept, in the order of
/// passes, and within a pass by ID.
constexpr std::size_t kMostMattesOfPixel = 64;

class FilmMattes {
 public:
  FilmMattes() = default;
  /// `matte_count`: the scene's number of mattes; with 0 nothing is stored.
  FilmMattes(std::size_t pixels, int matte_count);

  [[nodiscard]] bool is_kept() const { return matte_count_ > 0; }
  /// Memory per pixel in images with a few mattes per pixel: the list and the capacity of its elements.
  static constexpr std::uint64_t kBytesPerPixel = sizeof(std::vector<MatteWeight>) + 4 * sizeof(MatteWeight);
  /// The most bytes that write() produces per pixel.
  static constexpr std::uint64_t kMostBytesPerPixel =
      sizeof(std::uint64_t) + kMostMattesOfPixel * sizeof(MatteWeight);

  /// Adds the matte pairs of a row of pixels that begins at `first`, in the form of SampleBuffer::mattes.
  /// Returns the remaining pairs.
  std::span<const std::uint32_t> add(std::size_t first, std::size_t count,
                                     std::span<const std::uint32_t> pairs);
  /// By ascending ID.
  [[nodiscard]] std::span<const MatteWeight> at(std::size_t pixel) const { return pixels_[pixel]; }
  void clear(std::size_t first, std::size_t count);
  /// Sets the pixel to `scale_a` times the counts of a plus `scale_b` times those of b.
  void set_sum_of(std::size_t pixel, std::span<const MatteWeight> a, double scale_a,
                  std::span<const MatteWeight> b, double scale_b);

  [[nodiscard]] std::uint64_t hash(std::uint64_t seed) const;
  void write(ByteWriter& bytes) const;
  /// Reads the state of an object of the same size. Errors: the bytes are not such a state.
  Expected<void> read(ByteReader& bytes);
  /// Whether the counts are consistent with a pixel of `samples` samples.
  [[nodiscard]] bool are_of(std::size_t pixel, std::uint64_t samples) const;

 private:
  void add(std::vector<MatteWeight>& to, std::uint64_t matte, double weight);

  int matte_count_ = 0;
  std::vector<std::vector<MatteWeight>> pixels_;
};

}  // namespace penumbra
