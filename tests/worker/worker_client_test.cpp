// The worker's client; the test plays the scheduler.
#include "worker/worker_client.h"

#include <gmock/gmock.h>
#include <grpcpp/server_builder.h>

#include <future>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "penumbra.grpc.pb.h"
#include "scheduler/farm/private_socket.h"
#include "tests/support/fake_device.h"
#include "tests/support/fake_samples.h"
#include "tests/support/temporary_folder.h"
#include "worker/back_off.h"
#include "worker/keys/address_file.h"
#include "worker/part_size.h"
#include "worker/protocol/unit_result.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using Stream = grpc::ServerReaderWriter<wire::SchedulerMessage, wire::WorkerMessage>;

AssetManifest in_one_piece(const std::vector<std::uint8_t>& bytes) { return make_manifest(bytes, {}, {}); }

/// Serves one scene; what happens on the Work stream is the test's script.
class ScriptedScheduler final : public wire::Farm::Service {
 public:
  using Script = std::function<void(Stream&)>;

  /// `status`: what a stream ends with after the script.
  ScriptedScheduler(const std::string& address, Script script, grpc::Status status = grpc::Status::OK)
      : script_(std::move(script)), status_(std::move(status)) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(address, grpc::InsecureServerCredentials());
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  ~ScriptedScheduler() override { server_->Shutdown(std::chrono::system_clock::now()); }

  grpc::Status Work(grpc::ServerContext*, Stream* stream) override {
    script_(*stream);
    return status_;
  }
  grpc::Status Manifest(grpc::ServerContext*, const wire::AssetRequest* request,
                        wire::AssetManifest* reply) override {
    if (request->hash() == "nowhere") return {grpc::StatusCode::NOT_FOUND, "no such asset"};
    encode(manifest, *reply);
    return grpc::Status::OK;
  }
  grpc::Status Asset(grpc::ServerContext*, const wire::AssetRequest* request,
                     grpc::ServerWriter<wire::AssetChunk>* writer) override {
    EXPECT_EQ(request->pieces_size(), 1);
    wire::AssetChunk chunk;
    for (std::size_t at = 0; at < asset.size(); at += 100) {
      chunk.set_data(asset.data() + at, std::min<std::size_t>(100, asset.size() - at));
      writer->Write(chunk);
    }
    return grpc::Status::OK;
  }

  std::vector<std::uint8_t> asset = fake_scene(100, 80, false).serialize();
  AssetManifest manifest = in_one_piece(asset);

 private:
  Script script_;
  grpc::Status status_;
  std::unique_ptr<grpc::Server> server_;
};

wire::SchedulerMessage job_message(const std::string& hash, JobId job = 5) {
  wire::SchedulerMessage message;
  message.mutable_job()->set_id(job);
  message.mutable_job()->set_scene(hash);
  encode(DeviceOptions{.backend = Backend::kNative,
                       .threads = 3,
                       .isa = Isa::kAvx2,
                       .block_of_one = true,
                       .opencl_device = "anything"},
         *message.mutable_job()->mutable_device());
  return message;
}

wire::SchedulerMessage unit_message(std::uint32_t tile, int width = 4, JobId job = 5,
                                    std::uint32_t view = 0) {
  wire::SchedulerMessage message;
  encode(UnitId{job, 0, 0, tile}, view, *message.mutable_unit()->mutable_id());
  encode(
      RenderUnit{
          .x = int(tile) * 4, .y = 1, .width = width, .height = 2, .first_sample = 0, .sample_count = 3},
      *message.mutable_unit());
  return message;
}

wire::SchedulerMessage dismissal() {
  wire::SchedulerMessage message;
  message.mutable_dismiss()->set_reason("done");
  return message;
}

/// What comes beside the beats, of which there is one a second.
wire::WorkerMessage read(Stream& stream) {
  wire::WorkerMessage message;
  do {
    message.Clear();
    EXPECT_TRUE(stream.Read(&message));
  } while (message.has_beat());
  return message;
}

