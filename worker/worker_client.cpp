#include "worker/worker_client.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <future>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <stop_token>
#include <thread>
#include <utility>
#include <variant>

#include "kernels/host/process.h"
#include "penumbra.grpc.pb.h"
#include "worker/back_off.h"
#include "worker/keys/address_file.h"
#include "worker/keys/client_access.h"
#include "worker/keys/tcp_address.h"
#include "worker/keys/unreachable.h"
#include "worker/part_size.h"
#include "worker/piece_cache.h"
#include "worker/protocol/client.h"
#include "worker/protocol/mailbox.h"
#include "worker/protocol/text.h"
#include "worker/protocol/token.h"
#include "worker/protocol/unit_result.h"

namespace penumbra {
namespace {

constexpr std::chrono::seconds kBeatInterval{1};
constexpr std::chrono::milliseconds kTimeToLeave{500};  // to send the message, and to be answered

// Pauses between connection attempts: short for a scheduler on this machine, long where thousands of workers
// may reconnect.
constexpr std::chrono::milliseconds kFirstPause{100}, kFirstPauseHere{20}, kLongestPause{15'000},
    kLongestPauseHere{500};
// An attempt ends when it has failed, or after this time.
constexpr std::chrono::seconds kTimeToConnect{10};
constexpr std::chrono::milliseconds kTimeToExplain{2000};
constexpr std::chrono::milliseconds kAddressFileInterval{500};  // between two looks into an address file
// A unit whose result is no longer needed may take this long before the worker reconnects.
constexpr std::chrono::seconds kTimeToFinish{120};
constexpr double kLongestRetry = 1e9;  // seconds: forever

/// Whether another attempt would end in the same way.
bool is_final(grpc::StatusCode code) {
  return code == grpc::StatusCode::UNAUTHENTICATED || code == grpc::StatusCode::PERMISSION_DENIED ||
         code == grpc::StatusCode::FAILED_PRECONDITION || code == grpc::StatusCode::INVALID_ARGUMENT ||
         code == grpc::StatusCode::UNIMPLEMENTED;
}

/// The key that identifies this process to the scheduler that started it.
std::string own_key() {
  const char* key = std::getenv(kWorkerKeyVariable);
  return key == nullptr ? "" : wire_text(key, kLongestName);
}

struct FinishedUnit {
  wire::UnitId id;
  Expected<SampleBuffer> result;
  double busy_seconds = 0;
};

/// A job from the scheduler that it has not told the worker to forget.
struct KnownJob {
  std::unique_ptr<DeviceScene> scene;
  AssetManifest manifest;
  std::unique_ptr<Device> device;  // declared after the scene that it renders
};

/// How a connection ended, if the worker may connect again.
struct Lost {
  Error why;
  bool was_answered = false;  // by the scheduler, at least once
};
using SessionEnd = std::variant<Lost, Expected<void>>;

/// One connection to a scheduler, from Hello to the end of the stream.
class Session {
 public:
  Session(const WorkerClientOptions& options, std::string address, bool may_return)
      : options_(options), address_(std::move(address)), may_return_(may_return) {}

  /// Connects to the scheduler. If that fails, `why_not` says why, as far as it is known.
  bool connect(std::string& why_not);
  SessionEnd run();

 private:
  [[nodiscard]] Error lost_text() const;
  void read();
  void write();
  void write_all();
  bool write_unit(const FinishedUnit& unit);
  void beat(const std::stop_token& stop);
  void leave();
  Expected<void> work();
  [[nodiscard]] Expected<void> end_of_work() const;
  Expected<void> take_job(const wire::Job& job);
  void forget_job(JobId job);
  Expected<void> take_view(const wire::NumberedView& message);
  void render(const wire::Unit& unit);
  [[nodiscard]] bool is_outdated(const wire::UnitId& unit);
  void say(wire::WorkerMessage message) { outbox_.put(std::move(message)); }

  const WorkerClientOptions& options_;
  const std::string address_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<wire::Farm::Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<wire::WorkerMessage, wire::SchedulerMessage>> stream_;
  Mailbox<wire::SchedulerMessage> inbox_;
  Mailbox<std::variant<wire::WorkerMessage, FinishedUnit>> outbox_;
  std::atomic<bool> leaving_ = false;              // either side has announced the end
  std::atomic<bool> is_over_ = false;              // nothing that has arrived is started any more
  bool is_answered_ = false, comes_back_ = false;  // used by the reading thread only
  // Set by the writing, the reading and the working thread when they end.
  std::promise<void> all_said_, all_heard_, worked_;
  const std::shared_future<void> said_ = all_said_.get_future().share();
  grpc::Status status_;    // of the stream
  const bool may_return_;  // whether another connection may follow
  std::mutex views_mutex_;
  std::map<JobId, std::uint32_t>
      newest_views_;  // the newest that has arrived, even if it is not processed yet

  std::atomic<bool> beat_waits_ = false;  // one is in the outbox
  PartSize part_size_;                    // used by the writing thread only

  std::mutex jobs_mutex_;  // for changes: the beat thread reads it
  std::map<JobId, KnownJob> jobs_;
  std::uint64_t forgotten_parts_ = 0;  // parts done by devices of forgotten jobs
  bool was_ready_ = false;
  std::optional<Error> failure_;  // of the last job that could not be rendered here
};

/// Makes one attempt to connect; the channel reports its failure.
bool Session::connect(std::string& why_not) {
  // The channel must not retry by itself.
  channel_ = open_channel(address_, options_.keys.get(), {.first = kLongestPause, .most = kLongestPause});
  const auto deadline = std::chrono::system_clock::now() + kTimeToConnect;
  grpc_connectivity_state state = channel_->GetState(true);
  while (state != GRPC_CHANNEL_READY && state != GRPC_CHANNEL_TRANSIENT_FAILURE &&
         channel_->WaitForStateChange(state, deadline))
    state = channel_->GetState(true);
  if (state == GRPC_CHANNEL_READY) return true;
  why_not = why_unreachable(address_, options_.keys.get(), kTimeToExplain);
  return false;
}

SessionEnd Session::run() {
  stub_ = wire::Farm::NewStub(channel_);
  show_token(context_, options_.token);
  stream_ = stub_->Work(&context_);

  wire::WorkerMessage hello;
  hello.mutable_hello()->set_protocol_version(kProtocolVersion);
  hello.mutable_hello()->set_host(wire_text(host_name(), kLongestName));
  hello.mutable_hello()->set_pid(getpid());
  hello.mutable_hello()->set_key(own_key());
  for (const Isa isa : options_.isas) hello.mutable_hello()->add_isas(encode(isa));
  say(std::move(hello));

  std::thread reader([this] { read(); });
  std::thread writer([this] { write(); });
  std::jthread heart([this](const std::stop_token& stop) { beat(stop); });
  // In a scope: the destructor waits for a running leave().
  Expected<void> worked;
  {
    const std::stop_callback when_told(options_.leave, [this] { leave(); });
    worked = work();
  }
  worked_.set_value();
  heart.request_stop();
  heart.join();
  outbox_.close();
  writer.join();
  reader.join();
  if (!worked) return worked;
  if (leaving_ && !comes_back_) return worked;  // a worker that is dismissed during a unit is not waited for
  Lost lost{lost_text(), is_answered_};
  if (may_return_ && !is_final(status_.error_code())) return lost;
  if (const Expected<void> ended = end_of_work(); !ended) return ended;
  return Expected<void>(std::unexpected(lost.why));
}

Error Session::lost_text() const {
  if (comes_back_) return {fmt::format("the scheduler at {} was stopped", address_)};
  if (is_final(status_.error_code()))
    return {fmt::format("the scheduler at {} refuses this worker: {}", address_, status_text(status_))};
  // A broken connection has no further details.
  const bool is_broken = status_.ok() || status_.error_code() == grpc::StatusCode::UNAVAILABLE;
  return {fmt::format("the scheduler at {} broke the connection{}{}", address_, is_broken ? "" : ": ",
                      is_broken ? "" : status_text(status_))};
}

void Session::read() {
  wire::SchedulerMessage message;
  while (stream_->Read(&message)) {
    is_answered_ = true;
    if (message.has_dismiss() || message.has_refused()) leaving_ = true;
    comes_back_ |= message.has_dismiss() && message.dismiss().comes_back();
    if (message.has_view()) {
      const std::lock_guard lock(views_mutex_);
      newest_views_[message.view().job()] = message.view().number();
    }
    inbox_.put(std::move(message));
  }
  if (!leaving_) is_over_ = true;
  inbox_.close();
  all_heard_.set_value();
  // If the worker is leaving, the working thread may still write; a broken stream accepts nothing more.
  if (!leaving_) outbox_.close();
  said_.wait();
  status_ = stream_->Finish();
  if (leaving_ || !options_.on_connection_lost) return;
  if (may_return_ && !is_final(status_.error_code()) &&
      worked_.get_future().wait_for(kTimeToFinish) == std::future_status::ready)
    return;
  options_.on_connection_lost(lost_text());
}

void Session::write() {
  write_all();
  stream_->WritesDone();
  all_said_.set_value();
}

void Session::write_all() {
  while (auto item = outbox_.take()) {
    bool written = false;
    if (const auto* message = std::get_if<wire::WorkerMessage>(&*item)) {
      if (message->has_beat()) beat_waits_ = false;
      written = stream_->Write(*message);
    } else {
      written = write_unit(std::get<FinishedUnit>(*item));
    }
    if (!written) return;  // broken; the reading thread reports it
  }
}

/// A large result is sent in parts, each of which is a sign of life. Returns whether all were written.
bool Session::write_unit(const FinishedUnit& unit) {
  wire::WorkerMessage message;
  if (!unit.result) {
    *message.mutable_unit_failed()->mutable_id() = unit.id;
    message.mutable_unit_failed()->set_message(wire_text(unit.result.error().message, kLongestText));
    return stream_->Write(message);
  }
  ResultCutter cutter(unit.id, *unit.result);
  for (bool is_last = false; !is_last;) {
    is_last = cutter.next(part_size_.bytes(), message);
    if (is_last) {
      message.mutable_result()->set_busy_seconds(unit.busy_seconds);
      message.mutable_result()->set_peak_memory_bytes(peak_memory_bytes());
    }
    const auto begin = std::chrono::steady_clock::now();
    if (!stream_->Write(message)) return false;
    part_size_.wrote(message.ByteSizeLong(), seconds_since(begin));
  }
  return true;
}

/// Finished results are sent first. Then the stream ends, so that the scheduler's last messages are not
/// waited for.
void Session::leave() {
  leaving_ = is_over_ = true;
  wire::WorkerMessage message;
  message.mutable_leaving()->set_reason(wire_text(options_.leave_reason, kLongestText));
  say(std::move(message));
  outbox_.close();
  if (said_.wait_for(kTimeToLeave) == std::future_status::ready)
    all_heard_.get_future().wait_for(kTimeToLeave);
  inbox_.close();
}

/// In a thread of its own, since the working thread may be busy in its device for a long time. Only one beat
/// is in the outbox at a time, so that beats do not pile up if the connection is stuck.
void Session::beat(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  while (!never.wait_for(lock, stop, kBeatInterval, [&] { return stop.stop_requested(); })) {
    if (beat_waits_.exchange(true)) continue;
    wire::WorkerMessage message;
    message.mutable_beat();
    {
      const std::lock_guard jobs_lock(jobs_mutex_);
      std::uint64_t parts = forgotten_parts_;
      for (const auto& [id, job] : jobs_) parts += job.device->parts_done();
      message.mutable_beat()->set_parts(parts);
    }
    say(std::move(message));
  }
}

Expected<void> Session::work() {
  // After the end, messages that arrived before are ignored, except for the end itself.
  while (std::optional<wire::SchedulerMessage> message = inbox_.take()) {
    if (is_over_ && !message->has_refused() && !message->has_dismiss()) continue;
    switch (message->content_case()) {
      case wire::SchedulerMessage::kRefused:
        return fail("the scheduler refuses this worker: " + message->refused().reason());
      case wire::SchedulerMessage::kJob:
        if (const Expected<void> taken = take_job(message->job()); !taken) {
          wire::WorkerMessage failure;
          failure.mutable_job_failed()->set_job(message->job().id());
          failure.mutable_job_failed()->set_message(wire_text(taken.error().message, kLongestText));
          say(std::move(failure));
          failure_ = taken.error();
        }
        break;
      case wire::SchedulerMessage::kForget:
        forget_job(message->forget().job());
        break;
      case wire::SchedulerMessage::kUnit:
        if (!is_outdated(message->unit().id())) render(message->unit());
        break;
      case wire::SchedulerMessage::kView:
        if (const Expected<void> taken = take_view(message->view()); !taken) return taken;
        break;
      case wire::SchedulerMessage::kDismiss:
        return {};
      default:
        return fail("the scheduler sent a message of an unknown kind");
    }
  }
  return {};
}

/// A worker that could not render any job has failed.
Expected<void> Session::end_of_work() const {
  return failure_ && !was_ready_ ? Expected<void>(std::unexpected(*failure_)) : Expected<void>();
}

/// A unit of an older view is no longer needed.
bool Session::is_outdated(const wire::UnitId& unit) {
  const std::lock_guard lock(views_mutex_);
  const auto newest = newest_views_.find(unit.job());
  return newest != newest_views_.end() && unit.view() < newest->second;
}

void Session::forget_job(JobId job) {
  KnownJob forgotten;  // destroyed after the lock is released, so that beats need not wait
  const std::lock_guard lock(jobs_mutex_);
  const auto found = jobs_.find(job);
  if (found == jobs_.end()) return;
  forgotten_parts_ += found->second.device->parts_done();
  forgotten = std::move(found->second);
  jobs_.erase(found);
}

Expected<void> Session::take_job(const wire::Job& job) {
  forget_job(job.id());
  Expected<DeviceOptions> device_options = decode(job.device());
  if (!device_options) return std::unexpected(device_options.error());
  device_options->backend = options_.backend.value_or(device_options->backend);
  device_options->isa = options_.isa.value_or(device_options->isa);
  device_options->threads = options_.threads.value_or(device_options->threads);
  device_options->opencl_device = options_.opencl_device.value_or(device_options->opencl_device);

  device_options->on_compile = [this, id = job.id()](const std::string& name) {
    wire::WorkerMessage compiling;
    compiling.mutable_compiling()->set_job(id);
    compiling.mutable_compiling()->set_device(wire_text(name, kLongestName));
    say(std::move(compiling));
  };

  PieceCache cache(options_.cache, options_.cache_bytes);
  WorkerPieces pieces(cache);
  for (const auto& [id, other] : jobs_) pieces.offer(*other.scene, other.manifest);
  Expected<FetchedScene> fetched = SceneFetch(*stub_, options_.token, &pieces).fetch(job.scene());
  if (!fetched) return std::unexpected(fetched.error());
  KnownJob known{.scene = std::make_unique<DeviceScene>(std::move(fetched->scene)),
                 .manifest = std::move(fetched->manifest),
                 .device = {}};
  Expected<std::unique_ptr<Device>> device = fail("");
  try {
    device = options_.make_device(*known.scene, *device_options);
  } catch (const std::exception& exception) {
    device = fail(exception.what());  // for example, out of memory
  }
  if (!device) return std::unexpected(device.error());
  known.device = std::move(*device);

  wire::WorkerMessage ready;
  ready.mutable_ready()->set_job(job.id());
  ready.mutable_ready()->set_device(wire_text(known.device->description(), kLongestName));
  DevicePreparation preparation = known.device->preparation();
  for (std::string& note : cache.take_notes()) preparation.warnings.push_back(std::move(note));
  encode(preparation, *ready.mutable_ready());
  ready.mutable_ready()->mutable_scene()->set_fetched(fetched->bytes.fetched);
  ready.mutable_ready()->mutable_scene()->set_found(fetched->bytes.found);
  {
    const std::lock_guard lock(jobs_mutex_);
    jobs_[job.id()] = std::move(known);
  }
  was_ready_ = true;
  say(std::move(ready));
  return {};
}

Expected<void> Session::take_view(const wire::NumberedView& message) {
  const Expected<View> view = decode(message.view());
  if (!view) return fail("the scheduler sent " + view.error().message);
  const auto job = jobs_.find(message.job());
  if (job == jobs_.end()) return {};  // it could not be rendered here
  apply_view(*view, job->second.scene->header);
  return job->second.device->take_view();
}

void Session::render(const wire::Unit& message) {
  FinishedUnit finished{.id = message.id(), .result = fail(""), .busy_seconds = 0};
  const Expected<RenderUnit> unit = decode(message);
  const auto job = jobs_.find(message.id().job());
  if (!unit) {
    finished.result = std::unexpected(unit.error());
  } else if (job == jobs_.end()) {
    finished.result = fail("a unit came before its job");
  } else {
    const auto start = std::chrono::steady_clock::now();
    try {
      finished.result = job->second.device->render(*unit);
    } catch (const std::exception& exception) {
      finished.result = fail(exception.what());
    }
    finished.busy_seconds = seconds_since(start);
  }
  outbox_.put(std::move(finished));
}

/// Connects again and again until the worker's work is over.
class Attempts {
 public:
  explicit Attempts(const WorkerClientOptions& options)
      : options_(options),
        file_(address_file_of(options.address)),
        patience_(std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double>(std::clamp(options.retry_for, 0.0, kLongestRetry)))),
        reminder_(
            std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.reminder))),
        pauses_(is_here() ? kFirstPauseHere : kFirstPause, is_here() ? kLongestPauseHere : kLongestPause,
                std::random_device{}()) {}

