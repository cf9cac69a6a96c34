#include "scheduler/farm/worker_connection.h"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "scheduler/protocol/text.h"

namespace penumbra {
namespace {

constexpr int kMostCompiles = 64;
constexpr std::chrono::seconds kTimeToLeave{5};
constexpr std::chrono::milliseconds kTimeToTake{300};  // what was sent last

}  // namespace

// --- To the worker

void WorkerConnection::send(wire::SchedulerMessage message) {
  {
    const std::lock_guard lock(mutex_);
    if (sent_away_) return;
    outbox_.push_back(std::move(message));
  }
  changed_.notify_all();
}

void WorkerConnection::send_job(const std::string& scene_hash, const DeviceOptions& device) {
  wire::SchedulerMessage message;
  message.mutable_job()->set_id(kJob);
  message.mutable_job()->set_scene(scene_hash);
  encode(device, *message.mutable_job()->mutable_device());
  send(std::move(message));
}

void WorkerConnection::send_unit(const UnitId& id, const RenderUnit& unit, int planes) {
  wire::SchedulerMessage message;
  message.mutable_unit()->set_job(kJob);
  encode(id, *message.mutable_unit()->mutable_id());
  encode(unit, *message.mutable_unit());
  {
    const std::lock_guard lock(mutex_);
    expected_[id] = {unit, planes};
  }
  send(std::move(message));
}

void WorkerConnection::send_view(const WatchView& view) {
  wire::SchedulerMessage message;
  message.mutable_view()->set_number(view.number);
  encode(view.view, *message.mutable_view()->mutable_view());
  {
    const std::lock_guard lock(mutex_);
    view_ = view.number;
    std::erase_if(expected_, [&](const auto& expected) { return expected.first.image < view_; });
    std::erase_if(outbox_, [](const auto& waiting) { return waiting.has_unit() || waiting.has_view(); });
  }
  send(std::move(message));
}

void WorkerConnection::send_final(wire::SchedulerMessage message) {
  send(std::move(message));
  const std::lock_guard lock(mutex_);
  sent_away_ = true;
  expected_.clear();
}

void WorkerConnection::dismiss(const std::string& reason) {
  wire::SchedulerMessage message;
  message.mutable_dismiss()->set_reason(wire_text(reason, kLongestText));
  send_final(std::move(message));
}

void WorkerConnection::refuse(const std::string& reason) {
  wire::SchedulerMessage message;
  message.mutable_refused()->set_reason(wire_text(reason, kLongestText));
  send_final(std::move(message));
}

void WorkerConnection::write_to(Stream& stream, grpc::ServerContext& context) {
  write_all(stream, context);
  {
    const std::lock_guard lock(mutex_);
    written_ = true;
  }
  changed_.notify_all();
}

bool WorkerConnection::wait_until_written() {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, kTimeToTake, [this] { return written_; });
}

void WorkerConnection::write_all(Stream& stream, grpc::ServerContext& context) {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return closed_ || sent_away_ || !outbox_.empty(); });
    if (closed_) return;
    if (outbox_.empty()) break;
    const wire::SchedulerMessage message = std::move(outbox_.front());
    outbox_.pop_front();
    lock.unlock();
    if (!stream.Write(message)) return;  // the reader notices too
    lock.lock();
  }
  if (!changed_.wait_for(lock, kTimeToLeave, [this] { return closed_; })) context.TryCancel();
}

void WorkerConnection::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

// --- From the worker

bool WorkerConnection::has_ended() const {
  const std::lock_guard lock(mutex_);
  return sent_away_ || said_failed_;
}

bool WorkerConnection::is_outdated(const wire::UnitId& id) const {
  const std::lock_guard lock(mutex_);
  return id.image() < view_;
}

std::optional<WorkerConnection::Expectation> WorkerConnection::fulfil(const UnitId& id) {
  const std::lock_guard lock(mutex_);
  const auto found = expected_.extract(id);
  return found ? std::optional(found.mapped()) : std::nullopt;
}

Arrival WorkerConnection::decode_result(const wire::UnitResult& message) {
  const UnitId id = decode(message.id());
  const std::optional<Expectation> expected = fulfil(id);
  if (!expected || message.job() != kJob)
    return arrivals::BadResult{worker_, id, "the worker was not asked for this unit"};
  Expected<SampleBuffer> buffer = decode(message, expected->unit, expected->planes);
  if (!buffer) return arrivals::BadResult{worker_, id, buffer.error().message};
  return arrivals::Result{.worker = worker_,
                          .unit = id,
                          .buffer = std::move(*buffer),
                          .hash = result_hash(message),
                          .busy_seconds = message.busy_seconds(),
                          .peak_memory_bytes = message.peak_memory_bytes()};
}

Arrival WorkerConnection::decode_failure(const wire::UnitFailed& message) {
  const UnitId id = decode(message.id());
  if (!fulfil(id)) return arrivals::BadResult{worker_, id, "the worker was not asked for this unit"};
  return arrivals::UnitFailed{worker_, id, wire_text(message.message(), kLongestText)};
}

Expected<std::variant<WorkerConnection::Nothing, Arrival>> WorkerConnection::understand(
    const wire::WorkerMessage& message) {
  if (has_ended()) return Nothing{};
  switch (message.content_case()) {
    case wire::WorkerMessage::kCompiling:
      if (said_ready_ || ++compiles_ > kMostCompiles) return fail("a worker compiles before it is ready");
      return arrivals::Compiling{worker_, wire_text(message.compiling().device(), kLongestName)};
    case wire::WorkerMessage::kReady: {
      if (std::exchange(said_ready_, true)) return fail("a worker is ready once");
      Expected<DevicePreparation> preparation = decode(message.ready());
      if (!preparation) return std::unexpected(preparation.error());
      return arrivals::Ready{worker_, wire_text(message.ready().device(), kLongestName),
                             std::move(*preparation)};
    }
    case wire::WorkerMessage::kBeat:
      return arrivals::Beat{worker_, message.beat().parts()};
    case wire::WorkerMessage::kJobFailed: {
      const std::lock_guard lock(mutex_);
      said_failed_ = true;
      return arrivals::JobFailed{worker_, wire_text(message.job_failed().message(), kLongestText)};
    }
    case wire::WorkerMessage::kResult:
      if (is_outdated(message.result().id())) return Nothing{};
      return decode_result(message.result());
    case wire::WorkerMessage::kUnitFailed:
      if (is_outdated(message.unit_failed().id())) return Nothing{};
      return decode_failure(message.unit_failed());
    default:
      return fail("a message that a worker may not send here");
  }
}

}  // namespace penumbra