class WorkerClientTest : public testing::Test {
 protected:
  WorkerClientTest() {
    options_.address = socket_.address();
    options_.retry_for = 5;
    options_.make_device = [this](const DeviceScene& scene, const DeviceOptions& device) {
      device_options_ = device;
      return make_fake_device(scene, device, behaviour_);
    };
  }

  Expected<void> run(ScriptedScheduler::Script script) {
    ScriptedScheduler scheduler(socket_.address(), std::move(script));
    if (!asset_.empty()) scheduler.asset = asset_;
    if (!is_damaged_) scheduler.manifest = in_one_piece(scheduler.asset);
    return run_worker(options_);
  }

  /// Hello, Job, Ready; then the script goes on.
  Expected<void> run_ready(ScriptedScheduler::Script script) {
    return run([&](Stream& stream) {
      read(stream);
      stream.Write(job_message(scene_hash_));
      EXPECT_TRUE(read(stream).has_ready());
      script(stream);
    });
  }

  std::string error_of(const Expected<void>& worked) { return worked ? "none" : worked.error().message; }

  PrivateSocket socket_ = PrivateSocket::create().value();
  const std::string scene_hash_ = in_one_piece(fake_scene(100, 80, false).serialize()).hash;
  std::vector<std::uint8_t> asset_;
  bool is_damaged_ = false;  // it is not what the manifest says
  WorkerClientOptions options_;
  DeviceOptions device_options_;
  FakeBehaviour behaviour_;
};

TEST_F(WorkerClientTest, IntroducesItself) {
  options_.isas = {Isa::kSse2, Isa::kAvx512};
  wire::Hello hello;
  const Expected<void> worked = run([&](Stream& stream) {
    hello = read(stream).hello();
    stream.Write(dismissal());
  });
  EXPECT_TRUE(worked) << error_of(worked);
  EXPECT_EQ(hello.protocol_version(), kProtocolVersion);
  EXPECT_EQ(hello.pid(), getpid());
  EXPECT_FALSE(hello.host().empty());
  EXPECT_THAT(hello.isas(), testing::ElementsAre(wire::ISA_SSE2, wire::ISA_AVX512));
}

TEST_F(WorkerClientTest, RendersUnitsInTheirOrder) {
  std::vector<wire::WorkerMessage> results;
  const Expected<void> worked = run_ready([&](Stream& stream) {
    for (const std::uint32_t tile : {7, 3, 5}) stream.Write(unit_message(tile));
    for (int i = 0; i < 3; ++i) results.push_back(read(stream));
    stream.Write(dismissal());
  });
  EXPECT_TRUE(worked) << error_of(worked);
  EXPECT_EQ(device_options_.threads, 3);
  EXPECT_EQ(device_options_.isa, Isa::kAvx2);
  EXPECT_TRUE(device_options_.block_of_one);
  EXPECT_EQ(device_options_.opencl_device, "anything");
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t tile = std::array{7, 3, 5}[std::size_t(i)];
    ASSERT_TRUE(results[std::size_t(i)].has_result());
    const wire::UnitResult& result = results[std::size_t(i)].result();
    EXPECT_EQ(decode(result.id()), (UnitId{5, 0, 0, tile}));
    const RenderUnit unit = decode(unit_message(tile).unit()).value();
    const Expected<SampleBuffer> buffer = decode(result, unit, kNoLayers);
    ASSERT_TRUE(buffer) << buffer.error().message;
    EXPECT_EQ(buffer->values, fake_samples(unit, kNoLayers).values);
    EXPECT_GT(result.peak_memory_bytes(), 1u << 20);
  }
}

