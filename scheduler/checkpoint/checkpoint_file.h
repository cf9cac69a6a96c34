// A checkpoint on disk that is updated repeatedly during a render.
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

/// The largest fraction of a render's time spent on copying and writing checkpoints.
constexpr double kCheckpointShare = 0.01;

/// The file is replaced atomically, so it is a complete checkpoint at any time, or absent. A separate thread
/// writes it. A failure is reported once; the render continues, and later checkpoints are tried again.
class CheckpointFile final : public CheckpointSink {
 public:
  /// Writes every `interval` seconds, or less often if that would take more than kCheckpointShare of the
  /// time; 0: never.
  CheckpointFile(std::filesystem::path path, RenderIdentity identity, Seconds interval);
  CheckpointFile(const CheckpointFile&) = delete;
  CheckpointFile& operator=(const CheckpointFile&) = delete;
  ~CheckpointFile() override;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] bool exists() const;
  /// The state in the file; nothing if there is no file. Errors: those of decode_checkpoint; the file cannot
  /// be read.
  [[nodiscard]] Expected<std::optional<ResumedState>> read(Merge empty) const;

  bool is_due(const Merge& merge) override;
  void keep(const Merge& merge, Seconds rendered) override;
  void keep_last(const Merge& merge, Seconds rendered) override;
  std::optional<std::string> take_problem() override;
  /// For use when the render is complete and its output files are written.
  void remove() override;

 private:
  using Clock = std::chrono::steady_clock;

  void write_what_comes();
  void wait_until_written();

  const std::filesystem::path path_;
  const RenderIdentity identity_;
  const Seconds interval_;

  std::optional<Clock::time_point> due_;  // used by the farm's thread only
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::uint8_t> bytes_;  // filled by the farm's thread while the writing thread waits
  bool to_be_written_ = false, ended_ = false;
  Seconds copy_seconds_ = 0;
  std::optional<Seconds> cost_;  // of the last checkpoint, until the next due time is computed from it
  std::string problem_;
  bool told_ = false;
  std::thread thread_;
};

}  // namespace penumbra
