// Clients that are slow, many, silent or send invalid messages, against a real scheduler over its sockets.
// PENUMBRA_SECURITY_CONNECTIONS is the number of connections. PENUMBRA_SECURITY_MUTATIONS is a hundred times
// the number of messages.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <grpcpp/generic/generic_stub.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <thread>

#include "penumbra.grpc.pb.h"
#include "scheduler/farm/private_socket.h"
#include "scheduler/farm/server.h"
#include "scheduler/watch/watch_client.h"
#include "tests/scheduler/security/mutation.h"
#include "tests/scheduler/security/preview_process.h"
#include "tests/support/fake_samples.h"
#include "worker/protocol/client.h"
#include "worker/protocol/unit_result.h"

namespace penumbra::hostile_client_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr auto kLong = 30s;
// Connections of the second address that are kept at once, see AcceptorLimits.
constexpr int kKept = 64;
// Of resident memory, KiB: what gRPC and the allocator keep for connections of before.
constexpr long kSlack = 16 << 10;

int number(const char* variable, int otherwise) {
  const char* wanted = std::getenv(variable);
  return wanted == nullptr ? otherwise : std::atoi(wanted);
}

/// Connections that say a few bytes, of which each is another wrong beginning, and then nothing.
class Wave {
 public:
  Wave(int port, int count) {
    const std::vector<std::string> beginnings = {
        "",                                                      // nothing
        "GET / HTTP/1.1\r\n\r\n",                                // a browser
        "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",                      // gRPC without TLS
        std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc", 9),  // half of a hello of TLS
        std::string("\x16\x03\x01\xff\xff", 5) + std::string(1000, '\xff'),
        std::string("\x15\x03\x03\x00\x02\x02\x28", 7)};  // an alert
    sockaddr_in name{};
    name.sin_family = AF_INET;
    name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    name.sin_port = htons(std::uint16_t(port));
    for (int i = 0; i < count; ++i) {
      const int one = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      if (one < 0) break;
      descriptors_.push_back(one);
      if (connect(one, reinterpret_cast<const sockaddr*>(&name), sizeof name) != 0) continue;
      const std::string& text = beginnings[std::size_t(i) % beginnings.size()];
      [[maybe_unused]] const ssize_t sent = send(one, text.data(), text.size(), MSG_NOSIGNAL);
    }
  }
  Wave(const Wave&) = delete;
  Wave& operator=(const Wave&) = delete;
  ~Wave() {
    for (const int descriptor : descriptors_) close(descriptor);
  }
  /// Those that the other end has not closed.
  [[nodiscard]] std::ptrdiff_t kept() const {
    std::vector<pollfd> entries;
    for (const int descriptor : descriptors_) entries.push_back({descriptor, POLLRDHUP, 0});
    return std::ptrdiff_t(entries.size()) - poll(entries.data(), entries.size(), 0);
  }
  [[nodiscard]] std::size_t size() const { return descriptors_.size(); }

 private:
  std::vector<int> descriptors_;
};

bool is_served(const std::string& address, const std::shared_ptr<const Keys>& keys) {
  WatchClient client(address, keys->tokens.watch, keys);
  return eventually(
      [&] {
        for (const WatchNews& news : client.take())
          if (std::holds_alternative<watch_news::Connected>(news)) return true;
        return false;
      },
      kLong);
}

TEST(HostileClient, AThousandConnectionsAreBoundedAndLeaveNothing) {
  const int count = number("PENUMBRA_SECURITY_CONNECTIONS", 1000);
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_max < rlim_t(count) + 200) GTEST_SKIP() << "too few descriptors for so many connections";
  const SchedulerProcess preview({"preview", "s.xml", "--threads", "1"});
  const auto keys = preview.keys(KeyRole::kViewer);
  ASSERT_TRUE(is_served(preview.address, keys));
  const long before = preview.memory();
  std::vector<long> after;
  for (int i = 0; i < 4; ++i) {
    const Wave wave(preview.port, count);
    ASSERT_EQ(wave.size(), std::size_t(count));
    EXPECT_TRUE(eventually([&] { return wave.kept() <= kKept; }, kLong)) << wave.kept();
    EXPECT_TRUE(is_served(preview.address, keys)) << "others are let in all the same";
    after.push_back(preview.memory());
  }
  RecordProperty("KiB before", int(before));
  RecordProperty("KiB after the first", int(after.front()));
  RecordProperty("KiB after the last", int(after.back()));
  EXPECT_LT(after.front(), before + 2 * kSlack);
  EXPECT_LT(after.back(), after.front() + kSlack) << "flat";
}