TEST_F(WorkerClientTest, ALargeResultComesInParts) {
  constexpr int kWide = 2000;  // 96 KB
  std::vector<wire::WorkerMessage> answers;
  run_ready([&](Stream& stream) {
    stream.Write(unit_message(3, kWide));
    do answers.push_back(read(stream));
    while (answers.back().has_part());
    stream.Write(dismissal());
  });
  ASSERT_EQ(answers.size(), 2u);
  const RenderUnit unit{.x = 12, .y = 1, .width = kWide, .height = 2, .first_sample = 0, .sample_count = 3};
  ResultAssembly assembly(unit, kNoLayers);
  EXPECT_TRUE(assembly.add(answers[0].part()));
  const Expected<SampleBuffer> buffer = assembly.finish(answers[1].result());
  ASSERT_TRUE(buffer) << buffer.error().message;
  EXPECT_EQ(buffer->values, fake_samples(unit, kNoLayers).values);
}

TEST(PartSize, GrowsWhileMessagesAreTakenAtOnceAndShrinksWhereTheyAreNot) {
  PartSize size;
  const std::size_t first = size.bytes();
  size.wrote(first / 2, 0);
  EXPECT_EQ(size.bytes(), first) << "a short message says little";
  for (int i = 0; i < 100; ++i) size.wrote(size.bytes(), 0.001);
  EXPECT_EQ(size.bytes(), kMostPartBytes);
  size.wrote(size.bytes(), 0.2);
  EXPECT_EQ(size.bytes(), kMostPartBytes);
  for (int i = 0; i < 100; ++i) size.wrote(1, 2);
  EXPECT_LT(size.bytes(), first);
  EXPECT_GE(size.bytes(), 1024u);
}

TEST_F(WorkerClientTest, TheMachinesOwnerHasTheLastWord) {
  options_.backend = Backend::kOpenCl;
  options_.threads = 1;
  options_.isa = Isa::kSse2;
  options_.opencl_device = "pocl";
  EXPECT_TRUE(run_ready([](Stream& stream) { stream.Write(dismissal()); }));
  EXPECT_EQ(device_options_.backend, Backend::kOpenCl);
  EXPECT_EQ(device_options_.threads, 1);
  EXPECT_EQ(device_options_.isa, Isa::kSse2);
  EXPECT_EQ(device_options_.opencl_device, "pocl");
}

TEST_F(WorkerClientTest, ARefusalIsAnErrorWithTheReason) {
  const Expected<void> worked = run([](Stream& stream) {
    read(stream);
    wire::SchedulerMessage message;
    message.mutable_refused()->set_reason("the worker speaks protocol version 99");
    stream.Write(message);
  });
  EXPECT_THAT(error_of(worked), HasSubstr("the worker speaks protocol version 99"));
}

TEST_F(WorkerClientTest, NoSchedulerIsAnErrorAfterTheTimeout) {
  options_.retry_for = 0.2;
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(error_of(run_worker(options_)), HasSubstr("no scheduler answers at " + socket_.address()));
  EXPECT_LT(std::chrono::steady_clock::now() - start, 8s) << "as long as by default";
}

TEST_F(WorkerClientTest, ASchedulerThatComesLaterIsFound) {
  std::unique_ptr<ScriptedScheduler> scheduler;
  std::thread later([&] {
    std::this_thread::sleep_for(150ms);
    scheduler = std::make_unique<ScriptedScheduler>(socket_.address(), [](Stream& stream) {
      read(stream);
      stream.Write(dismissal());
    });
  });
  EXPECT_TRUE(run_worker(options_));
  later.join();
}

TEST_F(WorkerClientTest, AfterALostConnectionItComesBack) {
  options_.reconnects = true;
  std::vector<std::string> waited_for;
  options_.on_waiting = [&](const std::string& why) { waited_for.push_back(why); };
  std::mutex mutex;  // each connection has a thread
  std::vector<bool> were_ready;
  const Expected<void> worked = run([&](Stream& stream) {
    read(stream);
    stream.Write(job_message(scene_hash_));
    const bool is_ready = read(stream).has_ready();
    const std::lock_guard lock(mutex);
    were_ready.push_back(is_ready);
    if (were_ready.size() < 3) return;  // without a word
    stream.Write(dismissal());
  });
  EXPECT_TRUE(worked) << error_of(worked);
  EXPECT_THAT(were_ready, testing::ElementsAre(true, true, true))
      << "a scheduler that is new knows of no job";
  EXPECT_THAT(waited_for, testing::ElementsAre(HasSubstr("broke the connection"))) << "said once";
}

