// A tile that is rendered until its error is small enough, without a bias from stopping.
#pragma once

#include <cstdint>
#include <optional>

#include "kernels/host/error.h"
#include "kernels/host/sample_buffer.h"
#include "scheduler/plan/byte_stream.h"
#include "scheduler/plan/film_accumulator.h"

namespace penumbra {

/// Stopping by the error of the very samples that are averaged biases the average: it stops where they happen
/// to agree, too early where the rare bright ones have not come (Kirk and Arvo 1991). So there are two
/// halves, the even passes and the odd ones, whose samples are independent of each other. How many passes of
/// a half count is decided by the other half's samples alone, at fixed numbers of passes, so each half's
/// average is that of a number of samples that it has no part in: unbiased. The tile is the mean of both,
/// equally weighed, since weights by their numbers would bring the dependence back. Passes that were rendered
/// for the other half's decision, after a half has stopped, count only for that decision.
///
/// An error is sqrt(mean over the tile's pixels and channels of SE^2 / (mean^2 + .01)), as the film's; that
/// of the tile is taken to be the deciding half's over sqrt(2). Samples of a pixel have to be independent,
/// which those of the independent sampler are.
class AdaptiveTile {
 public:
  static constexpr int kMostFilms = 4;  ///< that it holds, of its own size

  /// `empty`: of the tile's rectangle. At most so many passes.
  AdaptiveTile(FilmAccumulator empty, double target_error, std::uint32_t passes);

  /// The next passes of the tile after so many that are decided by: 4, then a quarter more each time, even
  /// numbers.
  static std::uint32_t next_decision(std::uint32_t passes_done, std::uint32_t passes);

  void add(std::uint32_t pass, const SampleBuffer& result);
  /// After so many passes; whether the tile is done.
  bool decide(std::uint32_t passes_done);
  /// What counts so far, into the tile's place.
  void put_into(FilmAccumulator& film) const;
  /// In all, if the error goes on as it does: at least the next decision's.
  [[nodiscard]] std::uint32_t passes_expected() const;

  void write(ByteWriter& bytes) const;
  Expected<void> read(ByteReader& bytes);

 private:
  struct Half {
    FilmAccumulator all;                  // its passes
    std::optional<FilmAccumulator> kept;  // those that count, once it is decided
  };
  [[nodiscard]] const FilmAccumulator& counting(int half) const {
    return halves_[half].kept ? *halves_[half].kept : halves_[half].all;
  }

  FilmAccumulator empty_;
  double target_;
  std::uint32_t passes_, done_ = 0;
  double worst_ = 0;  // error of a half at the last decision, over its target
  Half halves_[2];
};

}  // namespace penumbra
