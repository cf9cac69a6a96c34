// What a service keeps on disk: its jobs, their scenes, and what came of them. All of it is there again after
// any end of the process.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "jobs.pb.h"
#include "kernels/host/device_scene.h"
#include "kernels/host/error.h"
#include "scheduler/plan/work_unit.h"
#include "scheduler/protocol/asset_manifest.h"
#include "scheduler/protocol/wire.h"

namespace penumbra {

/// A scene as it was kept, and how it travels on.
struct StoredScene {
  DeviceScene scene;
  AssetManifest manifest;
};

/// A folder that one service at a time has to itself:
///   lock
///   next                the number of the next job: none is ever used again
///   scenes/HASH         serialized device scenes, see AssetManifest
///   jobs/NUMBER/job     wire::StoredJob
///   jobs/NUMBER/…       its images and statistics, and a checkpoint while it is rendered
/// Members may be called by several threads at once, those that change one job or scene by one.
class Spool {
 public:
  /// Makes the folder where it is missing, for its owner alone. Errors: another service has it; it cannot be
  /// made.
  static Expected<std::unique_ptr<Spool>> open(const std::filesystem::path& folder);
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;
  ~Spool();

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::filesystem::path folder_of(JobId job) const;

  /// All jobs, by number. What cannot be read is left as it is and told in `problems`.
  [[nodiscard]] std::vector<wire::StoredJob> read_jobs(std::vector<std::string>& problems) const;
  /// Makes the job's folder if it is new; whole or not at all.
  Expected<void> keep(const wire::StoredJob& job);
  void remove(JobId job);
  /// What a render of the job keeps while it is under way, beside its first file.
  [[nodiscard]] std::filesystem::path checkpoint_of(JobId job, const wire::Submission& submission) const;
  void remove_checkpoint(JobId job, const wire::Submission& submission);
  /// Of the next job.
  [[nodiscard]] JobId next_number() const;
  Expected<void> use_number(JobId job);

  [[nodiscard]] bool has_scene(const std::string& hash) const;
  /// Errors: it is not there, or damaged.
  [[nodiscard]] Expected<StoredScene> read_scene(const std::string& hash) const;
  /// Scenes of which none is in `used`.
  void remove_other_scenes(const std::set<std::string>& used);

  /// A scene that arrives in parts; without finish() nothing stays of it.
  class IncomingScene {
   public:
    IncomingScene(IncomingScene&& other) noexcept;
    IncomingScene& operator=(IncomingScene&&) = delete;
    ~IncomingScene();

    /// Error: the disk is full.
    Expected<void> add(std::span<const std::uint8_t> bytes);
    /// Checks the hash, and that it is a scene.
    Expected<void> finish();

   private:
    friend class Spool;
    struct State;
    explicit IncomingScene(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
  };
  /// Error: that is no hash; the file cannot be made.
  Expected<IncomingScene> receive_scene(const std::string& hash);

 private:
  Spool(std::filesystem::path folder, int lock) : folder_(std::move(folder)), lock_(lock) {}
  [[nodiscard]] std::filesystem::path scene_path(const std::string& hash) const {
    return folder_ / "scenes" / hash;
  }

  const std::filesystem::path folder_;
  const int lock_;
};

}  // namespace penumbra