TEST_F(WorkerClientTest, ASchedulerThatIsStoppedToComeBackIsWaitedFor) {
  options_.reconnects = true;
  const auto start = [this](bool comes_back) {
    return std::make_unique<ScriptedScheduler>(socket_.address(), [comes_back](Stream& stream) {
      read(stream);
      wire::SchedulerMessage message = dismissal();
      message.mutable_dismiss()->set_comes_back(comes_back);
      stream.Write(message);
    });
  };
  std::unique_ptr<ScriptedScheduler> scheduler = start(true);
  std::promise<void> waiting;
  bool is_waiting = false;
  options_.on_waiting = [&](const std::string& why) {
    if (!std::exchange(is_waiting, true)) {
      EXPECT_THAT(why, HasSubstr("was stopped"));
      waiting.set_value();
    }
  };
  std::thread restart([&] {
    waiting.get_future().wait();
    scheduler.reset();
    std::this_thread::sleep_for(300ms);
    scheduler = start(false);
  });
  const Expected<void> worked = run_worker(options_);
  restart.join();
  EXPECT_TRUE(worked) << error_of(worked);
}

TEST_F(WorkerClientTest, ASchedulerThatDoesNotComeBackIsGivenUp) {
  options_.reconnects = true;
  options_.retry_for = 0.5;
  auto scheduler = std::make_unique<ScriptedScheduler>(socket_.address(), [](Stream& stream) {
    read(stream);
    wire::SchedulerMessage message = dismissal();
    message.mutable_dismiss()->set_comes_back(true);
    stream.Write(message);
  });
  std::future<void> ended;
  options_.on_waiting = [&](const std::string&) {
    if (!ended.valid()) ended = std::async(std::launch::async, [&] { scheduler.reset(); });
  };
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(
      error_of(run_worker(options_)),
      testing::AllOf(HasSubstr("no scheduler answers at " + socket_.address()), HasSubstr("waited 0.5 s")));
  EXPECT_GT(std::chrono::steady_clock::now() - start, 400ms);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 20s);
}

TEST_F(WorkerClientTest, SaysAgainWhatItWaitsForAndHowLong) {
  options_.retry_for = 0.4;
  options_.reminder = 0.05;
  std::vector<std::string> said;
  options_.on_waiting = [&](const std::string& text) { said.push_back(text); };
  EXPECT_THAT(error_of(run_worker(options_)), HasSubstr("waited 0.4 s"));
  ASSERT_GE(said.size(), 2u);
  for (const std::string& text : said)
    EXPECT_THAT(text, testing::AllOf(HasSubstr("waiting for up to 1 s (--retry-for)"),
                                     HasSubstr("no scheduler answers at " + socket_.address())));
}

class AddressFile : public WorkerClientTest {
 protected:
  AddressFile() {
    options_.address = "file:" + file_.string();
    options_.reconnects = true;
    options_.on_waiting = [this](const std::string& text) { said_.push_back(text); };
  }
  /// A scheduler that dismisses whoever comes.
  static std::unique_ptr<ScriptedScheduler> scheduler_at(const std::string& address, bool comes_back) {
    return std::make_unique<ScriptedScheduler>(address, [comes_back](Stream& stream) {
      read(stream);
      wire::SchedulerMessage message = dismissal();
      message.mutable_dismiss()->set_comes_back(comes_back);
      stream.Write(message);
    });
  }

  TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "address";
  std::vector<std::string> said_;
};

