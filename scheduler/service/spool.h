// The files of a service: jobs, scenes and results. They survive any end of the process.
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
#include "worker/protocol/asset_manifest.h"
#include "worker/protocol/wire.h"
#include "worker/work_unit.h"

namespace penumbra {

/// A scene as it is stored, with its manifest.
struct StoredScene {
  DeviceScene scene;
  AssetManifest manifest;
};

/// A folder that only one service at a time may use:
///      lock
///      watch.token         see watch_token
///      next                the number of the next job or group; numbers are never reused
///      scenes/HASH         serialised device scenes; see AssetManifest
///      groups/NUMBER       wire::StoredGroup
///      jobs/NUMBER/job     wire::StoredJob
///      jobs/NUMBER/…       its images and statistics, and a checkpoint while it is rendered
/// Several threads may call members at once, but only one at a time for the same job or scene.
class Spool {
 public:
  /// Creates the folder if it is missing, accessible only to its owner. Errors: another service uses it; it
  /// cannot be created.
  static Expected<std::unique_ptr<Spool>> open(const std::filesystem::path& folder);
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;
  ~Spool();

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::filesystem::path folder_of(JobId job) const;

  /// All jobs by number. Files that cannot be read are left alone and reported in `problems`.
  [[nodiscard]] std::vector<wire::StoredJob> read_jobs(std::vector<std::string>& problems) const;
  /// Writes the job atomically. Creates its folder if it is new.
  Expected<void> keep(const wire::StoredJob& job);
  void remove(JobId job);
  /// The same for groups.
  [[nodiscard]] std::vector<wire::StoredGroup> read_groups(std::vector<std::string>& problems) const;
  Expected<void> keep(const wire::StoredGroup& group);
  void remove_group(JobId group);
  /// The path of the job's checkpoint during its render, beside its first file.
  [[nodiscard]] std::filesystem::path checkpoint_of(JobId job, const wire::Submission& submission) const;
  void remove_checkpoint(JobId job, const wire::Submission& submission);
  /// A token for watching that stays the same for all services with this folder, so that a link to the page
  /// in the browser stays good. Error: it cannot be kept.
  Expected<std::string> watch_token();

  /// The number of the next job or group.
  [[nodiscard]] JobId next_number() const;
  Expected<void> use_number(JobId number);

  [[nodiscard]] bool has_scene(const std::string& hash) const;
  /// Errors: the scene is missing or damaged.
  [[nodiscard]] Expected<StoredScene> read_scene(const std::string& hash) const;
  /// Removes all scenes that are not in `used`.
  void remove_other_scenes(const std::set<std::string>& used);

  /// A scene that is received in parts. Without finish() it is discarded.
  class IncomingScene {
   public:
    IncomingScene(IncomingScene&& other) noexcept;
    IncomingScene& operator=(IncomingScene&&) = delete;
    ~IncomingScene();

    /// Error: the disk is full.
    Expected<void> add(std::span<const std::uint8_t> bytes);
    /// Adds these bytes of the base. Errors: it has not so many; those of add().
    Expected<void> add_of_base(std::uint64_t from, std::uint64_t bytes);
    /// Checks the hash and that the data are a scene.
    Expected<void> finish();

   private:
    friend class Spool;
    struct State;
    explicit IncomingScene(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
  };
  /// `base`: another scene, of which parts are taken; empty: none. Errors: not a valid hash; the file cannot
  /// be created; the base is not here.
  Expected<IncomingScene> receive_scene(const std::string& hash, const std::string& base = {});

 private:
  Spool(std::filesystem::path folder, int lock) : folder_(std::move(folder)), lock_(lock) {}
  [[nodiscard]] std::filesystem::path scene_path(const std::string& hash) const {
    return folder_ / "scenes" / hash;
  }

  const std::filesystem::path folder_;
  const int lock_;
};

}  // namespace penumbra
