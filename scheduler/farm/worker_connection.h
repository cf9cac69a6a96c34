// The scheduler's side of one worker's stream: which messages are valid when, and which are queued for the
// worker.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/sync_stream.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <variant>

#include "scheduler/farm/arrivals.h"
#include "scheduler/protocol/wire.h"

namespace penumbra {

/// One thread reads the stream and decodes its messages here. Another one writes what any thread sends, so no
/// sender waits for a worker that does not read.
class WorkerConnection {
 public:
  using Stream = grpc::ServerReaderWriter<wire::SchedulerMessage, wire::WorkerMessage>;

  explicit WorkerConnection(WorkerId worker) : worker_(worker) {}

  // --- To the worker; nothing after the first final message (Refused or Dismiss)

  void send_job(JobId job, const std::string& scene_hash, const DeviceOptions& device);
  /// Units of the job are not expected to be answered any more.
  void forget_job(JobId job);
  void send_unit(const UnitId& id, const RenderUnit& unit, int planes);
  /// Units of the job's older views that have not left yet need not.
  void send_view(JobId job, const WatchView& view);
  /// `comes_back`: the scheduler does, and the worker may wait for it.
  void dismiss(const std::string& reason, bool comes_back = false);
  void refuse(const std::string& reason);

  /// Writes until `close`, or until the stream is broken. A worker that stays after the final message is cut
  /// off.
  void write_to(Stream& stream, grpc::ServerContext& context);
  /// Nothing is to be written any more.
  void close();
  /// Whether `write_to` has come back, within a moment.
  bool wait_until_written();

  // --- From the worker

  struct Nothing {};  ///< it is too late for that: of an older view or a forgotten job, or from one sent away
  /// What a message after Hello means; or what is wrong about it, and ends the connection.
  Expected<std::variant<Nothing, Arrival>> understand(const wire::WorkerMessage& message);
  /// The scheduler, or the worker itself, has said that this is over.
  [[nodiscard]] bool has_ended() const;

 private:
  struct Expectation {
    RenderUnit unit;
    int planes = 0;
  };

  void send(wire::SchedulerMessage message);
  void write_all(Stream& stream, grpc::ServerContext& context);
  void send_final(wire::SchedulerMessage message);
  [[nodiscard]] std::uint32_t view_of(JobId job) const;  // the lock is held
  [[nodiscard]] bool is_awaited(JobId job) const;
  Expected<bool> end_preparing(JobId job);
  bool is_outdated(const wire::UnitId& id) const;
  std::optional<Expectation> fulfil(const UnitId& id);
  Arrival decode_result(const wire::UnitResult& message);
  Arrival decode_failure(const wire::UnitFailed& message);

  const WorkerId worker_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<wire::SchedulerMessage> outbox_;
  std::map<UnitId, Expectation> expected_;
  std::map<JobId, std::uint32_t> views_;  // of jobs that have had another one than the first
  std::map<JobId, int> awaited_;          // how often it was given without a Ready or JobFailed so far
  std::set<JobId> forgotten_;
  bool sent_away_ = false, closed_ = false, written_ = false;
  int compiles_ = 0;
};

}  // namespace penumbra