TEST_F(AddressFile, LeadsToASchedulerThatComesLaterAndToAnotherOneThatGoesOn) {
  const PrivateSocket other = PrivateSocket::create().value();
  std::unique_ptr<ScriptedScheduler> first, second;
  options_.on_waiting = [&, is_next = false](const std::string& text) mutable {
    said_.push_back(text);
    if (said_.size() == 1) {
      first = scheduler_at(socket_.address(), true);
      ASSERT_TRUE(write_address_file(file_, socket_.address()));
    } else if (text.contains("was stopped") && !std::exchange(is_next, true)) {
      second = scheduler_at(other.address(), false);
      ASSERT_TRUE(write_address_file(file_, other.address()));
    }
  };
  EXPECT_TRUE(run_worker(options_));
  ASSERT_GE(said_.size(), 2u);
  EXPECT_THAT(said_.front(), HasSubstr("there is no file " + file_.string()));
  EXPECT_TRUE(second) << "the second dismissed it";
}

TEST_F(AddressFile, ThatSaysThatTheRenderHasEndedEndsTheWorker) {
  ASSERT_TRUE(end_address_file(file_, false));
  EXPECT_TRUE(run_worker(options_));
  EXPECT_THAT(said_, testing::ElementsAre(HasSubstr("the render has ended")));
  ASSERT_TRUE(end_address_file(file_, true)) << "another scheduler follows";
  options_.retry_for = 0;
  EXPECT_THAT(error_of(run_worker(options_)), HasSubstr("there is no file"));
}

TEST_F(AddressFile, WithAnythingElseIsWaitedForAndThenAnError) {
  options_.retry_for = 0.1;
  for (const char* text : {"", "\n", "host", "host:", ":7000", "host:70000", "unix:", "a b\nhost:1"}) {
    write_text(file_, text);
    EXPECT_THAT(error_of(run_worker(options_)), HasSubstr("contains no address")) << text;
  }
}

TEST_F(AddressFile, OfAnotherHostNeedsKeys) {
  write_text(file_, "node7:7000\n");
  options_.retry_for = 1e9;
  EXPECT_THAT(error_of(run_worker(options_)), HasSubstr("node7:7000 is another host: give --keys"));
}

TEST_F(WorkerClientTest, WhoIsRefusedDoesNotComeBack) {
  options_.reconnects = true;
  options_.retry_for = 1e9;
  int connections = 0;
  EXPECT_THAT(error_of(run([&](Stream& stream) {
                read(stream);
                ++connections;
                wire::SchedulerMessage message;
                message.mutable_refused()->set_reason("version 98 and version 99");
                stream.Write(message);
              })),
              HasSubstr("version 98 and version 99"));
  EXPECT_EQ(connections, 1);
}

TEST_F(WorkerClientTest, AStatusThatWillNotChangeIsARefusal) {
  options_.reconnects = true;
  options_.retry_for = 1e9;
  for (const auto code : {grpc::StatusCode::UNAUTHENTICATED, grpc::StatusCode::PERMISSION_DENIED}) {
    const ScriptedScheduler scheduler(socket_.address(), [](Stream&) {},
                                      {code, "this token is for watching"});
    EXPECT_THAT(error_of(run_worker(options_)),
                testing::AllOf(HasSubstr("refuses this worker"), HasSubstr("this token is for watching")));
  }
}

TEST(BackOff, GrowsToItsMostAndIsNeverTheSame) {
  BackOff one(100ms, 15s, 1), other(100ms, 15s, 2);
  std::chrono::milliseconds limit = 100ms;
  bool differ = false;
  for (int i = 0; i < 20; ++i) {
    const auto pause = one.next();
    EXPECT_GE(pause, limit / 2);
    EXPECT_LE(pause, limit);
    differ |= pause != other.next();
    limit = std::min<std::chrono::milliseconds>(limit * 2, 15s);
  }
  EXPECT_EQ(limit, 15s);
  EXPECT_TRUE(differ);
  one.reset();
  EXPECT_LE(one.next(), 100ms);
}

