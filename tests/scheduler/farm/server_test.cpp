// How the server handles outdated, faulty or malicious workers. A raw gRPC client plays them.
#include "scheduler/farm/server.h"

#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>

#include <array>
#include <cmath>
#include <limits>

#include "kernels/host/content_hash.h"
#include "penumbra.grpc.pb.h"
#include "scheduler/farm/private_socket.h"
#include "tests/support/fake_samples.h"
#include "worker/protocol/text.h"
#include "worker/protocol/unit_result.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using Stream = grpc::ClientReaderWriter<wire::WorkerMessage, wire::SchedulerMessage>;

constexpr JobId kJob = 5;
constexpr UnitId kUnit{.job = kJob, .phase = 0, .pass = 2, .tile = 3};
constexpr RenderUnit kArea{.x = 16, .y = 32, .width = 5, .height = 4, .first_sample = 8, .sample_count = 3};

class ServerTest : public testing::Test {
 protected:
  ServerTest() : server_(Server::listen({.address = socket_.address()}).value()) {
    stub_ = wire::Farm::NewStub(grpc::CreateChannel(socket_.address(), grpc::InsecureChannelCredentials()));
    stream_ = stub_->Work(&context_);
  }
  ~ServerTest() override { context_.TryCancel(); }

  void say_hello(std::uint32_t version = kProtocolVersion) {
    wire::WorkerMessage message;
    message.mutable_hello()->set_protocol_version(version);
    message.mutable_hello()->set_host("here");
    message.mutable_hello()->set_pid(42);
    stream_->Write(message);
  }

  /// A beat may come before what was said earlier.
  template <typename T>
  T next(std::chrono::milliseconds patience = 30s) {
    std::optional<Arrival> arrival;
    if (std::is_same_v<T, arrivals::Beat>) arrival = std::exchange(beat_, {});
    if (!arrival) arrival = server_->next(patience);
    while (!std::is_same_v<T, arrivals::Beat> && arrival && std::holds_alternative<arrivals::Beat>(*arrival))
      beat_ = std::exchange(arrival, server_->next(patience));
    EXPECT_TRUE(arrival && std::holds_alternative<T>(*arrival));
    return arrival && std::holds_alternative<T>(*arrival) ? std::get<T>(std::move(*arrival)) : T{};
  }

  /// Hello, and one unit from the server.
  WorkerId connect_and_take_a_unit() {
    say_hello();
    const WorkerId worker = next<arrivals::Connected>().worker;
    server_->send_unit(worker, kUnit, kArea, kNoLayers);
    wire::SchedulerMessage message;
    EXPECT_TRUE(stream_->Read(&message));
    EXPECT_TRUE(message.has_unit());
    EXPECT_EQ(decode(message.unit().id()), kUnit);
    return worker;
  }

  /// Hello, and the job from the server.
  WorkerId connect_and_take_the_job() {
    say_hello();
    const WorkerId worker = next<arrivals::Connected>().worker;
    take_the_job(worker);
    return worker;
  }
  void take_the_job(WorkerId worker) {
    server_->send_job(worker, kJob, "hash", {});
    wire::SchedulerMessage message;
    EXPECT_TRUE(stream_->Read(&message));
    EXPECT_EQ(message.job().id(), kJob);
  }

  static wire::WorkerMessage ready() {
    wire::WorkerMessage message;
    message.mutable_ready()->set_job(kJob);
    message.mutable_ready()->set_device("native");
    return message;
  }

  grpc::Status end_of_stream() {
    wire::SchedulerMessage message;
    while (stream_->Read(&message)) {
    }
    return stream_->Finish();
  }

  wire::WorkerMessage good_result() const {
    wire::WorkerMessage message;
    encode(kUnit, 0, *message.mutable_result()->mutable_id());
    encode(fake_samples(kArea, kNoLayers), *message.mutable_result());
    return message;
  }

  std::string why_rejected(const wire::WorkerMessage& message) {
    stream_->Write(message);
    return next<arrivals::BadResult>().why;
  }

