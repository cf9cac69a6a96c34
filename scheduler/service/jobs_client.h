// A client of a service: gives it jobs, asks after them, fetches what came of them.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "jobs.pb.h"
#include "kernels/host/device_scene.h"
#include "kernels/host/error.h"
#include "scheduler/keys/client_access.h"
#include "scheduler/plan/work_unit.h"
#include "scheduler/service/submission.h"

namespace grpc {
class Status;
}

namespace penumbra {

/// Every call waits for the service at most for a while. Errors are texts for people that name the address;
/// is_away() tells whether the service could not be reached at all, so that trying again later makes sense.
class JobsClient {
 public:
  /// "unix:/path" or "host:port", where the token is needed.
  JobsClient(std::string address, ClientAccess access);
  ~JobsClient();

  /// Waits for a connection that is on the way, for some seconds; calls `is_slow` if it takes more than one.
  /// Whether there is one then, the next call says.
  void connect(const std::function<void()>& is_slow) const;

  /// The scene first, if the service has it not; its hash is the submission's.
  Expected<JobId> submit(const Submission& submission, const DeviceScene& scene);
  /// Of these, or of all.
  Expected<wire::StatusReply> status(const std::vector<JobId>& jobs);
  Expected<void> cancel(const std::vector<JobId>& jobs);
  Expected<void> set_priority(const std::vector<JobId>& jobs, int priority);
  Expected<void> remove(const std::vector<JobId>& jobs);
  /// Writes one of a job's files to `path`, whole or not at all.
  Expected<void> fetch(JobId job, const wire::StoredFile& file, const std::filesystem::path& path);
  /// Whether the last error was that the service could not be reached.
  [[nodiscard]] bool is_away() const { return is_away_; }

 private:
  Expected<void> send_scene(const std::string& hash, const DeviceScene& scene);
  Expected<void> change(wire::ChangeRequest request, const std::vector<JobId>& jobs);
  [[nodiscard]] std::unexpected<Error> failed(const grpc::Status& status);
  template <typename Request>
  Request request() const;

  const std::string address_;
  const ClientAccess access_;
  struct Connection;
  const std::unique_ptr<const Connection> connection_;
  bool is_away_ = false;
};

}  // namespace penumbra