TEST_F(WorkerClientTest, ADamagedSceneIsReported) {
  asset_ = fake_scene(100, 80, false).serialize();
  asset_.back() ^= 1;
  is_damaged_ = true;
  std::string said;
  const Expected<void> worked = run([&](Stream& stream) {
    read(stream);
    stream.Write(job_message(scene_hash_));
    said = read(stream).job_failed().message();
  });
  EXPECT_THAT(said, HasSubstr("damaged"));
  EXPECT_EQ(error_of(worked), said);
}

TEST_F(WorkerClientTest, ASceneThatIsNoneIsReported) {
  asset_ = {'n', 'o', 'n', 'e'};
  std::string said;
  run([&](Stream& stream) {
    read(stream);
    stream.Write(job_message(in_one_piece(asset_).hash));
    said = read(stream).job_failed().message();
  });
  EXPECT_THAT(said, HasSubstr("the scene that came cannot be used"));
}

TEST_F(WorkerClientTest, ASceneThatIsNotThereIsReported) {
  std::string said;
  run([&](Stream& stream) {
    read(stream);
    stream.Write(job_message("nowhere"));
    said = read(stream).job_failed().message();
  });
  EXPECT_THAT(said, HasSubstr("no such asset"));
}

TEST_F(WorkerClientTest, ADeviceThatCannotBeMadeIsReported) {
  behaviour_.no_device = 1;
  std::string said;
  run([&](Stream& stream) {
    read(stream);
    stream.Write(job_message(scene_hash_));
    said = read(stream).job_failed().message();
  });
  EXPECT_EQ(said, "there is no fake device today");
}

TEST_F(WorkerClientTest, AFailedUnitDoesNotEndTheWorker) {
  behaviour_.fail_at = "4,1,0";
  std::vector<wire::WorkerMessage> answers;
  const Expected<void> worked = run_ready([&](Stream& stream) {
    stream.Write(unit_message(1));
    stream.Write(unit_message(2));
    for (int i = 0; i < 2; ++i) answers.push_back(read(stream));
    stream.Write(dismissal());
  });
  EXPECT_TRUE(worked) << error_of(worked);
  ASSERT_TRUE(answers[0].has_unit_failed());
  EXPECT_EQ(answers[0].unit_failed().message(), "the fake device was told to fail");
  EXPECT_EQ(answers[0].unit_failed().id().tile(), 1u);
  EXPECT_TRUE(answers[1].has_result());
}

TEST_F(WorkerClientTest, KeepsSeveralJobsUntilItIsToldToForgetThem) {
  std::vector<wire::WorkerMessage> answers;
  const Expected<void> worked = run_ready([&](Stream& stream) {
    stream.Write(job_message(scene_hash_, 6));
    EXPECT_EQ(read(stream).ready().job(), 6u);
    for (const JobId job : {5u, 6u, 5u}) stream.Write(unit_message(1, 4, job));
    wire::SchedulerMessage forget;
    forget.mutable_forget()->set_job(5);
    stream.Write(forget);
    for (const JobId job : {5u, 6u}) stream.Write(unit_message(2, 4, job));
    for (int i = 0; i < 5; ++i) answers.push_back(read(stream));
    stream.Write(dismissal());
  });
  EXPECT_TRUE(worked) << error_of(worked);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(answers[std::size_t(i)].has_result()) << i;
    EXPECT_EQ(answers[std::size_t(i)].result().id().job(), i == 1 ? 6u : 5u);
  }
  EXPECT_EQ(answers[3].unit_failed().message(), "a unit came before its job");
  EXPECT_EQ(answers[4].result().id().job(), 6u);
}

TEST_F(WorkerClientTest, AJobThatCannotBeDoneDoesNotEndTheWorker) {
  const Expected<void> worked = run([&](Stream& stream) {
    read(stream);
    stream.Write(job_message("nowhere", 4));
    EXPECT_EQ(read(stream).job_failed().job(), 4u);
    stream.Write(job_message(scene_hash_));
    EXPECT_TRUE(read(stream).has_ready());
    stream.Write(dismissal());
  });
  EXPECT_TRUE(worked) << error_of(worked);
}

