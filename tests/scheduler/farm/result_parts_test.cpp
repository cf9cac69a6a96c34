// Results in parts, on their way from a worker to the farm.
#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>

#include <memory>
#include <utility>

#include "penumbra.grpc.pb.h"
#include "scheduler/farm/farm_service.h"
#include "scheduler/farm/private_socket.h"
#include "scheduler/farm/server.h"
#include "tests/support/fake_samples.h"
#include "worker/protocol/unit_result.h"

namespace penumbra::result_parts_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr JobId kJob = 5;
constexpr UnitId kUnit{.job = kJob, .phase = 0, .pass = 2, .tile = 3};
constexpr UnitId kNext{.job = kJob, .phase = 0, .pass = 2, .tile = 4};
constexpr RenderUnit kArea{.x = 16, .y = 32, .width = 64, .height = 64, .first_sample = 8, .sample_count = 3};
constexpr std::size_t kBytes = 64 * 64 * kRadiancePlanes * sizeof(float), kPart = kBytes / 4;

/// The messages of the result, five of them.
std::vector<wire::WorkerMessage> parts_of(const UnitId& unit, std::uint32_t view = 0) {
  const SampleBuffer buffer = fake_samples(kArea, kNoLayers);
  wire::UnitId id;
  encode(unit, view, id);
  ResultCutter cutter(id, buffer);
  std::vector<wire::WorkerMessage> messages;
  do messages.emplace_back();
  while (!cutter.next(kPart, messages.back()));
  return messages;
}

class Worker {
 public:
  explicit Worker(const std::string& address)
      : stub_(wire::Farm::NewStub(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()))),
        stream_(stub_->Work(&context_)) {
    wire::WorkerMessage hello;
    hello.mutable_hello()->set_protocol_version(kProtocolVersion);
    say(hello);
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker() { break_off(); }

  void say(const wire::WorkerMessage& message) { stream_->Write(message); }
  void break_off() {
    if (std::exchange(over_, true)) return;
    context_.TryCancel();
    stream_->Finish();
  }

 private:
  std::unique_ptr<wire::Farm::Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<wire::WorkerMessage, wire::SchedulerMessage>> stream_;
  bool over_ = false;
};

class ResultPartsTest : public testing::Test {
 protected:
  std::unique_ptr<Worker> connect() {
    auto worker = std::make_unique<Worker>(socket_.address());
    const WorkerId id = next<arrivals::Connected>().worker;
    for (const UnitId& unit : {kUnit, kNext}) server_->send_unit(id, unit, kArea, kNoLayers);
    last_ = id;
    return worker;
  }

  /// The next event beside beats, of which it keeps the last.
  template <typename T>
  T next() {
    std::optional<Arrival> arrival = server_->next(30s);
    for (; arrival && std::holds_alternative<arrivals::Beat>(*arrival); arrival = server_->next(30s))
      beat_ = std::get<arrivals::Beat>(*arrival);
    EXPECT_TRUE(arrival && std::holds_alternative<T>(*arrival));
    return arrival && std::holds_alternative<T>(*arrival) ? std::get<T>(std::move(*arrival)) : T{};
  }
  /// Waits for a beat with at least so many parts.
  void expect_beat(std::uint64_t parts) {
    while (beat_.parts < parts) {
      const std::optional<Arrival> arrival = server_->next(30s);
      ASSERT_TRUE(arrival && std::holds_alternative<arrivals::Beat>(*arrival));
      beat_ = std::get<arrivals::Beat>(*arrival);
    }
  }

  PrivateSocket socket_ = PrivateSocket::create().value();
  // For one result and a half.
  std::unique_ptr<Server> server_ =
      Server::listen({.address = socket_.address(), .room_for_results = kBytes * 3 / 2}).value();
  WorkerId last_ = 0;
  arrivals::Beat beat_{};
};

TEST_F(ResultPartsTest, AreSignsOfProgressAndArriveAsTheResult) {
  const auto worker = connect();
  auto parts = parts_of(kUnit);
  ASSERT_EQ(parts.size(), 4u);
  wire::WorkerMessage beat;
  beat.mutable_beat()->set_parts(100);
  worker->say(parts[0]);
  worker->say(beat);
  expect_beat(101);
  EXPECT_EQ(beat_.parts, 101u);
  worker->say(parts[1]);
  expect_beat(102);
  parts[3].mutable_result()->set_busy_seconds(1.5);
  worker->say(parts[2]);
  worker->say(parts[3]);
  const auto result = next<arrivals::Result>();
  EXPECT_EQ(result.worker, last_);
  EXPECT_EQ(result.unit, kUnit);
  EXPECT_EQ(result.buffer.values, fake_samples(kArea, kNoLayers).values);
  EXPECT_EQ(result.hash, result_hash(fake_samples(kArea, kNoLayers)));
  EXPECT_EQ(result.busy_seconds, 1.5);
}

TEST_F(ResultPartsTest, OfTwoResultsAtATimeAreRefused) {
  const auto worker = connect();
  worker->say(parts_of(kUnit)[0]);
  worker->say(parts_of(kNext)[0]);
  auto bad = next<arrivals::BadResult>();
  EXPECT_EQ(bad.unit, kNext);
  EXPECT_THAT(bad.why, HasSubstr("between the parts of another result"));
  worker->say(parts_of(kUnit)[0]);
  worker->say(parts_of(kNext).back());
  EXPECT_THAT(next<arrivals::BadResult>().why, HasSubstr("between the parts"));
}

