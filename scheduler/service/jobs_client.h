// A client of a service: submits jobs, asks for their status, fetches their files.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "jobs.pb.h"
#include "kernels/host/device_scene.h"
#include "kernels/host/error.h"
#include "scheduler/service/submission.h"
#include "worker/keys/client_access.h"
#include "worker/protocol/asset_manifest.h"
#include "worker/work_unit.h"

namespace grpc {
class Status;
}

namespace penumbra {

/// Every call has a timeout. Errors are texts for users that contain the address. is_away() tells whether the
/// service could not be reached at all, so that trying again later makes sense.
class JobsClient {
 public:
  /// `address`: "unix:/path" or "host:port"; the latter needs a token.
  JobsClient(std::string address, ClientAccess access);
  ~JobsClient();

  /// Waits some seconds for a connection; calls `is_slow` if it takes more than one. Whether there is a
  /// connection then, the next call tells.
  void connect(const std::function<void()>& is_slow) const;

  /// Submits a job, after the scene if the service does not have it yet; of that only blocks that the scene
  /// submitted before does not have. The scene's hash must be that of the submission. The reply has the
  /// numbers of the job and of its group.
  Expected<wire::SubmitReply> submit(const Submission& submission, const DeviceScene& scene);
  // Numbers are those of jobs, or of groups for all their jobs.
  /// The status of these jobs, or of all if the list is empty.
  Expected<wire::StatusReply> status(const std::vector<JobId>& numbers);
  Expected<void> cancel(JobId number);
  Expected<void> set_priority(JobId number, int priority);
  Expected<void> retry(JobId number);
  Expected<void> remove(JobId number);
  /// All jobs of the group have been submitted.
  Expected<void> close_group(JobId group);
  /// Writes one of a job's files to `path` atomically.
  Expected<void> fetch(JobId job, const wire::StoredFile& file, const std::filesystem::path& path);
  /// Bytes of scenes that were sent.
  [[nodiscard]] std::uint64_t sent_bytes() const { return sent_bytes_; }
  /// Whether the last error was that the service could not be reached.
  [[nodiscard]] bool is_away() const { return is_away_; }

 private:
  Expected<void> send_scene(const std::string& hash, const DeviceScene& scene);
  /// In the pieces of the manifest. `base`: a scene that the service has, or null.
  grpc::Status put_scene(const AssetManifest& manifest, const DeviceScene& scene, const AssetManifest* base);
  Expected<void> change(JobId number, wire::ChangeRequest request);
  /// The user's secret, or nothing: only some services ask for it, and the errors of those say why there is
  /// none.
  [[nodiscard]] std::string owner();
  [[nodiscard]] std::unexpected<Error> failed(const grpc::Status& status);
  template <typename Request>
  Request request() const;

  const std::string address_;
  const ClientAccess access_;
  struct Connection;
  const std::unique_ptr<const Connection> connection_;
  bool is_away_ = false;
  std::optional<AssetManifest> before_;  // the scene sent last, in blocks
  std::uint64_t sent_bytes_ = 0;
  std::string why_no_secret_;
};

}  // namespace penumbra