TEST_F(WorkerClientTest, OfOlderViewsOfTheSameJobNothingIsRendered) {
  behaviour_.delay_ms = 300;  // so that the view comes before the units' turn
  std::vector<wire::WorkerMessage> answers;
  const Expected<void> worked = run_ready([&](Stream& stream) {
    stream.Write(job_message(scene_hash_, 6));
    read(stream);
    stream.Write(unit_message(1, 4, 6));
    stream.Write(unit_message(2, 4, 5));
    stream.Write(unit_message(3, 4, 6));
    wire::SchedulerMessage view;
    view.mutable_view()->set_job(5);
    view.mutable_view()->set_number(1);
    encode(View{}, *view.mutable_view()->mutable_view());
    stream.Write(view);
    stream.Write(unit_message(4, 4, 5, 1));
    for (int i = 0; i < 3; ++i) answers.push_back(read(stream));
    stream.Write(dismissal());
  });
  EXPECT_TRUE(worked) << error_of(worked);
  std::vector<std::uint32_t> tiles;
  for (const wire::WorkerMessage& answer : answers) tiles.push_back(answer.result().id().tile());
  EXPECT_THAT(tiles, testing::ElementsAre(1u, 3u, 4u));
}

TEST_F(WorkerClientTest, AnExceptionIsAFailedUnit) {
  class Thrower final : public Device {
    [[nodiscard]] std::string description() const override { return "thrower"; }
    Expected<SampleBuffer> render(const RenderUnit&) override { throw std::runtime_error("out of luck"); }
  };
  options_.make_device = [](const DeviceScene&, const DeviceOptions&) -> Expected<std::unique_ptr<Device>> {
    return std::make_unique<Thrower>();
  };
  wire::WorkerMessage answer;
  run_ready([&](Stream& stream) {
    stream.Write(unit_message(1));
    answer = read(stream);
    stream.Write(dismissal());
  });
  EXPECT_EQ(answer.unit_failed().message(), "out of luck");
}

TEST_F(WorkerClientTest, ACompileIsSaidAndWhatCameOfIt) {
  class Compiled final : public Device {
    [[nodiscard]] std::string description() const override { return "compiled"; }
    [[nodiscard]] DevicePreparation preparation() const override {
      return {.kernels = KernelOrigin{.cached = false, .seconds = 2.5, .note = "kept"}, .warnings = {"slow"}};
    }
    Expected<SampleBuffer> render(const RenderUnit&) override { return fail("no"); }
  };
  options_.make_device = [](const DeviceScene&,
                            const DeviceOptions& device) -> Expected<std::unique_ptr<Device>> {
    device.on_compile("an abacus");
    return std::make_unique<Compiled>();
  };
  std::vector<wire::WorkerMessage> said;
  EXPECT_TRUE(run([&](Stream& stream) {
    read(stream);
    wire::SchedulerMessage job = job_message(scene_hash_);
    job.mutable_job()->mutable_device()->set_backend(wire::BACKEND_AUTO);
    stream.Write(job);
    for (int i = 0; i < 2; ++i) said.push_back(read(stream));
    stream.Write(dismissal());
  }));
  EXPECT_EQ(said[0].compiling().device(), "an abacus");
  EXPECT_EQ(said[0].compiling().job(), 5u);
  const Expected<DevicePreparation> decoded = decode(said[1].ready());
  ASSERT_TRUE(decoded);
  const DevicePreparation& preparation = *decoded;
  ASSERT_TRUE(preparation.kernels);
  EXPECT_FALSE(preparation.kernels->cached);
  EXPECT_EQ(preparation.kernels->seconds, 2.5);
  EXPECT_EQ(preparation.kernels->note, "kept");
  EXPECT_THAT(preparation.warnings, testing::ElementsAre("slow"));
}

