// Access control, and the addresses on which a scheduler listens.
#include "scheduler/farm/access.h"

#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>

#include <set>

#include "penumbra.grpc.pb.h"
#include "scheduler/farm/private_socket.h"
#include "scheduler/farm/server.h"
#include "tests/scheduler/watch/watched_run.h"
#include "worker/protocol/client.h"
#include "worker/protocol/wire.h"

namespace penumbra {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Pair;

/// An interactive scheduler without workers, on a Unix socket and on a port of this host.
class AccessTest : public testing::Test {
 protected:
  AccessTest() {
    WatchedJob job;
    job.film_width = job.film_height = job.width = job.height = 4;
    job.interactive = true;
    const auto board = std::make_shared<WatchBoard>(1);
    board->describe(job);
    board->show_view({0, view_at(0)});
    board->close();  // a stream ends when all is told
    server_->show_job(1, board, job.interactive);
  }

  /// The status of each call over this address with this token.
  static std::vector<std::pair<std::string, grpc::StatusCode>> codes(const std::string& address,
                                                                     const std::string& token) {
    const auto stub = wire::Farm::NewStub(open_channel(address));
    std::vector<std::pair<std::string, grpc::StatusCode>> all;
    {
      grpc::ClientContext context;
      show_token(context, token);
      const auto stream = stub->Work(&context);
      wire::WorkerMessage hello;
      hello.mutable_hello()->set_protocol_version(kProtocolVersion);
      stream->Write(hello);
      stream->WritesDone();
      wire::SchedulerMessage message;
      while (stream->Read(&message)) {
      }
      all.emplace_back("Work", stream->Finish().error_code());
    }
    {
      grpc::ClientContext context;
      show_token(context, token);
      wire::AssetManifest manifest;
      all.emplace_back("Manifest", stub->Manifest(&context, {}, &manifest).error_code());
    }
    {
      grpc::ClientContext context;
      show_token(context, token);
      const auto reader = stub->Asset(&context, {});
      wire::AssetChunk chunk;
      while (reader->Read(&chunk)) {
      }
      all.emplace_back("Asset", reader->Finish().error_code());
    }
    {
      grpc::ClientContext context;
      show_token(context, token);
      wire::WatchRequest request;
      request.set_protocol_version(kProtocolVersion);
      const auto reader = stub->Watch(&context, request);
      wire::WatchEvent event;
      while (reader->Read(&event)) {
      }
      all.emplace_back("Watch", reader->Finish().error_code());
    }
    {
      grpc::ClientContext context;
      show_token(context, token);
      wire::ControlRequest request;
      request.mutable_want_samples()->set_spp(1);
      wire::ControlReply reply;
      all.emplace_back("Control", stub->Control(&context, request, &reply).error_code());
    }
    return all;
  }

  template <typename T>
  bool next_is() {
    const std::optional<Arrival> arrival = server_->next(kLong);
    return arrival && std::holds_alternative<T>(*arrival);
  }

