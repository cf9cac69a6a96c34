#include "tests/scheduler/faults/rogue_worker.h"

#include <limits>
#include <utility>

#include "tests/support/fake_samples.h"
#include "worker/protocol/client.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds kTimeToConnect = 20s, kBeatInterval = 500ms, kStep = 10ms;
constexpr int kSlowness = 20;

}  // namespace

const char* text_of(Roguery roguery) {
  constexpr const char* kTexts[] = {
      "none",  "slow", "flipped bit", "wrong checksum", "wrong unit", "NaN",           "too short",
      "twice", "lies", "fails",       "falls silent",   "leaves",     "talks nonsense"};
  static_assert(std::size(kTexts) == std::size_t(Roguery::kCount));
  return kTexts[int(roguery)];
}

RogueWorker::RogueWorker(std::string address, RogueHabit habit, const FilmLayers& layers)
    : address_(std::move(address)), habit_(habit), layers_(layers), thread_([this] { run(); }) {}

RogueWorker::~RogueWorker() {
  over_ = true;
  context_.TryCancel();
  thread_.join();
}

void RogueWorker::run() {
  const std::shared_ptr<grpc::Channel> channel = open_channel(address_);
  const auto deadline = std::chrono::steady_clock::now() + kTimeToConnect;
  while (!channel->WaitForConnected(std::chrono::system_clock::now() + 50ms))
    if (over_ || std::chrono::steady_clock::now() > deadline) return;
  const auto stub = wire::Farm::NewStub(channel);
  stream_ = stub->Work(&context_);
  wire::WorkerMessage hello;
  hello.mutable_hello()->set_protocol_version(kProtocolVersion);
  hello.mutable_hello()->set_host("rogue");
  hello.mutable_hello()->add_isas(wire::ISA_SSE2);
  hello.mutable_hello()->add_isas(wire::ISA_AVX2);
  hello.mutable_hello()->add_isas(wire::ISA_AVX512);
  bool goes_on = say(hello);
  std::thread heart([this] { beat(); });
  wire::SchedulerMessage message;
  while (goes_on && !over_ && stream_->Read(&message)) {
    if (message.has_dismiss() || message.has_refused()) break;
    if (message.has_job()) {
      wire::WorkerMessage ready;
      ready.mutable_ready()->set_job(message.job().id());
      ready.mutable_ready()->set_device("rogue");
      goes_on = say(ready);
    }
    if (message.has_unit()) goes_on = answer(message.unit());
  }
  over_ = true;
  context_.TryCancel();
  heart.join();
  stream_->Finish();
}

void RogueWorker::beat() {
  wire::WorkerMessage message;
  message.mutable_beat();
  auto next = std::chrono::steady_clock::now();
  for (std::uint64_t parts = 0; !over_; std::this_thread::sleep_for(kStep)) {
    if (silent_ || std::chrono::steady_clock::now() < next) continue;
    message.mutable_beat()->set_parts(++parts);
    say(message);
    next += kBeatInterval;
  }
}

bool RogueWorker::say(const wire::WorkerMessage& message) {
  const std::lock_guard lock(mutex_);
  return stream_->Write(message);
}

bool RogueWorker::answer(const wire::Unit& unit) {
  const int slowness = habit_.roguery == Roguery::kSlow ? kSlowness : 1;
  for (auto left = habit_.delay * slowness; left.count() > 0 && !over_; left -= kStep)
    std::this_thread::sleep_for(std::min<std::chrono::milliseconds>(left, kStep));
  if (silent_) return true;
  wire::WorkerMessage message;
  *message.mutable_result()->mutable_id() = unit.id();
  encode(fake_samples(decode(unit).value(), layers_), *message.mutable_result());
  const bool goes_on_lying = habit_.roguery == Roguery::kLies && units_ >= habit_.at;
  if (++units_ == habit_.at || failures_left_ > 0 || goes_on_lying) return do_it(message, unit);
  return say(message);
}

/// What it is there for; whether it goes on.
bool RogueWorker::do_it(wire::WorkerMessage& message, const wire::Unit& unit) {
  done_it_ = true;
  wire::PixelResult& pixels = *message.mutable_result()->mutable_pixels();
  SampleBuffer buffer = fake_samples(decode(unit).value(), layers_);
  switch (habit_.roguery) {
    case Roguery::kFlippedBit:
      (*pixels.mutable_values())[pixels.values().size() / 3] ^= 1;
      return say(message);
    case Roguery::kWrongChecksum:
      pixels.set_checksum(pixels.checksum() + 1);
      return say(message);
    case Roguery::kWrongUnit:
      message.mutable_result()->mutable_id()->set_tile(unit.id().tile() + 1000);
      return say(message);
    case Roguery::kNaN:
      buffer.values[buffer.values.size() / 2] = std::numeric_limits<float>::quiet_NaN();
      encode(buffer, *message.mutable_result());
      return say(message);
    case Roguery::kShort:
      buffer.values.pop_back();
      encode(buffer, *message.mutable_result());
      return say(message);
    case Roguery::kTwice:
      return say(message) && say(message);
    case Roguery::kLies:
      buffer.values[unit.id().tile() % buffer.pixels()] += 0.25f;
      encode(buffer, *message.mutable_result());
      return say(message);
    case Roguery::kFails:
      if (units_ == habit_.at) failures_left_ = 3;
      --failures_left_;
      message.mutable_unit_failed()->set_message("the rogue was told to fail");
      *message.mutable_unit_failed()->mutable_id() = unit.id();
      return say(message);
    case Roguery::kFalls:
      silent_ = true;
      return true;
    case Roguery::kLeaves:
      return false;
    case Roguery::kTalksNonsense:
      return say(wire::WorkerMessage());
    case Roguery::kNone:
    case Roguery::kSlow:
    case Roguery::kCount:
      break;
  }
  return say(message);
}

}  // namespace penumbra
