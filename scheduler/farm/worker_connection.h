// The scheduler's side of one worker's stream: which messages are valid when, and which are queued for the
// worker.
#pragma once

#include <atomic>
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

/// The stream's reading end has its messages decoded here. What any thread sends is written one message after
/// the other, the next when the stream says that the last one is gone: no sender waits for a worker that does
/// not read.
class WorkerConnection {
 public:
  /// The writing end of a stream. Called with the connection's lock held, so it must not call back at once.
  class Stream {
   public:
    virtual ~Stream() = default;
    /// The message stays until `written`.
    virtual void write(const wire::SchedulerMessage& message) = 0;
    /// Nothing but the final message is to be written any more.
    virtual void is_final() = 0;
    /// Breaks the stream.
    virtual void cancel() = 0;
  };

  explicit WorkerConnection(WorkerId worker) : worker_(worker) {}
  /// Locks for the thread sanitizer's sake, which does not see that all streams are over.
  ~WorkerConnection() { const std::lock_guard lock(mutex_); }

  // --- To the worker; nothing after the first final message (Refused or Dismiss)

  void send_job(JobId job, const std::string& scene_hash, const DeviceOptions& device);
  /// Units of the job are not expected to be answered any more.
  void forget_job(JobId job);
  void send_unit(const UnitId& id, const RenderUnit& unit, const FilmLayers& layers);
  /// Units of the job's older views that have not left yet need not.
  void send_view(JobId job, const WatchView& view);
  /// `comes_back`: the scheduler does, and the worker may wait for it.
  void dismiss(const std::string& reason, bool comes_back = false);
  void refuse(const std::string& reason);

  // --- By the stream

  /// It takes messages from now on, until `detach`.
  void attach(Stream& stream);
  void detach();
  /// The last message given to it is gone, or will never be; true if the stream may be finished now, because
  /// `close` was waiting for that.
  bool written(bool ok);
  /// Nothing more is to be written; true if nothing is being written either.
  bool close();
  /// Breaks the stream, if there is one still.
  void cut_off();

  // --- From the worker

  struct Nothing {};  ///< it is too late for that: of an older view or a forgotten job, or from one sent away
  /// What a message after Hello means; or what is wrong about it, and ends the connection.
  Expected<std::variant<Nothing, Arrival>> understand(const wire::WorkerMessage& message);
  /// The scheduler, or the worker itself, has said that this is over.
  [[nodiscard]] bool has_ended() const;

 private:
  struct Expectation {
    RenderUnit unit;
    FilmLayers layers = {};
  };

  void send(wire::SchedulerMessage message);
  void write_next();  // the lock is held
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
  Stream* stream_ = nullptr;
  std::deque<wire::SchedulerMessage> outbox_;
  wire::SchedulerMessage outgoing_;  // while it is being written
  std::map<UnitId, Expectation> expected_;
  std::map<JobId, std::uint32_t> views_;  // of jobs that have had another one than the first
  std::map<JobId, int> awaited_;          // how often it was given without a Ready or JobFailed so far
  std::set<JobId> forgotten_;
  bool sent_away_ = false, closed_ = false, writing_ = false;
  std::atomic<int> compiles_ = 0;
};

}  // namespace penumbra
