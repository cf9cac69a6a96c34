#include "scheduler/checkpoint/checkpoint_file.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <utility>

#include "kernels/host/atomic_file.h"
#include "kernels/host/plain_file.h"
#include "kernels/host/process.h"
#include "scheduler/plan/adaptive_tile.h"

namespace penumbra {
namespace {

/// An estimate for copying, checksum and writing until they are measured; more than most machines need.
constexpr double kSecondsPerByte = 2e-9;

/// Limits on a checkpoint's size: films (including halves of tiles) and everything else.
constexpr std::int64_t kMostFilms = 2 + AdaptiveTile::kMostFilms, kMostOtherBytes = std::int64_t(256) << 20;

constexpr Seconds kLongestInterval = 1e8;

/// CPU time of this thread. Waiting for a disk takes nothing from the workers.
Seconds thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

}  // namespace

CheckpointFile::CheckpointFile(std::filesystem::path path, RenderIdentity identity, Seconds interval)
    : path_(std::move(path)), identity_(std::move(identity)), interval_(interval) {
  remove_abandoned_parts(path_);
  thread_ = std::thread([this] { write_what_comes(); });
}

CheckpointFile::~CheckpointFile() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

bool CheckpointFile::exists() const {
  std::error_code ignored;
  return std::filesystem::exists(path_, ignored);
}

Expected<std::optional<ResumedState>> CheckpointFile::read(Merge empty) const {
  if (!exists()) return std::nullopt;
  const auto bytes =
      read_plain_file(path_, kMostOtherBytes + kMostFilms * std::int64_t(empty.film().most_written()));
  if (!bytes) return std::unexpected(bytes.error());
  auto before = decode_checkpoint(bytes_of(*bytes), identity_, std::move(empty));
  if (!before) return fail(fmt::format("cannot go on with {}: {}", path_.string(), before.error().message));
  return std::optional(std::move(*before));
}

bool CheckpointFile::is_due(const Merge& merge) {
  if (interval_ <= 0) return false;
  const auto after = [&](Seconds cost) {
    return Clock::now() +
           std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
               std::clamp(cost / kCheckpointShare, std::min(interval_, kLongestInterval), kLongestInterval)));
  };
  const std::lock_guard lock(mutex_);
  if (to_be_written_) return false;
  if (!due_) due_ = after(kSecondsPerByte * double(merge.film().written_size()));
  if (cost_) due_ = after(*std::exchange(cost_, {}));
  return Clock::now() >= *due_;
}

void CheckpointFile::keep(const Merge& merge, Seconds rendered) {
  const auto begin = Clock::now();
  encode_checkpoint(identity_, merge, rendered, bytes_);
  {
    const std::lock_guard lock(mutex_);
    copy_seconds_ = seconds_since(begin);
    to_be_written_ = true;
  }
  changed_.notify_all();
}

void CheckpointFile::keep_last(const Merge& merge, Seconds rendered) {
  if (interval_ <= 0) return;
  wait_until_written();
  keep(merge, rendered);
  wait_until_written();
}

std::optional<std::string> CheckpointFile::take_problem() {
  const std::lock_guard lock(mutex_);
  if (problem_.empty() || std::exchange(told_, true)) return {};
  return fmt::format("no checkpoint is kept, so this render could not be resumed: {}", problem_);
}

void CheckpointFile::remove() {
  wait_until_written();
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void CheckpointFile::wait_until_written() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !to_be_written_; });
}

// --- The writing thread

void CheckpointFile::write_what_comes() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return to_be_written_ || ended_; });
    if (!to_be_written_) return;
    lock.unlock();
    const Seconds begin = thread_seconds();
    seal_checkpoint(bytes_);
    const Expected<void> written = write_file_atomically(path_, bytes_);
    const Seconds taken = thread_seconds() - begin;
    lock.lock();
    cost_ = copy_seconds_ + taken;
    if (!written) problem_ = written.error().message;
    to_be_written_ = false;
    changed_.notify_all();
  }
}

}  // namespace penumbra