TEST_F(ResultPartsTest, ThatAreTooManyOrMissingOrNotAskedForAreRefused) {
  const auto worker = connect();
  const auto parts = parts_of(kUnit);
  for (const std::size_t part : {0, 0, 1, 1, 2}) worker->say(parts[part]);
  EXPECT_THAT(next<arrivals::BadResult>().why, HasSubstr("122880 bytes of samples instead of 98304"));
  worker->say(parts[1]);
  EXPECT_THAT(next<arrivals::BadResult>().why, HasSubstr("was not asked"));
  worker->say(parts_of(kNext)[0]);
  worker->say(parts_of(kNext)[3]);
  EXPECT_THAT(next<arrivals::BadResult>().why, HasSubstr("49152 bytes of samples instead of 98304"));
}

TEST_F(ResultPartsTest, OfAFailedUnitAndOfAnOlderViewAreForgotten) {
  const auto worker = connect();
  worker->say(parts_of(kUnit)[0]);
  wire::WorkerMessage failed;
  encode(kUnit, 0, *failed.mutable_unit_failed()->mutable_id());
  worker->say(failed);
  EXPECT_EQ(next<arrivals::UnitFailed>().unit, kUnit);
  worker->say(parts_of(kNext)[0]);
  expect_beat(2);
  server_->send_view(last_, kJob, {1, {}});
  server_->send_unit(last_, kUnit, kArea, kNoLayers);
  worker->say(parts_of(kNext)[1]);
  for (const auto& part : parts_of(kUnit, 1)) worker->say(part);
  EXPECT_EQ(next<arrivals::Result>().unit, kUnit);
}

TEST_F(ResultPartsTest, WaitForRoomAndTheirWorkerCountsAsAlive) {
  const auto first = connect();
  const WorkerId of_first = last_;
  const auto second = connect();
  first->say(parts_of(kUnit)[0]);
  expect_beat(1);
  for (const auto& part : parts_of(kUnit)) second->say(part);
  // Beats grow without end while it waits.
  for (beat_ = {}; beat_.parts < 7 || beat_.worker != last_;) {
    const std::optional<Arrival> arrival = server_->next(30s);
    ASSERT_TRUE(arrival && std::holds_alternative<arrivals::Beat>(*arrival)) << "there is no room yet";
    beat_ = std::get<arrivals::Beat>(*arrival);
  }
  for (std::size_t part = 1; part < 4; ++part) first->say(parts_of(kUnit)[part]);
  {
    const auto result = next<arrivals::Result>();
    EXPECT_EQ(result.worker, of_first);
    for (int beats = 0; beats < 3; ++beats)
      EXPECT_TRUE(std::holds_alternative<arrivals::Beat>(server_->next(30s).value()))
          << "the memory is still in use";
  }
  EXPECT_EQ(next<arrivals::Result>().worker, last_);
}

TEST_F(ResultPartsTest, OfALostWorkerLeaveTheirRoomToOthers) {
  const auto first = connect();
  first->say(parts_of(kUnit)[0]);
  expect_beat(1);
  const auto second = connect(), third = connect();
  for (const auto& part : parts_of(kUnit)) second->say(part);
  first->break_off();
  next<arrivals::Gone>();
  EXPECT_EQ(next<arrivals::Result>().unit, kUnit);
}

TEST_F(ResultPartsTest, AWorkerThatIsLostWhileItWaitsIsGone) {
  const auto first = connect();
  first->say(parts_of(kUnit)[0]);
  expect_beat(1);
  const auto second = connect();
  second->say(parts_of(kUnit)[0]);
  beat_ = {};
  expect_beat(1);
  second->break_off();
  EXPECT_EQ(next<arrivals::Gone>().worker, last_);
}

TEST(ResultRoom, HoldsWhatFitsOrOneResultThatDoesNot) {
  ResultRoom room(100);
  auto large = room.take(1000);
  ASSERT_TRUE(large);
  EXPECT_FALSE(room.take(1));
  large.reset();
  const auto one = room.take(60);
  auto other = room.take(40);
  EXPECT_TRUE(one && other);
  EXPECT_FALSE(room.take(1));
  other.reset();
  EXPECT_FALSE(room.take(~std::size_t(0)));
  EXPECT_TRUE(room.take(40));
}

TEST(FarmBeats, ComeOnceAndBesideOtherEvents) {
  Farm farm(1);
  farm.put(arrivals::Gone{7});
  for (const std::uint64_t parts : {1u, 2u, 3u}) farm.put(arrivals::Beat{7, parts});
  farm.put(arrivals::Beat{8, 9});
  EXPECT_EQ(farm.take_beat().value().parts, 3u);
  EXPECT_EQ(farm.take_beat().value().worker, 8u);
  EXPECT_FALSE(farm.take_beat());
  EXPECT_TRUE(std::holds_alternative<arrivals::Gone>(farm.mailbox.take().value()));
}

}  // namespace
}  // namespace penumbra::result_parts_test
