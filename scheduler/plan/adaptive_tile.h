// A tile that is rendered until its error is small enough, with an unbiased stopping rule.
#pragma once

#include <cstdint>
#include <optional>

#include "kernels/host/error.h"
#include "kernels/host/sample_buffer.h"
#include "scheduler/plan/byte_stream.h"
#include "scheduler/plan/film_accumulator.h"

namespace penumbra {

/// If the decision to stop depends on the samples that are averaged, the average is biased: rendering stops
/// where samples happen to agree, too early if the rare bright ones have not come (Kirk and Arvo 1991). So
/// the passes of a tile are divided into two independent halves, the even and the odd ones. How many passes
/// of one half are used is decided, at fixed numbers of passes, by the samples of the other half alone. Each
/// half's average then has a number of samples that is independent of them, so it is unbiased. The tile is
/// the mean of both halves with equal weights; weights by the numbers of samples would bring the dependence
/// back. Passes that are rendered for the other half's decision, after a half has stopped, are used only for
/// that decision.
///
/// The error is sqrt(mean over the tile's pixels and channels of SE^2 / (mean^2 + .01)), like the film's. The
/// tile's error is taken to be that of the deciding half over sqrt(2). The samples of a pixel must be
/// independent, as those of the independent sampler are.
class AdaptiveTile {
 public:
  static constexpr int kMostFilms = 4;  ///< the number of films of the tile's size that it holds

  /// `empty`: a film of the tile's rectangle without samples. `passes`: the largest number of passes.
  AdaptiveTile(FilmAccumulator empty, double target_error, std::uint32_t passes);

  /// The number of passes at which the next decision is made, after `passes_done`: 4, then a quarter more
  /// each time, always even.
  static std::uint32_t next_decision(std::uint32_t passes_done, std::uint32_t passes);

  void add(std::uint32_t pass, const SampleBuffer& result);
  /// Decides after so many passes. Returns whether the tile is done.
  bool decide(std::uint32_t passes_done);
  /// Writes the current estimate to the tile's rectangle of the film.
  void put_into(FilmAccumulator& film) const;
  /// The expected total number of passes, extrapolated from the error; at least up to the next decision.
  [[nodiscard]] std::uint32_t passes_expected() const;

  void write(ByteWriter& bytes) const;
  Expected<void> read(ByteReader& bytes);

 private:
  struct Half {
    FilmAccumulator all;                  // all passes of this half
    std::optional<FilmAccumulator> kept;  // the passes that are used, once that is decided
  };
  [[nodiscard]] const FilmAccumulator& counting(int half) const {
    return halves_[half].kept ? *halves_[half].kept : halves_[half].all;
  }

  FilmAccumulator empty_;
  double target_;
  std::uint32_t passes_, done_ = 0;
  double worst_ = 0;  // larger error of the two halves at the last decision, relative to their target
  Half halves_[2];
};

}  // namespace penumbra
