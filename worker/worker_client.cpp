#include "worker/worker_client.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <mutex>
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

namespace penumbra {
namespace {

constexpr std::chrono::seconds kBeatInterval{1};

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
  UnitId id;
  std::uint32_t job = 0;
  Expected<SampleBuffer> result;
  double busy_seconds = 0;
};

/// One connection to a scheduler, from Hello to the end of the stream.
class Session {
 public:
  explicit Session(const WorkerClientOptions& options) : options_(options) {}

  Expected<void> run();

 private:
  void read();
  void write();
  void beat(const std::stop_token& stop);
  Expected<void> work();
  Expected<void> take_job(const wire::Job& job);
  Expected<void> take_view(const wire::NumberedView& message);
  void render(const wire::Unit& unit);
  void put_device(std::unique_ptr<Device> device) {
    const std::lock_guard lock(device_mutex_);
    device_ = std::move(device);
  }
  void say(wire::WorkerMessage message) { outbox_.put(std::move(message)); }

  const WorkerClientOptions& options_;
  std::unique_ptr<wire::Farm::Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<wire::WorkerMessage, wire::SchedulerMessage>> stream_;
  Mailbox<wire::SchedulerMessage> inbox_;
  Mailbox<std::variant<wire::WorkerMessage, FinishedUnit>> outbox_;
  bool leaving_ = false;  // of the reading thread: the scheduler has said that it is over
  std::atomic<std::uint32_t> newest_view_ = 0;  // that has come, if not yet its turn

  std::atomic<bool> beat_waits_ = false;  // in the outbox

  DeviceScene scene_;
  std::mutex device_mutex_;         // while the pointer changes: beats come from another thread
  std::unique_ptr<Device> device_;  // after the scene that it renders
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
  Expected<void> worked = work();
  heart.request_stop();
  heart.join();
  outbox_.close();
  writer.join();
  stream_->WritesDone();
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
    leaving_ |= message.has_dismiss() || message.has_refused();
    if (message.has_view()) newest_view_ = message.view().number();
    inbox_.put(std::move(message));
  }
  inbox_.close();
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
  while (auto item = outbox_.take()) {
    wire::WorkerMessage message;
    if (auto* ready_made = std::get_if<wire::WorkerMessage>(&*item)) {
      message = std::move(*ready_made);
      if (message.has_beat()) beat_waits_ = false;
    } else {
      const FinishedUnit& unit = std::get<FinishedUnit>(*item);
      if (unit.result) {
        wire::UnitResult& result = *message.mutable_result();
        result.set_job(unit.job);
        encode(unit.id, *result.mutable_id());
        encode(*unit.result, result);
        result.set_busy_seconds(unit.busy_seconds);
        result.set_peak_memory_bytes(peak_memory_bytes());
      } else {
        message.mutable_unit_failed()->set_job(unit.job);
        encode(unit.id, *message.mutable_unit_failed()->mutable_id());
        message.mutable_unit_failed()->set_message(wire_text(unit.result.error().message, kLongestText));
      }
    }
    if (!stream_->Write(message)) return;  // broken; the reader says so
  }
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
      const std::lock_guard device_lock(device_mutex_);
      if (device_ != nullptr) message.mutable_beat()->set_parts(device_->parts_done());
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
          return taken;
        }
        break;
      case wire::SchedulerMessage::kUnit:
        // A unit of an older view is no longer needed.
        if (message->unit().id().image() >= newest_view_) render(message->unit());
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

Expected<void> Session::take_job(const wire::Job& job) {
  put_device(nullptr);
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

  grpc::ClientContext context;
  show_token(context, options_.token);
  Expected<DeviceScene> scene = fetch_scene(*stub_, context, job.scene());
  if (!scene) return std::unexpected(scene.error());
  scene_ = std::move(*scene);
  Expected<std::unique_ptr<Device>> device = options_.make_device(scene_, *device_options);
  if (!device) return std::unexpected(device.error());
  put_device(std::move(*device));

  wire::WorkerMessage ready;
  ready.mutable_ready()->set_job(job.id());
  ready.mutable_ready()->set_device(wire_text(device_->description(), kLongestName));
  encode(device_->preparation(), *ready.mutable_ready());
  say(std::move(ready));
  return {};
}

Expected<void> Session::take_view(const wire::NumberedView& message) {
  const Expected<View> view = decode(message.view());
  if (!view) return fail("the scheduler sent " + view.error().message);
  apply_view(*view, scene_.header);
  return device_ == nullptr ? Expected<void>{} : device_->take_view();
}

void Session::render(const wire::Unit& message) {
  FinishedUnit finished{
      .id = decode(message.id()), .job = message.job(), .result = fail(""), .busy_seconds = 0};
  const Expected<RenderUnit> unit = decode(message);
  if (!unit) {
    finished.result = std::unexpected(unit.error());
  } else if (device_ == nullptr) {
    finished.result = fail("a unit came before its job");
  } else {
    const auto start = std::chrono::steady_clock::now();
    try {
      finished.result = device_->render(*unit);
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
