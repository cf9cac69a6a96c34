// The scheduler's side of one worker's stream: checks which messages are valid when, and queues messages for
// the worker.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <variant>

#include "scheduler/farm/arrivals.h"
#include "scheduler/farm/result_room.h"
#include "worker/protocol/unit_result.h"

namespace penumbra {

/// Messages from the stream are decoded here. Any thread may send. Messages are written one after the other,
/// each when the stream reports that the previous one is written, so no sender waits for a worker that does
/// not read.
class WorkerConnection {
 public:
  /// The writing end of a stream. It is called with the connection's lock held, so it must not call back
  /// synchronously.
  class Stream {
   public:
    virtual ~Stream() = default;
    /// The message must stay valid until `written` is called.
    virtual void write(const wire::SchedulerMessage& message) = 0;
    /// After the message being written nothing else will follow.
    virtual void is_final() = 0;
    /// Breaks the stream.
    virtual void cancel() = 0;
  };

  /// `room`: for results that come in parts; it must outlive this.
  WorkerConnection(WorkerId worker, ResultRoom& room) : worker_(worker), room_(room) {}
  /// Locks only for the thread sanitizer, which cannot see that all streams are over.
  ~WorkerConnection() { const std::scoped_lock lock(reading_mutex_, mutex_); }

  // --- To the worker. After the first final message (Refused or Dismiss) nothing more is sent.

  void send_job(JobId job, const std::string& scene_hash, const DeviceOptions& device);
  /// The worker need not answer units of this job any more.
  void forget_job(JobId job);
  void send_unit(const UnitId& id, const RenderUnit& unit, const FilmLayers& layers);
  /// Queued units of older views of the job are not sent.
  void send_view(JobId job, const WatchView& view);
  /// `comes_back`: the scheduler will be restarted, and the worker may wait for it.
  void dismiss(const std::string& reason, bool comes_back = false);
  void refuse(const std::string& reason);

  // --- Called by the stream

  /// Messages are written to this stream from now on, until `detach`.
  void attach(Stream& stream);
  void detach();
  /// The last message was written, or never will be. Returns true if the stream may now be finished, because
  /// `close` was waiting for that.
  bool written(bool ok);
  /// No more messages will be sent. Returns true if none is being written either.
  bool close();
  /// Breaks the stream if it still exists.
  void cut_off();

  // --- From the worker

  /// The message is outdated: of an older view, of a forgotten job, or from a dismissed worker.
  struct Nothing {};
  /// There is no room for the result that begins with the message, which must be shown again later.
  struct NoRoom {};
  /// Decodes a message after Hello. An error ends the connection. Not thread-safe.
  Expected<std::variant<Nothing, NoRoom, Arrival>> understand(const wire::WorkerMessage& message);
  /// Another sign of life with progress, for a worker that waits for room.
  arrivals::Beat vouch();
  /// Whether the scheduler or the worker has ended the conversation.
  [[nodiscard]] bool has_ended() const;

 private:
  struct Expectation {
    RenderUnit unit;
    FilmLayers layers = {};
  };

  void send(wire::SchedulerMessage message);
  void write_next();  // requires the lock
  void send_final(wire::SchedulerMessage message);
  [[nodiscard]] std::uint32_t view_of(JobId job) const;  // requires the lock
  [[nodiscard]] bool is_awaited(JobId job) const;
  Expected<bool> end_preparing(JobId job);
  [[nodiscard]] bool is_outdated(JobId job, std::uint32_t view) const;
  std::optional<Expectation> expectation(const UnitId& id) const;
  std::optional<Expectation> fulfil(const UnitId& id);
  /// A result of which parts have come, but not its end.
  struct Partial {
    UnitId unit;
    std::uint32_t view;
    ResultAssembly assembly;
    std::shared_ptr<void> room;
  };
  [[nodiscard]] bool is_partial(const wire::UnitId& id) const;
  Arrival bad_result(const wire::UnitId& id, std::string why);
  std::variant<Nothing, NoRoom, Arrival> take_part(const wire::ResultPart& message);
  Arrival decode_result(const wire::UnitResult& message);
  Arrival decode_failure(const wire::UnitFailed& message);

  const WorkerId worker_;
  ResultRoom& room_;
  mutable std::mutex mutex_;
  Stream* stream_ = nullptr;
  std::deque<wire::SchedulerMessage> outbox_;
  wire::SchedulerMessage outgoing_;  // the message that is being written
  std::map<UnitId, Expectation> expected_;
  std::map<JobId, std::uint32_t> views_;  // of jobs whose view has changed
  std::map<JobId, int> awaited_;  // how often the job was sent without an answer (Ready or JobFailed) yet
  std::set<JobId> forgotten_;
  bool sent_away_ = false, closed_ = false, writing_ = false;
  std::atomic<int> compiles_ = 0;
  // Used only by understand() and vouch(), which are called one after the other, if from different threads.
  // The lock is for the thread sanitizer, which cannot see that. Parts of units that the worker has done, as
  // it says, and signs of progress of the results that it sends.
  std::mutex reading_mutex_;  // before mutex_
  std::uint64_t parts_ = 0, received_ = 0;
  std::optional<Partial> partial_;
};

}  // namespace penumbra