/// Watch calls of which nothing is read.
class SilentWatchers {
 public:
  SilentWatchers(const std::string& address, int count, const std::shared_ptr<const Keys>& keys) {
    for (int i = 0; i < count; ++i) {
      stubs_.push_back(wire::Farm::NewStub(open_channel(address, keys.get())));
      contexts_.push_back(std::make_unique<grpc::ClientContext>());
      if (keys) show_token(*contexts_.back(), keys->tokens.watch);
      wire::WatchRequest request;
      request.set_protocol_version(kProtocolVersion);
      readers_.push_back(stubs_.back()->Watch(contexts_.back().get(), request));
    }
  }
  SilentWatchers(const SilentWatchers&) = delete;
  SilentWatchers& operator=(const SilentWatchers&) = delete;
  ~SilentWatchers() {
    for (const auto& one : contexts_) one->TryCancel();
    for (const auto& reader : readers_) reader->Finish();
  }

 private:
  std::vector<std::unique_ptr<wire::Farm::Stub>> stubs_;
  std::vector<std::unique_ptr<grpc::ClientContext>> contexts_;
  std::vector<std::unique_ptr<grpc::ClientReader<wire::WatchEvent>>> readers_;
};

constexpr int kSilent = 20;

TEST(HostileClient, AWindowOfThisUserThatIsStoppedDelaysNothing) {
  SchedulerProcess render({"render", "s.xml", "--threads", "1", "--spp", "60000", "--pass", "50"});
  const std::string text = file_contents(render.folder / ".stderr");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(text, found, std::regex("--connect (unix:\\S+)"))) << text;
  const SilentWatchers watchers(found[1], kSilent, nullptr);
  const ProgramResult result = render.program->wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST(HostileClient, WhoNeverReadsDelaysNothing) {
  SchedulerProcess render({"render", "s.xml", "--threads", "1", "--spp", "60000", "--pass", "50"});
  const auto viewer = render.keys(KeyRole::kViewer), worker = render.keys(KeyRole::kWorker);
  const SilentWatchers watchers(render.address, kSilent, viewer);
  // A worker that takes a unit and is not heard of again.
  const auto stub = wire::Farm::NewStub(open_channel(render.address, worker.get()));
  grpc::ClientContext context;
  show_token(context, worker->tokens.work);
  const auto stream = stub->Work(&context);
  wire::WorkerMessage hello;
  hello.mutable_hello()->set_protocol_version(kProtocolVersion);
  for (const wire::Isa isa : {wire::ISA_SSE2, wire::ISA_AVX2, wire::ISA_AVX512})
    hello.mutable_hello()->add_isas(isa);
  EXPECT_TRUE(stream->Write(hello));
  std::this_thread::sleep_for(500ms);
  const long before = render.memory();
  std::this_thread::sleep_for(1s);
  EXPECT_LT(render.memory(), before + kSlack) << "what is not read is not kept";
  const ProgramResult result = render.program->wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  context.TryCancel();
  stream->Finish();
}

/// Raw bytes as messages of a call.
class RawCalls {
 public:
  explicit RawCalls(const std::string& address) : stub_(open_channel(address)) {}

  /// The status that the call ends with; DEADLINE_EXCEEDED if it does not.
  grpc::StatusCode call(const std::string& name, const std::string& token,
                        const std::vector<std::string>& messages) {
    grpc::CompletionQueue queue;
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kLong);
    show_token(context, token);
    const auto stream = stub_.PrepareCall(&context, "/penumbra.v1.Farm/" + name, &queue);
    void* tag = nullptr;
    bool ok = false;
    const auto done = [&] { return queue.Next(&tag, &ok) && ok; };
    stream->StartCall(&context);
    bool is_open = done();
    for (const std::string& message : messages) {
      if (!is_open) break;
      const grpc::Slice slice(message);
      stream->Write(grpc::ByteBuffer(&slice, 1), &context);
      is_open = done();
    }
    if (is_open) {
      stream->WritesDone(&context);
      done();
    }
    grpc::ByteBuffer answer;
    do {
      stream->Read(&answer, &context);
    } while (done());
    grpc::Status status;
    stream->Finish(&status, &context);
    done();
    queue.Shutdown();
    while (queue.Next(&tag, &ok)) {
    }
    return status.error_code();
  }

 private:
  grpc::GenericStub stub_;
};