  Expected<void> run() {
    for (;;) {
      SessionEnd end = attempt();
      if (const auto* over = std::get_if<Expected<void>>(&end)) return *over;
      const Lost& lost = std::get<Lost>(end);
      if (lost.was_answered) {
        last_seen_ = Clock::now();
        pauses_.reset();
      }
      const auto left = last_seen_ + patience_ - Clock::now();
      if (left <= Clock::duration::zero())
        return fail(options_.retry_for > 0
                        ? fmt::format("{} (waited {} s)", lost.why.message, options_.retry_for)
                        : lost.why.message);
      tell(lost.why.message, left);
      pause(std::min<Clock::duration>(pauses_.next(), left));
    }
  }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] bool is_here() const {
    return file_.empty() && (!is_tcp(options_.address) || is_loopback(split_address(options_.address).host));
  }

  SessionEnd attempt() {
    address_ = options_.address;
    if (!file_.empty()) {
      address_.clear();
      const auto read = read_address_file(file_);
      if (!read) return Lost{read.error()};
      if (!*read) {
        if (options_.on_waiting)
          options_.on_waiting(fmt::format("the render has ended, says {}", file_.string()));
        return Expected<void>();
      }
      address_ = **read;
      if (auto checked = check_encrypted(address_, options_.keys.get(), KeyRole::kWorker); !checked)
        return checked;
    }
    Session session(options_, address_, options_.reconnects && patience_ > Clock::duration::zero());
    std::string why_not;
    if (session.connect(why_not)) return session.run();
    return Lost{
        {fmt::format("no scheduler answers at {}{}{}", address_, why_not.empty() ? "" : ": ", why_not)}};
  }

  void tell(const std::string& why, Clock::duration left) {
    if (!options_.on_waiting || (why == told_ && Clock::now() < next_reminder_)) return;
    told_ = why;
    next_reminder_ = Clock::now() + reminder_;
    const auto seconds = std::chrono::ceil<std::chrono::seconds>(left).count();
    options_.on_waiting(std::isinf(options_.retry_for)
                            ? "waiting: " + why
                            : fmt::format("waiting for up to {} s (--retry-for): {}", seconds, why));
  }

  /// Ends early if the address file has changed.
  void pause(Clock::duration time) {
    const Clock::time_point end = Clock::now() + time;
    for (auto now = Clock::now(); now < end; now = Clock::now()) {
      if (!file_.empty())
        if (const auto read = read_address_file(file_); read && *read != address_) return pauses_.reset();
      std::this_thread::sleep_for(file_.empty() ? end - now
                                                : std::min<Clock::duration>(end - now, kAddressFileInterval));
    }
  }

  const WorkerClientOptions& options_;
  const std::filesystem::path file_;
  const Clock::duration patience_, reminder_;
  BackOff pauses_;
  Clock::time_point last_seen_ = Clock::now(), next_reminder_{};
  std::string address_;  ///< of the last attempt; empty: the file had none
  std::string told_;
};

}  // namespace

Expected<void> run_worker(const WorkerClientOptions& options) { return Attempts(options).run(); }

}  // namespace penumbra