  PrivateSocket socket_ = PrivateSocket::create().value();
  std::unique_ptr<Server> server_ =
      Server::listen({.address = socket_.address(), .more = "127.0.0.1:0"}).value();
};

TEST_F(AccessTest, OverTcpEveryCallNeedsAToken) {
  const std::string& token = server_->tokens().watch;
  std::string almost = token;
  almost.back() = almost.back() == '0' ? '1' : '0';
  for (const std::string& wrong : {std::string(), std::string("x"), almost, token + "0", token.substr(1)})
    for (const auto& [call, code] : codes(server_->more_address(), wrong))
      EXPECT_EQ(code, grpc::StatusCode::UNAUTHENTICATED) << call << " with '" << wrong << "'";
  EXPECT_FALSE(server_->next(std::chrono::milliseconds(20))) << "the render must not hear of any of them";
}

TEST_F(AccessTest, WhoMayWatchIsNoWorkerAndTheOtherWayRound) {
  using grpc::StatusCode;
  const auto [watch, work, submit] = server_->tokens();
  EXPECT_NE(watch, work);
  EXPECT_THAT(codes(server_->more_address(), watch),
              ElementsAre(Pair("Work", StatusCode::PERMISSION_DENIED),
                          Pair("Manifest", StatusCode::NOT_FOUND), Pair("Asset", StatusCode::NOT_FOUND),
                          Pair("Watch", StatusCode::OK), Pair("Control", StatusCode::OK)));
  ASSERT_TRUE(next_is<arrivals::SamplesWanted>()) << "not of a worker";
  EXPECT_THAT(codes(server_->more_address(), work),
              ElementsAre(Pair("Work", StatusCode::OK), Pair("Manifest", StatusCode::NOT_FOUND),
                          Pair("Asset", StatusCode::NOT_FOUND), Pair("Watch", StatusCode::PERMISSION_DENIED),
                          Pair("Control", StatusCode::PERMISSION_DENIED)));
  EXPECT_TRUE(next_is<arrivals::Connected>());
  EXPECT_THAT(codes(server_->more_address(), submit),
              ElementsAre(Pair("Work", StatusCode::PERMISSION_DENIED),
                          Pair("Manifest", StatusCode::NOT_FOUND), Pair("Asset", StatusCode::NOT_FOUND),
                          Pair("Watch", StatusCode::OK), Pair("Control", StatusCode::OK)));
}

TEST_F(AccessTest, WhateverElseThereIsNeedsTheTokenForSubmitting) {
  grpc::GenericStub stub(open_channel(server_->more_address()));
  const auto code_of = [&](const std::string& token) {
    grpc::CompletionQueue queue;
    grpc::ClientContext context;
    show_token(context, token);
    grpc::Status status;
    const auto stream = stub.PrepareCall(&context, "/penumbra.v1.Farm/Whatever", &queue);
    stream->StartCall(&context);
    void* tag = nullptr;
    bool ok = false;
    queue.Next(&tag, &ok);
    stream->Finish(&status, &context);
    queue.Next(&tag, &ok);
    return status.error_code();
  };
  EXPECT_EQ(code_of(server_->tokens().watch), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(code_of(server_->tokens().work), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(code_of(server_->tokens().submit), grpc::StatusCode::UNIMPLEMENTED);
}

TEST_F(AccessTest, TheTokenIsLookedAtBeforeAnyMessageHasCome) {
  grpc::GenericStub stub(open_channel(server_->more_address()));
  for (const char* call : {"Work", "Manifest", "Asset", "Watch", "Control"}) {
    grpc::CompletionQueue queue;
    grpc::ClientContext context;
    grpc::Status status;
    const auto stream = stub.PrepareCall(&context, std::string("/penumbra.v1.Farm/") + call, &queue);
    stream->StartCall(&status);
    stream->Finish(&status, &context);
    void* tag = nullptr;
    bool ok = false;
    while (tag != &context && queue.AsyncNext(&tag, &ok, std::chrono::system_clock::now() + kLong) ==
                                  grpc::CompletionQueue::GOT_EVENT) {
    }
    EXPECT_EQ(tag, &context) << call << ": no message was sent, none is to be waited for";
    EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAUTHENTICATED) << call;
    context.TryCancel();
    queue.Shutdown();
    while (queue.Next(&tag, &ok)) {
    }
  }
}

TEST_F(AccessTest, LargeMessagesAreRefused) {
  constexpr std::size_t kHuge = std::size_t(300) << 20;
  wire::ControlRequest request;
  request.mutable_change_view()->mutable_camera()->Resize(int(kHuge / sizeof(float)), 0);
  const auto stub = wire::Farm::NewStub(open_channel(server_->more_address()));
  const auto send = [&](const std::string& token, grpc_compression_algorithm algorithm) {
    grpc::ClientContext context;
    show_token(context, token);
    context.set_compression_algorithm(algorithm);
    wire::ControlReply reply;
    return stub->Control(&context, request, &reply).error_code();
  };
  const std::string& token = server_->tokens().watch;
  EXPECT_EQ(send("", GRPC_COMPRESS_NONE), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_EQ(send("", GRPC_COMPRESS_GZIP), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_EQ(send(token, GRPC_COMPRESS_NONE), grpc::StatusCode::RESOURCE_EXHAUSTED) << "too large";
  EXPECT_EQ(send(token, GRPC_COMPRESS_GZIP), grpc::StatusCode::UNIMPLEMENTED) << "small until it is unpacked";
  EXPECT_FALSE(server_->next(std::chrono::milliseconds(20)));
}

TEST_F(AccessTest, OverTheUnixSocketNoneIsNeeded) {
  for (const std::string token : {"", "whatever"})
    for (const auto& [call, code] : codes(socket_.address(), token))
      EXPECT_EQ(code,
                call == "Asset" || call == "Manifest" ? grpc::StatusCode::NOT_FOUND : grpc::StatusCode::OK)
          << call;
}

TEST_F(AccessTest, TheClientShowsItsTokenAndIsRefusedWithoutInWords) {
  Onlooker with(server_->more_address(), server_->tokens().watch);
  EXPECT_TRUE(with.sees([&] { return with.losses > 0 || with.ended || !with.refused.empty(); }));
  EXPECT_EQ(with.refused, "cannot fetch the scene : there is no asset ''") << "it was let in";
  Onlooker without(server_->more_address());
  EXPECT_TRUE(without.sees([&] { return !without.refused.empty(); }));
  EXPECT_THAT(without.refused, HasSubstr("the token is missing or wrong"));
  Onlooker as_worker(server_->more_address(), server_->tokens().work);
  EXPECT_TRUE(as_worker.sees([&] { return !as_worker.refused.empty(); }));
  EXPECT_THAT(as_worker.refused, HasSubstr("this token is for workers"));
}

TEST_F(AccessTest, AnotherProtocolVersionIsRefusedWithTheReason) {
  const auto stub = wire::Farm::NewStub(open_channel(socket_.address()));
  grpc::ClientContext context;
  wire::WatchRequest request;
  request.set_protocol_version(kProtocolVersion - 1);
  const auto reader = stub->Watch(&context, request);
  wire::WatchEvent event;
  ASSERT_TRUE(reader->Read(&event));
  ASSERT_TRUE(event.has_refused());
  EXPECT_THAT(event.refused().reason(),
              HasSubstr("protocol version " + std::to_string(kProtocolVersion - 1)));
  EXPECT_FALSE(reader->Read(&event));
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::FAILED_PRECONDITION);
}

TEST_F(AccessTest, PortZeroPicksOneThatIsNamed) {
  ASSERT_THAT(server_->more_address(), MatchesRegex("127\\.0\\.0\\.1:[1-9][0-9]*"));
  const PrivateSocket socket = PrivateSocket::create().value();
  const auto other = Server::listen({.address = socket.address(), .more = "localhost:0"});
  ASSERT_TRUE(other) << other.error().message;
  EXPECT_THAT((*other)->more_address(), MatchesRegex("localhost:[1-9][0-9]*"));
  EXPECT_NE((*other)->tokens().watch, server_->tokens().watch);
  EXPECT_NE((*other)->tokens().work, server_->tokens().work);
}

TEST_F(AccessTest, ASocketThatIsListenedAtStaysWithItsOwner) {
  const PrivateSocket first = PrivateSocket::create().value(), second = PrivateSocket::create().value();
  const std::string shared = "unix:" + first.directory() + "/shared";
  auto owner = Server::listen({.address = first.address(), .more = shared});
  ASSERT_TRUE(owner) << owner.error().message;
  const auto other = Server::listen({.address = second.address(), .more = shared});
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message,
              AllOf(HasSubstr(shared), HasSubstr("another process is already listening there")));
  // A socket's file that a process left behind when it died is replaced.
  owner->reset();
  EXPECT_TRUE(Server::listen({.address = second.address(), .more = shared}));
}

TEST_F(AccessTest, ATakenPortIsAnError) {
  const PrivateSocket socket = PrivateSocket::create().value();
  const auto other = Server::listen({.address = socket.address(), .more = server_->more_address()});
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message,
              AllOf(HasSubstr("cannot listen on"), HasSubstr(server_->more_address())));
}

TEST(Access, AnotherUnixSocketNeedsNoToken) {
  const PrivateSocket socket = PrivateSocket::create().value(), more = PrivateSocket::create().value();
  const auto server = Server::listen({.address = socket.address(), .more = more.address()});
  ASSERT_TRUE(server);
  EXPECT_EQ((*server)->more_address(), more.address());
  EXPECT_EQ((*server)->tokens().watch, "");
  EXPECT_EQ((*server)->tokens().work, "");
}

TEST(Access, OnlyThisHostIsListenedOn) {
  for (const char* good :
       {"127.0.0.1:0", "127.0.0.1:65535", "[::1]:7000", "localhost:7000", "unix:/tmp/a", "unix:relative"})
    EXPECT_TRUE(check_listen_address(good)) << good;
  const auto why = [](const std::string& address) {
    const Expected<void> checked = check_listen_address(address);
    return checked ? std::string("accepted") : checked.error().message;
  };
  for (const char* other : {"0.0.0.0:7000", "[::]:7000", "192.168.1.7:7000", "render-node:7000", ":7000",
                            "127.0.0.2:7000", "::1:7000"})
    EXPECT_THAT(why(other), AllOf(HasSubstr("other hosts would be let in without encryption"),
                                  HasSubstr("127.0.0.1:7000"), HasSubstr("ssh -L")));
  for (const char* nonsense : {"localhost", "127.0.0.1:", "127.0.0.1:x", "127.0.0.1:-1", "127.0.0.1:65536",
                               "127.0.0.1:70 ", "127.0.0.1:7x"})
    EXPECT_THAT(why(nonsense), AllOf(HasSubstr(nonsense), HasSubstr("give host and port"))) << nonsense;
  EXPECT_THAT(why("unix:"), HasSubstr("give a path"));
  const PrivateSocket socket = PrivateSocket::create().value();
  const auto server = Server::listen({.address = socket.address(), .more = "0.0.0.0:0"});
  ASSERT_FALSE(server) << "the address is refused even where the caller did not check it";
  EXPECT_THAT(server.error().message, HasSubstr("without encryption"));
}

TEST(Access, TokensAreLongAndNeverTheSame) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) {
    const std::string token = make_token();
    EXPECT_THAT(token, MatchesRegex("[0-9a-f]+"));
    EXPECT_EQ(token.size(), 32u);
    tokens.insert(token);
  }
  EXPECT_EQ(tokens.size(), 100u);
}

}  // namespace
}  // namespace penumbra
