// A checkpoint on disk, written again and again while a render goes on.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "scheduler/checkpoint/checkpoint.h"

namespace penumbra {

/// Of a render's time, at most, for copying what is merged and for writing it.
constexpr double kCheckpointShare = 0.01;

/// At any moment the file is a whole checkpoint, or not there. It is written by a thread of its own. A
/// failure is a problem that is told once; the render goes on, and the next one is tried.
class CheckpointFile final : public CheckpointSink {
 public:
  /// Every `interval` seconds, or less often where that would take more than kCheckpointShare; 0: never.
  CheckpointFile(std::filesystem::path path, RenderIdentity identity, Seconds interval);
  CheckpointFile(const CheckpointFile&) = delete;
  CheckpointFile& operator=(const CheckpointFile&) = delete;
  ~CheckpointFile() override;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// What the file holds; nothing if it is not there. Errors: those of decode_checkpoint, a file that cannot
  /// be read.
  [[nodiscard]] Expected<std::optional<ResumedState>> read(Merge empty) const;

  bool is_due(const Merge& merge) override;
  void keep(const Merge& merge, Seconds rendered) override;
  void keep_last(const Merge& merge, Seconds rendered) override;
  std::optional<std::string> take_problem() override;
  /// The render is complete and its files are there.
  void remove() override;

 private:
  using Clock = std::chrono::steady_clock;

  void write_what_comes();
  void wait_until_written();

  const std::filesystem::path path_;
  const RenderIdentity identity_;
  const Seconds interval_;

  std::optional<Clock::time_point> due_;  // of the farm's thread
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::uint8_t> bytes_;  // the farm's thread fills it while the other one waits
  bool to_be_written_ = false, ended_ = false;
  Seconds copy_seconds_ = 0;
  std::optional<Seconds> cost_;  // of the last one, until the next time is known
  std::string problem_;
  bool told_ = false;
  std::thread thread_;
};

}  // namespace penumbra