  PrivateSocket socket_ = PrivateSocket::create().value();
  std::unique_ptr<Server> server_;
  std::unique_ptr<wire::Farm::Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<Stream> stream_;
  std::optional<Arrival> beat_;  // that was passed over
};

TEST_F(ServerTest, AnotherProtocolVersionIsRefusedWithTheReason) {
  say_hello(kProtocolVersion + 1);
  wire::SchedulerMessage message;
  ASSERT_TRUE(stream_->Read(&message));
  ASSERT_TRUE(message.has_refused());
  EXPECT_THAT(message.refused().reason(),
              HasSubstr("the worker speaks protocol version " + std::to_string(kProtocolVersion + 1) +
                        ", this side version " + std::to_string(kProtocolVersion)));
  EXPECT_FALSE(stream_->Read(&message));
  EXPECT_EQ(stream_->Finish().error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_FALSE(server_->next(50ms)) << "the plan must not hear of it";
}

TEST_F(ServerTest, AWorkerMustSayHelloFirst) {
  wire::WorkerMessage message;
  message.mutable_ready()->set_job(1);
  stream_->Write(message);
  wire::SchedulerMessage answer;
  EXPECT_FALSE(stream_->Read(&answer));
  EXPECT_EQ(stream_->Finish().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(ServerTest, AnEmptyMessageEndsTheConnection) {
  say_hello();
  next<arrivals::Connected>();
  stream_->Write(wire::WorkerMessage());
  next<arrivals::Gone>();
  wire::SchedulerMessage answer;
  EXPECT_FALSE(stream_->Read(&answer));
  EXPECT_EQ(stream_->Finish().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(ServerTest, AGoodResultArrivesAsItIs) {
  const WorkerId worker = connect_and_take_a_unit();
  wire::WorkerMessage message = good_result();
  message.mutable_result()->set_busy_seconds(1.5);
  stream_->Write(message);
  const auto result = next<arrivals::Result>();
  EXPECT_EQ(result.worker, worker);
  EXPECT_EQ(result.unit, kUnit);
  EXPECT_EQ(result.buffer.values, fake_samples(kArea, kNoLayers).values);
  EXPECT_EQ(result.buffer.sample_count, 3u);
  EXPECT_EQ(result.busy_seconds, 1.5);
}

TEST_F(ServerTest, WhatIsSaidOfKernelsArrivesAsItIs) {
  const WorkerId worker = connect_and_take_the_job();
  wire::WorkerMessage compiling, ready;
  compiling.mutable_compiling()->set_job(kJob);
  ready.mutable_ready()->set_job(kJob);
  compiling.mutable_compiling()->set_device("an abacus");
  stream_->Write(compiling);
  const auto heard = next<arrivals::Compiling>();
  EXPECT_EQ(heard.worker, worker);
  EXPECT_EQ(heard.device, "an abacus");
  const DevicePreparation sent{.kernels = KernelOrigin{.cached = true, .seconds = 1.5, .note = "none lost"},
                               .warnings = {"slow", "wooden"}};
  encode(sent, *ready.mutable_ready());
  stream_->Write(ready);
  const DevicePreparation came = next<arrivals::Ready>().preparation;
  ASSERT_TRUE(came.kernels);
  EXPECT_TRUE(came.kernels->cached);
  EXPECT_EQ(came.kernels->seconds, 1.5);
  EXPECT_EQ(came.kernels->note, "none lost");
  EXPECT_EQ(came.warnings, sent.warnings);
}

TEST_F(ServerTest, KernelsThatWereCompiledWithTheWorkerAreNotSpokenOf) {
  connect_and_take_the_job();
  stream_->Write(ready());
  EXPECT_FALSE(next<arrivals::Ready>().preparation.kernels);
}

TEST_F(ServerTest, AWorkerIsReadyOnceForEachTimeThatItIsGivenAJob) {
  const WorkerId worker = connect_and_take_the_job();
  stream_->Write(ready());
  EXPECT_EQ(next<arrivals::Ready>().job, kJob);
  server_->forget_job(worker, kJob);
  wire::SchedulerMessage message;
  ASSERT_TRUE(stream_->Read(&message));
  EXPECT_EQ(message.forget().job(), kJob);
  take_the_job(worker);
  stream_->Write(ready());
  EXPECT_EQ(next<arrivals::Ready>().job, kJob);
  stream_->Write(ready());
  next<arrivals::Gone>();
  EXPECT_EQ(end_of_stream().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(ServerTest, AWorkerIsNotReadyForAJobThatItWasNotGiven) {
  say_hello();
  next<arrivals::Connected>();
  stream_->Write(ready());
  next<arrivals::Gone>();
  EXPECT_EQ(end_of_stream().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(ServerTest, OfAForgottenJobsUnitsNothingIsHeard) {
  const WorkerId worker = connect_and_take_the_job();
  server_->send_unit(worker, kUnit, kArea, kNoLayers);
  server_->forget_job(worker, kJob);
  stream_->Write(ready());
  stream_->Write(good_result());
  wire::WorkerMessage beat;
  beat.mutable_beat()->set_parts(3);
  stream_->Write(beat);
  EXPECT_EQ(next<arrivals::Ready>().job, kJob) << "the worker has started";
  EXPECT_EQ(next<arrivals::Beat>().parts, 3u) << "the next that is heard";
}

TEST_F(ServerTest, ResultsOfOlderViewsAreNotHeardThoseOfOtherJobsAre) {
  const WorkerId worker = connect_and_take_a_unit();
  UnitId other = kUnit;
  other.job = 6;
  server_->send_unit(worker, other, kArea, kNoLayers);
  server_->send_view(worker, kJob, {1, {}});
  stream_->Write(good_result());
  wire::WorkerMessage of_other = good_result();
  encode(other, 0, *of_other.mutable_result()->mutable_id());
  stream_->Write(of_other);
  EXPECT_EQ(next<arrivals::Result>().unit, other);
}

TEST_F(ServerTest, ASecondHelloEndsTheConnection) {
  say_hello();
  next<arrivals::Connected>();
  say_hello();
  next<arrivals::Gone>();
  EXPECT_EQ(end_of_stream().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(ServerTest, WhoIsDismissedIsNotHeardAnyMoreAndCutOff) {
  const WorkerId worker = connect_and_take_the_job();
  stream_->Write(ready());
  next<arrivals::Ready>();
  server_->dismiss(worker, "it lies");
  server_->send_unit(worker, kUnit, kArea, kNoLayers);
  wire::SchedulerMessage message;
  ASSERT_TRUE(stream_->Read(&message));
  EXPECT_EQ(message.dismiss().reason(), "it lies");
  stream_->Write(ready());
  stream_->Write(good_result());
  wire::WorkerMessage failed;
  failed.mutable_job_failed()->set_message("or so");
  stream_->Write(failed);
  EXPECT_EQ(next<arrivals::Gone>().worker, worker) << "the next that is heard";
  EXPECT_FALSE(stream_->Read(&message)) << "no unit after the final message";
}

TEST_F(ServerTest, AWorkerThatCannotDoAJobMayDoAnother) {
  const WorkerId worker = connect_and_take_the_job();
  wire::WorkerMessage failed;
  failed.mutable_job_failed()->set_job(kJob);
  failed.mutable_job_failed()->set_message("no such device");
  stream_->Write(failed);
  const auto heard = next<arrivals::JobFailed>();
  EXPECT_EQ(heard.job, kJob);
  EXPECT_EQ(heard.message, "no such device");
  take_the_job(worker);
  stream_->Write(ready());
  next<arrivals::Ready>();
  stream_->WritesDone();
  next<arrivals::Gone>();
}

TEST_F(ServerTest, AWorkerThatDoesNotReadDelaysNothing) {
  say_hello();
  const WorkerId worker = next<arrivals::Connected>().worker;
  // Enough to fill any buffer of the connection; the stream is not read.
  for (std::uint32_t number = 1; number <= 50'000; ++number) server_->send_view(worker, kJob, {number, {}});
  const std::string much(std::size_t(64) << 10, 'x');
  for (int i = 0; i < 2000; ++i) server_->send_job(worker, kJob, much, {});
  server_->dismiss(worker, "");
}

TEST_F(ServerTest, NamesAndTextsAreCutAndTimesAreNumbers) {
  wire::WorkerMessage hello;
  hello.mutable_hello()->set_protocol_version(kProtocolVersion);
  std::string long_name;
  while (long_name.size() < 10'000) long_name += "\xe2\x82\xac";
  hello.mutable_hello()->set_host(long_name);
  stream_->Write(hello);
  const auto connected = next<arrivals::Connected>();
  const std::string& host = connected.host;
  EXPECT_LE(host.size(), kLongestName);
  EXPECT_TRUE(host.ends_with("\xac...")) << "no half of a character";
  take_the_job(connected.worker);
  wire::WorkerMessage message = ready();
  message.mutable_ready()->mutable_kernels()->set_seconds(std::numeric_limits<double>::quiet_NaN());
  stream_->Write(message);
  next<arrivals::Gone>();
  EXPECT_EQ(end_of_stream().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(ServerTest, AResultThatTookNoTimeAtAllOrForEverIsRejected) {
  for (const double seconds :
       {std::numeric_limits<double>::quiet_NaN(), -1.0, std::numeric_limits<double>::infinity()}) {
    wire::WorkerMessage message = good_result();
    message.mutable_result()->set_busy_seconds(seconds);
    EXPECT_FALSE(decode(message.result(), kArea, kNoLayers)) << seconds;
  }
  EXPECT_TRUE(decode(good_result().result(), kArea, kNoLayers));
}

/// What a result with these mattes is to a scheduler whose scene has 9.
std::string error_of_mattes(const std::vector<std::uint32_t>& mattes) {
  SampleBuffer buffer = fake_samples(kArea, kNoLayers);
  buffer.mattes = mattes;
  wire::UnitResult message;
  encode(buffer, message);
  const auto decoded = decode(message, kArea, FilmLayers(0, 9));
  if (!decoded) return decoded.error().message;
  EXPECT_EQ(decoded->mattes, mattes);
  return "";
}

TEST(ResultMattes, AreThoseOfTheSamplesOfEachPixel) {
  const auto pixels = std::size_t(kArea.width) * std::size_t(kArea.height);
  const std::uint32_t n = kArea.sample_count;
  ASSERT_GE(n, 2u);
  // Nobody and the last matte, of each pixel.
  std::vector<std::uint32_t> mattes;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel)
    mattes.insert(mattes.end(), {2u, std::uint32_t(NO_MATTE), 1u, 9u, n - 1});
  EXPECT_EQ(error_of_mattes(mattes), "");
  const auto changed = [&](std::size_t at, std::uint32_t value) {
    std::vector<std::uint32_t> wrong = mattes;
    wrong[at] = value;
    return error_of_mattes(wrong);
  };
  EXPECT_THAT(changed(3, 10), HasSubstr("unknown"));
  EXPECT_THAT(changed(3, NO_MATTE), HasSubstr("out of its order")) << "twice";
  EXPECT_THAT(changed(4, n), HasSubstr("samples in a pixel"));
  EXPECT_THAT(changed(4, 0), HasSubstr("no sample met"));
  EXPECT_THAT(changed(4, ~0u), HasSubstr("samples in a pixel")) << "no sum may run over";
  EXPECT_THAT(changed(0, ~0u), HasSubstr("no list"));
  EXPECT_THAT(changed(0, 3), testing::Not(testing::IsEmpty()));
  EXPECT_THAT(error_of_mattes({}), HasSubstr("no list"));
  std::vector<std::uint32_t> shorter = mattes, longer = mattes;
  shorter.pop_back();
  longer.push_back(0);
  EXPECT_THAT(error_of_mattes(shorter), HasSubstr("no list"));
  EXPECT_THAT(error_of_mattes(longer), HasSubstr("more pixels"));
}

TEST(ResultMattes, OfASceneWithoutThemAreRefusedAndEveryBitIsSecured) {
  SampleBuffer buffer = fake_samples(kArea, kNoLayers);
  for (std::size_t pixel = 0; pixel < buffer.pixels(); ++pixel)
    buffer.mattes.insert(buffer.mattes.end(), {1u, 5u, buffer.sample_count});
  wire::UnitResult message;
  encode(buffer, message);
  EXPECT_FALSE(decode(message, kArea, FilmLayers(0, 0)));
  EXPECT_TRUE(decode(message, kArea, FilmLayers(0, 9)));
  const std::uint64_t hash = result_hash(buffer);
  message.mutable_pixels()->set_mattes(1, 4);
  const auto decoded = decode(message, kArea, FilmLayers(0, 9));
  ASSERT_FALSE(decoded);
  EXPECT_THAT(decoded.error().message, HasSubstr("checksum"));
  buffer.mattes[1] = 4;
  EXPECT_NE(result_hash(buffer), hash) << "two workers that differ are told apart";
}

TEST_F(ServerTest, AMessageThatNoUnitCanHoldIsNotTaken) {
  connect_and_take_a_unit();
  wire::WorkerMessage message = good_result();
  message.mutable_result()->mutable_pixels()->set_values(std::string(std::size_t(16) << 20, 0));
  stream_->Write(message);
  next<arrivals::Gone>();
}

TEST_F(ServerTest, ABeatArrivesAsItIs) {
  say_hello();
  const WorkerId worker = next<arrivals::Connected>().worker;
  wire::WorkerMessage message;
  message.mutable_beat()->set_parts(12);
  stream_->Write(message);
  const auto beat = next<arrivals::Beat>();
  EXPECT_EQ(beat.worker, worker);
  EXPECT_EQ(beat.parts, 12u);
}

TEST_F(ServerTest, AFlippedBitIsNoticed) {
  connect_and_take_a_unit();
  wire::WorkerMessage message = good_result();
  (*message.mutable_result()->mutable_pixels()->mutable_values())[7] ^= 1;
  EXPECT_THAT(why_rejected(message), HasSubstr("checksum"));
}

TEST_F(ServerTest, MissingBytesAreNoticed) {
  connect_and_take_a_unit();
  wire::WorkerMessage message = good_result();
  message.mutable_result()->mutable_pixels()->mutable_values()->pop_back();
  EXPECT_THAT(why_rejected(message), HasSubstr("479 bytes of samples instead of 480"));
}

TEST_F(ServerTest, OtherSizesAreNoticed) {
  connect_and_take_a_unit();
  wire::WorkerMessage message = good_result();
  message.mutable_result()->mutable_pixels()->set_width(-5);
  EXPECT_THAT(why_rejected(message), HasSubstr("-5 x 4 pixels"));
}

TEST_F(ServerTest, OtherSampleCountsAreNoticed) {
  connect_and_take_a_unit();
  wire::WorkerMessage message = good_result();
  message.mutable_result()->mutable_pixels()->set_sample_count(0);
  EXPECT_THAT(why_rejected(message), HasSubstr("0 samples"));
}

TEST_F(ServerTest, ImpossibleCountsAreNoticed) {
  connect_and_take_a_unit();
  wire::WorkerMessage message = good_result();
  message.mutable_result()->mutable_pixels()->mutable_flagged(BAD_NAN)->set_count(61);
  EXPECT_THAT(why_rejected(message), HasSubstr("61 samples of a kind"));
}

TEST_F(ServerTest, FlaggedSamplesThatCannotBeAreNoticed) {
  connect_and_take_a_unit();
  wire::WorkerMessage message = good_result();
  message.mutable_result()->mutable_pixels()->mutable_flagged(BAD_BOUNDARY)->set_shape(-1);
  EXPECT_THAT(why_rejected(message), HasSubstr("a source or a shape that cannot be"));
}

TEST_F(ServerTest, ValuesThatAreNoStatisticsAreNoticed) {
  connect_and_take_a_unit();
  const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
  struct Bad {
    int plane;
    float value;
    const char* text;
  };
  for (const Bad& bad :
       {Bad{kMeanG, nan, "nan as a mean radiance of its pixel (1, 2)"},
        Bad{kMeanR, -infinity, "-inf as a mean radiance"}, Bad{kDeviationB, infinity, "inf as a deviation"},
        Bad{kDeviationR, nan, "nan as a deviation"}, Bad{kDeviationG, -1, "-1 as a deviation"},
        Bad{kFeatureLayers.plane(LAYER_DEPTH), nan, "nan as a layer"}}) {
    SCOPED_TRACE(bad.text);
    const bool is_layer = bad.plane >= kRadiancePlanes;
    const FilmLayers layers = is_layer ? kFeatureLayers : kNoLayers;
    SampleBuffer buffer = fake_samples(kArea, layers);
    buffer.plane(bad.plane)[11] = bad.value;
    buffer.flagged[BAD_NAN] = {
        .count = 1, .x = kArea.x, .y = kArea.y, .sample = kArea.first_sample};  // explains nothing
    wire::UnitResult message;
    encode(buffer, message);
    const Expected<SampleBuffer> decoded = decode(message, kArea, layers);
    ASSERT_FALSE(decoded);
    EXPECT_THAT(decoded.error().message, HasSubstr(bad.text));
    if (is_layer) continue;
    wire::WorkerMessage whole = good_result();
    encode(buffer, *whole.mutable_result());
    server_->send_unit(1, kUnit, kArea, kNoLayers);
    EXPECT_THAT(why_rejected(whole), HasSubstr(bad.text));
  }
}

TEST_F(ServerTest, AnImpossibleTimeIsNoticed) {
  for (const double seconds : {-1.0, std::nan(""), double(std::numeric_limits<float>::infinity())}) {
    wire::WorkerMessage message = good_result();
    message.mutable_result()->set_busy_seconds(seconds);
    EXPECT_FALSE(decode(message.result(), kArea, kNoLayers)) << seconds;
  }
}

TEST_F(ServerTest, AnUnsolicitedResultIsRejected) {
  connect_and_take_a_unit();
  wire::WorkerMessage message = good_result();
  message.mutable_result()->mutable_id()->set_tile(4);
  EXPECT_THAT(why_rejected(message), HasSubstr("not asked"));
}

TEST_F(ServerTest, AResultThatComesTwiceIsRejected) {
  connect_and_take_a_unit();
  stream_->Write(good_result());
  next<arrivals::Result>();
  EXPECT_THAT(why_rejected(good_result()), HasSubstr("not asked"));
}

TEST_F(ServerTest, ResultsThatDifferHaveDifferentHashes) {
  const SampleBuffer good = fake_samples(kArea, kNoLayers);
  SampleBuffer other = good;
  EXPECT_EQ(result_hash(good), result_hash(other));
  ++other.flagged[BAD_NAN].count;
  EXPECT_NE(result_hash(good), result_hash(other));
  other = good;
  other.values[0] += 1;
  EXPECT_NE(result_hash(good), result_hash(other));
}

TEST_F(ServerTest, ABrokenStreamIsAWorkerGone) {
  say_hello();
  const WorkerId worker = next<arrivals::Connected>().worker;
  context_.TryCancel();
  EXPECT_EQ(next<arrivals::Gone>().worker, worker);
  server_->send_unit(worker, kUnit, kArea, kNoLayers);  // nothing happens
  server_->dismiss(worker, "");
}

TEST_F(ServerTest, AssetsComeInSmallPiecesByTheirHash) {
  std::vector<std::uint8_t> bytes(kAssetChunkBytes * 2 + 5);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::uint8_t(i * 7 + i / 1000);
  constexpr std::size_t kHead = 100, kCut = 1000;
  const std::span<const std::uint8_t> head = std::span(bytes).first(kHead),
                                      body = std::span(bytes).subspan(kHead);
  const AssetManifest manifest = make_manifest(head, body, std::array{kCut});
  server_->add_asset({manifest, {head.begin(), head.end()}, body, nullptr});
  ASSERT_EQ(manifest.pieces.size(), 3u);
  const std::vector<std::span<const std::uint8_t>> pieces = {head, body.first(kCut), body.subspan(kCut)};
  for (std::size_t i = 0; i < pieces.size(); ++i)
    EXPECT_EQ(manifest.pieces[i], (AssetPiece{content_hash(pieces[i]), pieces[i].size()}));

  wire::AssetRequest request;
  request.set_hash(manifest.hash);
  {
    grpc::ClientContext context;
    wire::AssetManifest reply;
    ASSERT_TRUE(stub_->Manifest(&context, request, &reply).ok());
    EXPECT_EQ(decode(reply, manifest.hash)->pieces, manifest.pieces);
    EXPECT_FALSE(decode(reply, content_hash(bytes))) << "it is another one's";
    reply.mutable_pieces(1)->set_size(kCut + 1);
    EXPECT_FALSE(decode(reply, manifest.hash));
  }
  const auto fetch = [&](const std::vector<std::uint32_t>& wanted)
      -> std::pair<std::vector<std::uint8_t>, grpc::StatusCode> {
    grpc::ClientContext context;
    request.clear_pieces();
    for (const std::uint32_t piece : wanted) request.add_pieces(piece);
    const auto reader = stub_->Asset(&context, request);
    std::vector<std::uint8_t> received;
    wire::AssetChunk chunk;
    while (reader->Read(&chunk)) {
      EXPECT_LE(chunk.data().size(), kAssetChunkBytes);
      received.insert(received.end(), chunk.data().begin(), chunk.data().end());
    }
    return {received, reader->Finish().error_code()};
  };
  EXPECT_EQ(fetch({0, 1, 2}), std::pair(bytes, grpc::StatusCode::OK));
  std::vector<std::uint8_t> two_of_them(pieces[2].begin(), pieces[2].end());
  two_of_them.insert(two_of_them.end(), head.begin(), head.end());
  EXPECT_EQ(fetch({2, 0}), std::pair(two_of_them, grpc::StatusCode::OK));
  EXPECT_EQ(fetch({3}).second, grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(fetch({0, 0, 0, 0}).second, grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(ServerTest, EqualAssetsAreKeptUntilTheLastOfThemIsRemoved) {
  const std::vector<std::uint8_t> bytes(10, 7);
  const AssetManifest manifest = make_manifest(bytes, {}, {});
  const auto is_there = [&] {
    grpc::ClientContext context;
    wire::AssetRequest request;
    request.set_hash(manifest.hash);
    wire::AssetManifest reply;
    return stub_->Manifest(&context, request, &reply).ok();
  };
  for (int i = 0; i < 2; ++i) server_->add_asset({manifest, bytes, {}, nullptr});
  server_->remove_asset(manifest.hash);
  EXPECT_TRUE(is_there());
  server_->remove_asset(manifest.hash);
  EXPECT_FALSE(is_there());
}

TEST_F(ServerTest, AnUnknownAssetIsNotFound) {
  grpc::ClientContext context;
  wire::AssetRequest request;
  request.set_hash("0123");
  const auto reader = stub_->Asset(&context, request);
  wire::AssetChunk chunk;
  EXPECT_FALSE(reader->Read(&chunk));
  const grpc::Status status = reader->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(status.error_message(), HasSubstr("0123"));
}

TEST(Server, AnAddressThatCannotBeListenedOnIsAnError) {
  const auto server = Server::listen({.address = "unix:/no/such/directory/socket"});
  ASSERT_FALSE(server);
  EXPECT_THAT(server.error().message, HasSubstr("/no/such/directory/socket"));
}

TEST(MessageSize, HoldsTheLargestPart) {
  SampleBuffer buffer = fake_samples(kArea, kNoLayers);
  buffer.values.clear();
  buffer.mattes.assign(kMostPartBytes / sizeof(std::uint32_t) + 1, ~0u);
  const wire::UnitId id;
  ResultCutter cutter(id, buffer);
  wire::WorkerMessage message;
  EXPECT_FALSE(cutter.next(kMostPartBytes, message));
  EXPECT_LT(message.ByteSizeLong(), std::size_t(kMaxRequestBytes));
}

}  // namespace
}  // namespace penumbra
