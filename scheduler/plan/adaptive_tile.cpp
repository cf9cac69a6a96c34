#include "scheduler/plan/adaptive_tile.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace penumbra {
namespace {

constexpr std::uint32_t kFirstDecision = 4;

}  // namespace

AdaptiveTile::AdaptiveTile(FilmAccumulator empty, double target_error, std::uint32_t passes)
    : empty_(std::move(empty)), target_(target_error), passes_(passes) {
  for (Half& half : halves_) half.all = empty_;
}

std::uint32_t AdaptiveTile::next_decision(std::uint32_t passes_done, std::uint32_t passes) {
  std::uint64_t at = kFirstDecision;
  while (at <= passes_done) at += std::max<std::uint64_t>(2, at / 8 * 2);
  return std::uint32_t(std::min<std::uint64_t>(at, passes));
}

void AdaptiveTile::add(std::uint32_t pass, const SampleBuffer& result) {
  halves_[pass % 2].all.add(empty_.x(), empty_.y(), result);
}

bool AdaptiveTile::decide(std::uint32_t passes_done) {
  const std::uint32_t before = std::exchange(done_, passes_done);
  if (passes_done >= passes_) return true;  // halves that were not stopped are used completely
  if (next_decision(before, passes_) != passes_done) return false;
  worst_ = 0;
  bool done = true;
  for (int half = 0; half < 2; ++half) {
    const double error = halves_[1 - half].all.relative_error() / std::numbers::sqrt2 / target_;
    worst_ = std::max(worst_, error);
    if (!halves_[half].kept && error <= 1) halves_[half].kept = halves_[half].all;
    done = done && halves_[half].kept;
  }
  return done;
}

void AdaptiveTile::put_into(FilmAccumulator& film) const { film.set_mean_of(counting(0), counting(1)); }

std::uint32_t AdaptiveTile::passes_expected() const {
  const double expected = std::min(double(done_) * worst_ * worst_, double(passes_));
  return std::max(next_decision(done_, passes_), std::uint32_t(expected));
}

void AdaptiveTile::write(ByteWriter& bytes) const {
  bytes.u64(done_);
  bytes.f64(worst_);
  for (const Half& half : halves_) {
    half.all.write(bytes);
    bytes.u64(half.kept ? 1 : 0);
    if (half.kept) half.kept->write(bytes);
  }
}

Expected<void> AdaptiveTile::read(ByteReader& bytes) {
  const std::uint64_t done = bytes.u64();
  worst_ = bytes.f64();
  if (done == 0 || done >= passes_ || !(worst_ >= 0) || !std::isfinite(worst_))
    return fail("a tile with an invalid decision");
  done_ = std::uint32_t(done);
  for (Half& half : halves_) {
    if (auto read = half.all.read(bytes); !read) return read;
    if (bytes.u64() == 0) continue;
    half.kept = empty_;
    if (auto read = half.kept->read(bytes); !read) return read;
  }
  return {};
}

}  // namespace penumbra
