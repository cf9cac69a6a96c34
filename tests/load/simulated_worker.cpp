#include "tests/load/simulated_worker.h"

#include <fmt/format.h>
#include <grpcpp/create_channel.h>

#include <utility>

#include "kernels/host/process.h"
#include "tests/load/load_samples.h"

namespace penumbra {

SimulatedWorker::SimulatedWorker(Crew& crew, const std::string& address, const std::string& key, int number)
    : crew_(crew) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // a connection of its own
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetInt(GRPC_ARG_SERVICE_CONFIG_DISABLE_RESOLUTION, 1);
  channel_ = grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
  stub_ = wire::Farm::NewStub(channel_);
  context_.set_wait_for_ready(true);
  wire::WorkerMessage hello;
  hello.mutable_hello()->set_protocol_version(kProtocolVersion);
  hello.mutable_hello()->set_host("load");
  hello.mutable_hello()->set_pid(number);
  hello.mutable_hello()->set_key(key);
  for (const Isa isa : {Isa::kSse2, Isa::kAvx2, Isa::kAvx512}) hello.mutable_hello()->add_isas(encode(isa));
  outgoing_.push_back(std::move(hello));
}

void SimulatedWorker::start() {
  stub_->async()->Work(&context_, this);
  StartRead(&incoming_);
  StartWrite(&outgoing_.front());
  StartCall();
}

void SimulatedWorker::say(wire::WorkerMessage message) {
  if (over_) return;
  outgoing_.push_back(std::move(message));
  if (outgoing_.size() == 1) StartWrite(&outgoing_.front());
}

void SimulatedWorker::OnWriteDone(bool ok) {
  const std::lock_guard lock(mutex_);
  if (outgoing_.front().has_hello()) ++crew_.board.connected;
  outgoing_.pop_front();
  if (!ok) over_ = true;
  if (!over_ && !outgoing_.empty()) StartWrite(&outgoing_.front());
}

void SimulatedWorker::OnReadDone(bool ok) {
  if (!ok) return;
  if (incoming_.has_unit()) {
    take(incoming_.unit());
  } else if (incoming_.has_job()) {
    wire::WorkerMessage ready;
    ready.mutable_ready()->set_job(incoming_.job().id());
    ready.mutable_ready()->set_device("simulated");
    const std::lock_guard lock(mutex_);
    say(std::move(ready));
  } else if (incoming_.has_dismiss() || incoming_.has_refused()) {
    context_.TryCancel();
  }
  StartRead(&incoming_);
}

void SimulatedWorker::take(const wire::Unit& unit) {
  const UnitId id = decode(unit.id());
  crew_.ordered(id);
  const bool is_new = ++crew_.board.ordered <= crew_.board.units;
  const std::lock_guard lock(mutex_);
  if (!answered_.empty()) {
    if (is_new) crew_.board.orders.add(seconds_since(answered_.front()));
    answered_.pop_front();
  }
  held_.push_back({id, unit.id().view(), decode(unit).value()});
  if (held_.size() == 1) begin_unit();
}

void SimulatedWorker::begin_unit() {
  const std::chrono::duration<double> takes(load_seconds(held_.front().unit, crew_.board.unit_seconds));
  crew_.finish_at(*this, Clock::now() + std::chrono::duration_cast<Clock::duration>(takes));
}

void SimulatedWorker::finish_unit() {
  const std::lock_guard lock(mutex_);
  if (over_ || held_.empty()) return;
  const Held done = held_.front();
  held_.pop_front();
  ++parts_;
  wire::UnitId id;
  encode(done.id, done.view, id);
  const SampleBuffer samples = load_samples(done.unit, crew_.board.planes);
  ResultCutter cutter(id, samples);
  answered_.push_back(Clock::now());
  for (bool is_last = false; !is_last;) {
    wire::WorkerMessage message;
    is_last = cutter.next(kMostPartBytes, message);
    if (is_last) message.mutable_result()->set_busy_seconds(crew_.board.unit_seconds);
    say(std::move(message));
  }
  if (!held_.empty()) begin_unit();
}

void SimulatedWorker::beat() {
  wire::WorkerMessage message;
  const std::lock_guard lock(mutex_);
  message.mutable_beat()->set_parts(parts_);
  if (outgoing_.empty()) say(std::move(message));
}

std::deque<UnitId> SimulatedWorker::die() {
  std::deque<UnitId> units;
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
    for (const Held& held : held_) units.push_back(held.id);
    held_.clear();
  }
  context_.TryCancel();
  return units;
}

void SimulatedWorker::OnDone(const grpc::Status&) {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  crew_.over();
}

}  // namespace penumbra
