#include "scheduler/farm/worker_connection.h"

#include <fmt/format.h>

#include <utility>

#include "worker/protocol/text.h"

namespace penumbra {
namespace {

constexpr int kMostCompiles = 64;
constexpr const char* kUnsolicited = "the worker was not asked for this unit";
constexpr const char* kMixed = "it came between the parts of another result";

}  // namespace

// --- To the worker

void WorkerConnection::send(wire::SchedulerMessage message) {
  const std::lock_guard lock(mutex_);
  if (sent_away_) return;
  outbox_.push_back(std::move(message));
  write_next();
}

void WorkerConnection::write_next() {
  if (stream_ == nullptr || writing_ || closed_ || outbox_.empty()) return;
  outgoing_ = std::move(outbox_.front());
  outbox_.pop_front();
  writing_ = true;
  stream_->write(outgoing_);
}

void WorkerConnection::send_job(JobId job, const std::string& scene_hash, const DeviceOptions& device) {
  wire::SchedulerMessage message;
  message.mutable_job()->set_id(job);
  message.mutable_job()->set_scene(scene_hash);
  encode(device, *message.mutable_job()->mutable_device());
  {
    const std::lock_guard lock(mutex_);
    ++awaited_[job];
    forgotten_.erase(job);
    compiles_ = 0;
  }
  send(std::move(message));
}

void WorkerConnection::forget_job(JobId job) {
  wire::SchedulerMessage message;
  message.mutable_forget()->set_job(job);
  {
    const std::lock_guard lock(mutex_);
    forgotten_.insert(job);
    std::erase_if(expected_, [&](const auto& expected) { return expected.first.job == job; });
    std::erase_if(
        outbox_, [&](const auto& waiting) { return waiting.has_unit() && waiting.unit().id().job() == job; });
  }
  send(std::move(message));
}

void WorkerConnection::send_unit(const UnitId& id, const RenderUnit& unit, const FilmLayers& layers) {
  wire::SchedulerMessage message;
  {
    const std::lock_guard lock(mutex_);
    expected_[id] = {unit, layers};
    encode(id, view_of(id.job), *message.mutable_unit()->mutable_id());
  }
  encode(unit, *message.mutable_unit());
  send(std::move(message));
}

void WorkerConnection::send_view(JobId job, const WatchView& view) {
  wire::SchedulerMessage message;
  message.mutable_view()->set_job(job);
  message.mutable_view()->set_number(view.number);
  encode(view.view, *message.mutable_view()->mutable_view());
  const auto is_of_older_view = [job](const wire::SchedulerMessage& waiting) {
    return (waiting.has_unit() && waiting.unit().id().job() == job) ||
           (waiting.has_view() && waiting.view().job() == job);
  };
  {
    const std::lock_guard lock(mutex_);
    views_[job] = view.number;
    std::erase_if(expected_, [&](const auto& expected) { return expected.first.job == job; });
    std::erase_if(outbox_, is_of_older_view);
  }
  send(std::move(message));
}

void WorkerConnection::send_final(wire::SchedulerMessage message) {
  const std::lock_guard lock(mutex_);
  if (sent_away_) return;
  outbox_.push_back(std::move(message));
  sent_away_ = true;
  expected_.clear();
  write_next();
  if (stream_ != nullptr) stream_->is_final();
}

void WorkerConnection::dismiss(const std::string& reason, bool comes_back) {
  wire::SchedulerMessage message;
  message.mutable_dismiss()->set_comes_back(comes_back);
  message.mutable_dismiss()->set_reason(wire_text(reason, kLongestText));
  send_final(std::move(message));
}

void WorkerConnection::refuse(const std::string& reason) {
  wire::SchedulerMessage message;
  message.mutable_refused()->set_reason(wire_text(reason, kLongestText));
  send_final(std::move(message));
}

// --- Called by the stream

void WorkerConnection::attach(Stream& stream) {
  const std::lock_guard lock(mutex_);
  stream_ = &stream;
  write_next();
  if (sent_away_) stream_->is_final();
}

void WorkerConnection::detach() {
  const std::lock_guard lock(mutex_);
  stream_ = nullptr;
}

bool WorkerConnection::written(bool ok) {
  const std::lock_guard lock(mutex_);
  writing_ = false;
  if (closed_) return true;
  if (ok)
    write_next();
  else
    stream_ = nullptr;  // broken; the reading end notices it too
  return false;
}

bool WorkerConnection::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  return !writing_;
}

