#include "worker/worker_client.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <future>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>
#include <variant>

#include "kernels/host/peak_memory.h"
#include "kernels/host/stopwatch.h"
#include "scheduler/protocol/client.h"
#include "scheduler/protocol/mailbox.h"
#include "scheduler/protocol/text.h"
#include "scheduler/protocol/token.h"
#include "scheduler/protocol/wire.h"
#include "worker/worker_pieces.h"

namespace penumbra {
namespace {

constexpr std::chrono::seconds kBeatInterval{1};
constexpr std::chrono::milliseconds kTimeToLeave{500};  // for each of: to say so, to be heard

std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
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

/// A job that the scheduler has given, and not yet told to forget.
struct KnownJob {
  std::unique_ptr<DeviceScene> scene;
  AssetManifest manifest;
  std::unique_ptr<Device> device;  // after the scene that it renders
};

/// One connection to a scheduler, from Hello to the end of the stream.
class Session {
 public:
  explicit Session(const WorkerClientOptions& options) : options_(options) {}

  Expected<void> run();

 private:
  void read();
  void write();
  void write_all();
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
  std::unique_ptr<wire::Farm::Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<wire::WorkerMessage, wire::SchedulerMessage>> stream_;
  Mailbox<wire::SchedulerMessage> inbox_;
  Mailbox<std::variant<wire::WorkerMessage, FinishedUnit>> outbox_;
  std::atomic<bool> leaving_ = false;  // either side has said that it is over
  // Set by the writing and the reading thread at their ends.
  std::promise<void> all_said_, all_heard_;
  std::mutex views_mutex_;
  std::map<JobId, std::uint32_t> newest_views_;  // that have come, if not yet their turn

  std::atomic<bool> beat_waits_ = false;  // in the outbox

  std::mutex jobs_mutex_;  // while it changes: beats come from another thread
  std::map<JobId, KnownJob> jobs_;
  std::uint64_t forgotten_parts_ = 0;  // that devices of forgotten jobs have done
  bool was_ready_ = false;
  std::optional<Error> failure_;  // of the last job that could not be done here
};

Expected<void> Session::run() {
  const std::shared_ptr<grpc::Channel> channel = open_channel(options_.address);
  const auto timeout = std::chrono::duration_cast<std::chrono::system_clock::duration>(
      std::chrono::duration<double>(options_.connect_timeout));
  if (!channel->WaitForConnected(std::chrono::system_clock::now() + timeout)) {
    return fail(
        fmt::format("no scheduler answers at {} (waited {} s)", options_.address, options_.connect_timeout));
  }
  stub_ = wire::Farm::NewStub(channel);
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
  // In a scope, for it waits for a leave() that is under way.
  Expected<void> worked;
  {
    const std::stop_callback when_told(options_.leave, [this] { leave(); });
    worked = work();
  }
  heart.request_stop();
  heart.join();
  outbox_.close();
  writer.join();
  reader.join();
  const grpc::Status status = stream_->Finish();
  // A worker that is dismissed in the middle of a unit is not waited for.
  if (worked && !status.ok() && !leaving_)
    worked = fail("the scheduler broke the connection: " + status.error_message());
  return worked;
}

void Session::read() {
  wire::SchedulerMessage message;
  bool is_answered = false;
  while (stream_->Read(&message)) {
    is_answered = true;
    if (message.has_dismiss() || message.has_refused()) leaving_ = true;
    if (message.has_view()) {
      const std::lock_guard lock(views_mutex_);
      newest_views_[message.view().job()] = message.view().number();
    }
    inbox_.put(std::move(message));
  }
  inbox_.close();
  all_heard_.set_value();
  if (!leaving_ && options_.on_connection_lost) {
    options_.on_connection_lost(Error{
        is_answered
            ? "the connection to the scheduler broke"
            : fmt::format("the scheduler at {} ended the connection at once; it takes workers with the token "
                          "that it printed for them (--token or PENUMBRA_TOKEN)",
                          options_.address)});
  }
}

void Session::write() {
  write_all();
  stream_->WritesDone();
  all_said_.set_value();
}

void Session::write_all() {
  while (auto item = outbox_.take()) {
    wire::WorkerMessage message;
    if (auto* ready_made = std::get_if<wire::WorkerMessage>(&*item)) {
      message = std::move(*ready_made);
      if (message.has_beat()) beat_waits_ = false;
    } else {
      const FinishedUnit& unit = std::get<FinishedUnit>(*item);
      if (unit.result) {
        wire::UnitResult& result = *message.mutable_result();
        *result.mutable_id() = unit.id;
        encode(*unit.result, result);
        result.set_busy_seconds(unit.busy_seconds);
        result.set_peak_memory_bytes(peak_memory_bytes());
      } else {
        *message.mutable_unit_failed()->mutable_id() = unit.id;
        message.mutable_unit_failed()->set_message(wire_text(unit.result.error().message, kLongestText));
      }
    }
    if (!stream_->Write(message)) return;  // broken; the reader says so
  }
}

/// Results that are finished go first. Then the stream ends, so that what the scheduler has sent since is not
/// waited for.
void Session::leave() {
  leaving_ = true;
  wire::WorkerMessage message;
  message.mutable_leaving()->set_reason(wire_text(options_.leave_reason, kLongestText));
  say(std::move(message));
  outbox_.close();
  if (all_said_.get_future().wait_for(kTimeToLeave) == std::future_status::ready)
    all_heard_.get_future().wait_for(kTimeToLeave);
  inbox_.close();
}

/// A thread of its own, since the working one is in its device for as long as that takes. One beat at a time
/// is on its way, so a connection that is stuck does not collect them.
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
  while (std::optional<wire::SchedulerMessage> message = inbox_.take()) {
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
        return end_of_work();
      default:
        return fail("the scheduler sent a message of an unknown kind");
    }
  }
  return end_of_work();
}

/// A worker that could do nothing has failed.
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
  KnownJob forgotten;  // goes when beats need not wait for it
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
    device = fail(exception.what());  // no memory, say
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
  if (job == jobs_.end()) return {};  // it could not be done here
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

}  // namespace

Expected<void> run_worker(const WorkerClientOptions& options) { return Session(options).run(); }

}  // namespace penumbra
