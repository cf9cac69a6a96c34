#include "scheduler/farm/work_stream.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "worker/protocol/text.h"

namespace penumbra {
namespace {

constexpr std::chrono::milliseconds kTimeToLeave{5000};  // time limit after the final message
constexpr std::chrono::milliseconds kTimeToTake{300};    // time limit for the last message to be sent
constexpr std::chrono::milliseconds kRoomInterval{100};  // how often room for a large result is looked for
constexpr std::size_t kLongestKey = 64;

/// The instruction sets of a worker. Unknown ones are left out.
std::vector<Isa> isas_of(const wire::Hello& hello) {
  std::vector<Isa> isas;
  for (const Isa isa : kIsas)
    if (std::ranges::find(hello.isas(), int(encode(isa))) != hello.isas().end()) isas.push_back(isa);
  return isas;
}

}  // namespace

// Defined here, so that gRPC's code that calls a stream back is compiled in this file.
FarmService::FarmService(Farm& farm, std::function<void(const std::string& peer)> on_call)
    : farm_(farm), on_call_(std::move(on_call)) {}

grpc::ServerBidiReactor<wire::WorkerMessage, wire::SchedulerMessage>* FarmService::Work(
    grpc::CallbackServerContext* context) {
  if (on_call_) on_call_(context->peer());
  return new WorkStream(farm_, *context);  // deletes itself
}

WorkStream::WorkStream(Farm& farm, grpc::CallbackServerContext& context) : farm_(farm), context_(context) {
  StartRead(&incoming_);
}

void WorkStream::OnReadDone(bool ok) {
  if (!ok) return end(grpc::Status::OK);
  if (!connection_) return take_hello();
  take_message();
}

void WorkStream::take_message() {
  auto understood = connection_->understand(incoming_);
  if (!understood) return end({grpc::StatusCode::INVALID_ARGUMENT, understood.error().message});
  if (std::holds_alternative<WorkerConnection::NoRoom>(*understood)) return wait_for_room();
  incoming_.Clear();
  if (auto* arrival = std::get_if<Arrival>(&*understood)) farm_.put(std::move(*arrival));
  StartRead(&incoming_);
}

/// The worker cannot be heard meanwhile, through no fault of its own.
void WorkStream::wait_for_room() {
  farm_.put(connection_->vouch());
  waiting_ = std::make_unique<grpc::Alarm>();
  waiting_->Set(std::chrono::system_clock::now() + kRoomInterval, [this](bool) {
    if (context_.IsCancelled()) return end(grpc::Status::CANCELLED);
    take_message();
  });
}

void WorkStream::take_hello() {
  if (!incoming_.has_hello())
    return end({grpc::StatusCode::INVALID_ARGUMENT, "the first message of a worker must be Hello"});
  const wire::Hello hello = incoming_.hello();
  if (const std::string mismatch = version_mismatch(hello.protocol_version(), "worker"); !mismatch.empty()) {
    refusal_.mutable_refused()->set_reason(mismatch);
    StartWriteAndFinish(&refusal_, grpc::WriteOptions(), {grpc::StatusCode::FAILED_PRECONDITION, mismatch});
    return;
  }
  std::tie(worker_, connection_) = farm_.open();
  farm_.mailbox.put(arrivals::Connected{.worker = worker_,
                                        .host = wire_text(hello.host(), kLongestName),
                                        .pid = hello.pid(),
                                        .key = wire_text(hello.key(), kLongestKey),
                                        .peer = context_.peer(),
                                        .isas = isas_of(hello)});
  connection_->attach(*this);
  StartRead(&incoming_);
}

void WorkStream::OnWriteDone(bool ok) {
  if (connection_->written(ok)) Finish(status_);
}

/// A worker that stays after its final message is cut off.
void WorkStream::is_final() {
  leaving_ = std::make_unique<grpc::Alarm>();
  cut_off_in(kTimeToLeave, *leaving_);
}

void WorkStream::end(const grpc::Status& status) {
  status_ = status;
  if (!connection_ || connection_->close()) {
    Finish(status_);
    return;
  }
  // The worker cannot be told the reason if it does not read earlier messages.
  ending_ = std::make_unique<grpc::Alarm>();
  cut_off_in(kTimeToTake, *ending_);
}

/// The alarm is a member of this stream, so it may fire while the stream is being destroyed.
void WorkStream::cut_off_in(std::chrono::milliseconds time, grpc::Alarm& alarm) {
  alarm.Set(std::chrono::system_clock::now() + time, [connection = connection_](bool is_time) {
    if (is_time) connection->cut_off();
  });
}

void WorkStream::OnDone() {
  if (connection_) {
    connection_->detach();
    farm_.mailbox.put(arrivals::Gone{worker_});
    connection_.reset();
    farm_.close(worker_);  // from here on the farm may be destroyed
  }
  delete this;
}

}  // namespace penumbra