void WorkerConnection::cut_off() {
  const std::lock_guard lock(mutex_);
  if (stream_ != nullptr) stream_->cancel();
}

// --- From the worker

bool WorkerConnection::has_ended() const {
  const std::lock_guard lock(mutex_);
  return sent_away_;
}

std::uint32_t WorkerConnection::view_of(JobId job) const {
  const auto found = views_.find(job);
  return found == views_.end() ? 0 : found->second;
}

bool WorkerConnection::is_outdated(JobId job, std::uint32_t view) const {
  const std::lock_guard lock(mutex_);
  return view < view_of(job) || forgotten_.contains(job);
}

bool WorkerConnection::is_awaited(JobId job) const {
  const std::lock_guard lock(mutex_);
  return awaited_.contains(job);
}

/// The worker has answered a job that it was sent. Returns whether the answer is for the latest time that the
/// job was sent.
Expected<bool> WorkerConnection::end_preparing(JobId job) {
  const std::lock_guard lock(mutex_);
  const auto found = awaited_.find(job);
  if (found == awaited_.end()) return fail("Ready was sent more often than the job was given");
  const bool is_last = --found->second == 0;
  if (is_last) awaited_.erase(found);
  return is_last;
}

std::optional<WorkerConnection::Expectation> WorkerConnection::expectation(const UnitId& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = expected_.find(id);
  return found == expected_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<WorkerConnection::Expectation> WorkerConnection::fulfil(const UnitId& id) {
  const std::lock_guard lock(mutex_);
  const auto found = expected_.extract(id);
  return found ? std::optional(found.mapped()) : std::nullopt;
}

bool WorkerConnection::is_partial(const wire::UnitId& id) const {
  return partial_ && partial_->unit == decode(id) && partial_->view == id.view();
}

Arrival WorkerConnection::bad_result(const wire::UnitId& id, std::string why) {
  partial_.reset();
  const UnitId unit = decode(id);
  fulfil(unit);
  return arrivals::BadResult{worker_, unit, id.view(), std::move(why)};
}

std::variant<WorkerConnection::Nothing, WorkerConnection::NoRoom, Arrival> WorkerConnection::take_part(
    const wire::ResultPart& message) {
  if (partial_ && !is_partial(message.id())) return bad_result(message.id(), kMixed);
  if (!partial_) {
    const UnitId id = decode(message.id());
    const std::optional<Expectation> expected = expectation(id);
    if (!expected) return bad_result(message.id(), kUnsolicited);
    std::shared_ptr<void> room = room_.take(result_bytes(expected->unit, expected->layers));
    if (!room) return NoRoom{};
    partial_.emplace(id, message.id().view(), ResultAssembly(expected->unit, expected->layers),
                     std::move(room));
  }
  if (const Expected<void> added = partial_->assembly.add(message); !added)
    return bad_result(message.id(), added.error().message);
  ++received_;
  return arrivals::Beat{worker_, parts_ + received_};
}

Arrival WorkerConnection::decode_result(const wire::UnitResult& message) {
  if (partial_ && !is_partial(message.id())) return bad_result(message.id(), kMixed);
  const UnitId id = decode(message.id());
  const std::optional<Expectation> expected = fulfil(id);
  if (!expected) return bad_result(message.id(), kUnsolicited);
  std::optional<Partial> partial = std::exchange(partial_, {});
  ResultAssembly assembly =
      partial ? std::move(partial->assembly) : ResultAssembly(expected->unit, expected->layers);
  Expected<SampleBuffer> buffer = assembly.finish(message);
  if (!buffer) return bad_result(message.id(), buffer.error().message);
  return arrivals::Result{.worker = worker_,
                          .unit = id,
                          .view = message.id().view(),
                          .buffer = std::move(*buffer),
                          .hash = assembly.hash(),
                          .busy_seconds = message.busy_seconds(),
                          .peak_memory_bytes = message.peak_memory_bytes(),
                          .room = partial ? std::move(partial->room) : nullptr};
}

Arrival WorkerConnection::decode_failure(const wire::UnitFailed& message) {
  if (partial_ && !is_partial(message.id())) return bad_result(message.id(), kMixed);
  partial_.reset();
  const UnitId id = decode(message.id());
  if (!fulfil(id)) return bad_result(message.id(), kUnsolicited);
  return arrivals::UnitFailed{worker_, id, message.id().view(), wire_text(message.message(), kLongestText)};
}

arrivals::Beat WorkerConnection::vouch() {
  const std::lock_guard reading(reading_mutex_);
  return {worker_, parts_ + ++received_};
}

Expected<std::variant<WorkerConnection::Nothing, WorkerConnection::NoRoom, Arrival>>
WorkerConnection::understand(const wire::WorkerMessage& message) {
  const std::lock_guard reading(reading_mutex_);
  if (has_ended()) {
    partial_.reset();
    return Nothing{};
  }
  if (partial_ && is_outdated(partial_->unit.job, partial_->view)) partial_.reset();
  switch (message.content_case()) {
    case wire::WorkerMessage::kCompiling:
      if (!is_awaited(message.compiling().job()) || ++compiles_ > kMostCompiles)
        return fail("a worker compiles for a job that it was given, before it is ready");
      return arrivals::Compiling{worker_, wire_text(message.compiling().device(), kLongestName)};
    case wire::WorkerMessage::kReady: {
      const JobId job = message.ready().job();
      const Expected<bool> wanted = end_preparing(job);
      if (!wanted) return std::unexpected(wanted.error());
      if (!*wanted) return Nothing{};
      Expected<DevicePreparation> preparation = decode(message.ready());
      if (!preparation) return std::unexpected(preparation.error());
      return arrivals::Ready{worker_,
                             job,
                             wire_text(message.ready().device(), kLongestName),
                             std::move(*preparation),
                             {message.ready().scene().fetched(), message.ready().scene().found()}};
    }
    case wire::WorkerMessage::kLeaving:
      return arrivals::Leaving{worker_, wire_text(message.leaving().reason(), kLongestText)};
    case wire::WorkerMessage::kBeat:
      parts_ = message.beat().parts();
      return arrivals::Beat{worker_, parts_ + received_};
    case wire::WorkerMessage::kJobFailed: {
      const JobId job = message.job_failed().job();
      const Expected<bool> wanted = end_preparing(job);
      if (!wanted) return std::unexpected(wanted.error());
      if (!*wanted) return Nothing{};
      return arrivals::JobFailed{worker_, job, wire_text(message.job_failed().message(), kLongestText)};
    }
    case wire::WorkerMessage::kPart:
      if (is_outdated(message.part().id().job(), message.part().id().view())) return Nothing{};
      return take_part(message.part());
    case wire::WorkerMessage::kResult:
      if (is_outdated(message.result().id().job(), message.result().id().view())) return Nothing{};
      return decode_result(message.result());
    case wire::WorkerMessage::kUnitFailed:
      if (is_outdated(message.unit_failed().id().job(), message.unit_failed().id().view())) return Nothing{};
      return decode_failure(message.unit_failed());
    default:
      return fail("a message that a worker may not send here");
  }
}

}  // namespace penumbra