TEST(HostileClient, MutatedMessagesOverASocketEndTheirCallAlone) {
  const PrivateSocket socket = PrivateSocket::create().value();
  const auto server = Server::listen({.address = socket.address(), .more = "127.0.0.1:0"}).value();
  WatchedJob job;
  job.film_width = job.film_height = job.width = job.height = 4;
  job.interactive = true;
  const auto board = std::make_shared<WatchBoard>(1);
  board->describe(job);
  board->show_view({0, {}});
  board->close();
  server->show_job(1, board, true);

  const int count = number("PENUMBRA_SECURITY_MUTATIONS", 100'000) / 100;
  int connected = 0, gone = 0;
  std::jthread drain([&](const std::stop_token& stop) {
    while (const auto arrival = server->next(stop.stop_requested() ? 0ms : 20ms)) {
      connected += std::holds_alternative<arrivals::Connected>(*arrival) ? 1 : 0;
      gone += std::holds_alternative<arrivals::Gone>(*arrival) ? 1 : 0;
      if (const auto* worker = std::get_if<arrivals::Connected>(&*arrival))
        server->send_job(worker->worker, 1, "scene", {});
    }
    while (!stop.stop_requested()) {
      if (const auto arrival = server->next(20ms)) {
        connected += std::holds_alternative<arrivals::Connected>(*arrival) ? 1 : 0;
        gone += std::holds_alternative<arrivals::Gone>(*arrival) ? 1 : 0;
      }
    }
  });
  wire::WorkerMessage hello, ready, result, part;
  hello.mutable_hello()->set_protocol_version(kProtocolVersion);
  hello.mutable_hello()->set_host("node7");
  ready.mutable_ready()->set_job(1);
  ready.mutable_ready()->set_device("native");
  result.mutable_result()->mutable_id()->set_job(1);
  encode(fake_samples({.x = 0, .y = 0, .width = 4, .height = 4, .first_sample = 0, .sample_count = 4},
                      kNoLayers),
         *result.mutable_result());
  part.mutable_part()->mutable_id()->set_job(1);
  part.mutable_part()->set_values(std::string(400, '\1'));
  wire::WatchRequest watch;
  watch.set_protocol_version(kProtocolVersion);
  watch.set_job(1);
  wire::ControlRequest control;
  encode(View{}, *control.mutable_change_view());
  wire::AssetRequest asset;
  asset.set_hash(std::string(64, '0'));
  const Tokens& tokens = server->tokens();
  RawCalls calls(server->more_address());
  Mutator workers({hello.SerializeAsString(), ready.SerializeAsString(), result.SerializeAsString(),
                   part.SerializeAsString()},
                  1),
      watchers({watch.SerializeAsString()}, 2), controls({control.SerializeAsString()}, 3),
      assets({asset.SerializeAsString()}, 4);
  std::map<grpc::StatusCode, int> codes;
  for (int i = 0; i < count; ++i) {
    ++codes[i % 2 == 0 ? calls.call("Work", tokens.work, {workers.next()})
                       : calls.call("Work", tokens.work,
                                    {hello.SerializeAsString(), workers.next(), workers.next()})];
    ++codes[calls.call("Control", tokens.watch, {controls.next()})];
    ++codes[calls.call("Asset", tokens.work, {assets.next()})];
    ++codes[calls.call("Watch", tokens.watch, {watchers.next()})];
  }
  EXPECT_EQ(codes[grpc::StatusCode::DEADLINE_EXCEEDED], 0) << "nothing hangs";
  EXPECT_EQ(codes[grpc::StatusCode::UNAVAILABLE], 0) << "no connection is lost";
  EXPECT_GT(codes[grpc::StatusCode::INVALID_ARGUMENT], 0);
  EXPECT_GT(codes[grpc::StatusCode::NOT_FOUND], 0);
  EXPECT_EQ(calls.call("Work", tokens.work, {hello.SerializeAsString()}), grpc::StatusCode::OK);
  std::this_thread::sleep_for(100ms);
  drain.request_stop();
  drain.join();
  EXPECT_GT(connected, 0);
  EXPECT_EQ(connected, gone) << "each of them once";
}

TEST(HostileClient, NamesOfAssetsAreNoPaths) {
  const PrivateSocket socket = PrivateSocket::create().value();
  const auto server = Server::listen({.address = socket.address()}).value();
  const auto stub = wire::Farm::NewStub(open_channel(socket.address()));
  for (const std::string& name :
       {std::string("../../etc/passwd"), std::string("/etc/passwd"), std::string("/proc/self/environ"),
        std::string("..%2f..%2fetc%2fpasswd"), std::string("a\0b", 3), std::string(1 << 16, '/')}) {
    grpc::ClientContext context;
    wire::AssetRequest request;
    request.set_hash(name);
    const auto reader = stub->Asset(&context, request);
    wire::AssetChunk chunk;
    EXPECT_FALSE(reader->Read(&chunk));
    const grpc::Status status = reader->Finish();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND) << name.substr(0, 40);
    EXPECT_LT(status.error_message().size(), 400u);
  }
}

}  // namespace
}  // namespace penumbra::hostile_client_test