TEST_F(WorkerClientTest, BackendsTravel) {
  for (const Backend backend : {Backend::kNative, Backend::kOpenCl, Backend::kAuto}) {
    wire::DeviceOptions message;
    encode(DeviceOptions{.backend = backend}, message);
    const Expected<DeviceOptions> decoded = decode(message);
    ASSERT_TRUE(decoded);
    EXPECT_EQ(decoded->backend, backend);
    EXPECT_EQ(backend_from_name(backend_name(backend)), backend);
  }
  wire::DeviceOptions unknown;
  encode(DeviceOptions{}, unknown);
  unknown.set_backend(wire::Backend(99));
  EXPECT_FALSE(decode(unknown));
}

TEST_F(WorkerClientTest, ANonsensicalUnitIsAFailedUnit) {
  std::vector<std::string> said;
  run_ready([&](Stream& stream) {
    for (const int width : {0, -1, kMaxTile + 1}) {
      stream.Write(unit_message(1, width));
      said.push_back(read(stream).unit_failed().message());
    }
    wire::SchedulerMessage no_samples = unit_message(1);
    no_samples.mutable_unit()->mutable_pixels()->set_sample_count(0);
    stream.Write(no_samples);
    said.push_back(read(stream).unit_failed().message());
    wire::SchedulerMessage no_pixels = unit_message(1);
    no_pixels.mutable_unit()->clear_pixels();
    stream.Write(no_pixels);
    said.push_back(read(stream).unit_failed().message());
    stream.Write(dismissal());
  });
  EXPECT_THAT(said, testing::ElementsAre(HasSubstr("0 x 2 pixels"), HasSubstr("-1 x 2 pixels"),
                                         HasSubstr("2049 x 2 pixels"), HasSubstr("0 samples"),
                                         HasSubstr("of a kind that this program does not know")));
}

TEST_F(WorkerClientTest, ToldToLeaveItSaysSoInTheMiddleOfAUnit) {
  behaviour_.delay_ms = 4000;
  std::stop_source told;
  options_.leave = told.get_token();
  options_.leave_reason = "the queue wants its place back";
  std::chrono::steady_clock::duration taken{};
  wire::WorkerMessage said;
  bool has_ended = false;
  const Expected<void> worked = run_ready([&](Stream& stream) {
    stream.Write(unit_message(1));
    std::this_thread::sleep_for(50ms);
    std::thread teller([&] {
      const auto begin = std::chrono::steady_clock::now();
      told.request_stop();
      taken = std::chrono::steady_clock::now() - begin;
    });
    said = read(stream);
    wire::WorkerMessage more;
    while (stream.Read(&more)) EXPECT_TRUE(more.has_beat());
    has_ended = true;
    teller.join();
  });
  EXPECT_TRUE(worked) << error_of(worked);
  EXPECT_EQ(said.leaving().reason(), "the queue wants its place back");
  EXPECT_TRUE(has_ended);
  EXPECT_LT(taken, 3s) << "it waited for the unit";
}

TEST_F(WorkerClientTest, ABrokenConnectionIsNoticedInTheMiddleOfAUnit) {
  behaviour_.delay_ms = 4000;
  std::promise<std::chrono::steady_clock::time_point> noticed;
  options_.on_connection_lost = [&](const Error&) { noticed.set_value(std::chrono::steady_clock::now()); };
  std::chrono::steady_clock::time_point left;
  run_ready([&](Stream& stream) {
    stream.Write(unit_message(1));
    std::this_thread::sleep_for(50ms);
    left = std::chrono::steady_clock::now();
  });
  EXPECT_LT(noticed.get_future().get() - left, 3s);
}

TEST_F(WorkerClientTest, AResultLeavesWhileTheNextUnitIsRendered) {
  behaviour_.delay_ms = 1000;
  std::chrono::steady_clock::time_point first, second;
  run_ready([&](Stream& stream) {
    stream.Write(unit_message(1));
    stream.Write(unit_message(2));
    read(stream);
    first = std::chrono::steady_clock::now();
    read(stream);
    second = std::chrono::steady_clock::now();
    stream.Write(dismissal());
  });
  EXPECT_GT(second - first, 50ms) << "the first result waited for the second unit";
}

}  // namespace
}  // namespace penumbra
