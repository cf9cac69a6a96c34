// Certificates and tokens over TCP: who is accepted, and which message the others get.
#include <gmock/gmock.h>

#include <future>
#include <thread>

#include "kernels/host/process.h"
#include "scheduler/farm/access.h"
#include "scheduler/farm/private_socket.h"
#include "scheduler/farm/server.h"
#include "scheduler/watch/watch_client.h"
#include "tests/scheduler/security/farm_keys.h"
#include "worker/keys/unreachable.h"
#include "worker/protocol/client.h"
#include "worker/protocol/wire.h"
#include "worker/worker_client.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

constexpr auto kLong = 30s;

class TlsTest : public testing::Test {
 protected:
  void listen(std::shared_ptr<const Keys> keys, const std::string& at = "127.0.0.1:0") {
    server_.reset();
    server_ = Server::listen({.address = socket_.address(), .more = at, .keys = std::move(keys)}).value();
    address_ = "127.0.0.1:" + std::string(split_address(server_->more_address()).port);
  }
  /// What a worker with these comes to; it is not heard of but where this is "none".
  std::string worker_error(std::shared_ptr<const Keys> keys, const std::string& token,
                           std::string address = "") {
    WorkerClientOptions options;
    options.address = address.empty() ? address_ : std::move(address);
    options.keys = std::move(keys);
    options.token = token;
    options.retry_for = 0;
    auto worked = std::async(std::launch::async, [&] { return run_worker(options); });
    const auto deadline = std::chrono::steady_clock::now() + kLong;
    bool is_heard = false;
    while (worked.wait_for(0s) != std::future_status::ready && std::chrono::steady_clock::now() < deadline) {
      const auto arrival = server_->next(10ms);
      if (!arrival) continue;
      const auto* connected = std::get_if<arrivals::Connected>(&*arrival);
      is_heard |= connected != nullptr;
      if (connected != nullptr) server_->dismiss(connected->worker, "done");
    }
    const Expected<void> end = worked.get();
    EXPECT_EQ(is_heard, end.has_value());
    return end ? "none" : end.error().message;
  }

  const FarmKeys farm_;
  PrivateSocket socket_ = PrivateSocket::create().value();
  std::unique_ptr<Server> server_;
  std::string address_;
};

TEST_F(TlsTest, WithCertificateAndTokenAWorkerIsLetIn) {
  listen(farm_.server());
  EXPECT_EQ(worker_error(farm_.client(), farm_.tokens.work), "none");
  EXPECT_EQ(why_unreachable(address_, farm_.client().get(), 5s), "");
}

TEST_F(TlsTest, AllAddressesAreListenedAtWithKeysOnly) {
  listen(farm_.server(), "0.0.0.0:0");
  EXPECT_EQ(worker_error(farm_.client(), farm_.tokens.work), "none");
  listen(farm_.server(), "[::]:0");
  EXPECT_EQ(worker_error(farm_.client(), farm_.tokens.work), "none");
  const auto without = Server::listen({.address = socket_.address() + "2", .more = "0.0.0.0:0"});
  ASSERT_FALSE(without);
  EXPECT_THAT(without.error().message, AllOf(HasSubstr("penumbra keys"), HasSubstr("--keys")));
}

TEST_F(TlsTest, TheAddressThatIsToldIsInTheCertificate) {
  const auto told = [&](const std::vector<std::string>& names, const std::string& address) {
    return reachable_address(address, farm_.server(names).get());
  };
  EXPECT_EQ(told({"farm.example", "localhost"}, "0.0.0.0:7000"), "farm.example:7000");
  EXPECT_EQ(told({"localhost", "127.0.0.1", "::1", "farm.example"}, "[::]:7000"), "farm.example:7000");
  EXPECT_EQ(told({"*.no-such.example", "10.9.8.7"}, "0.0.0.0:7000"), "10.9.8.7:7000");
  EXPECT_EQ(told({"fd00::7"}, "0.0.0.0:7000"), "[fd00::7]:7000");
  EXPECT_EQ(told({"localhost", "127.0.0.1"}, "0.0.0.0:7000"), "localhost:7000");
  EXPECT_EQ(told({"farm.example", "127.0.0.1"}, "localhost:7000"), "127.0.0.1:7000");
  EXPECT_EQ(told({"farm.example", "127.0.0.1"}, "127.0.0.1:7000"), "127.0.0.1:7000");
  EXPECT_EQ(told({"farm.example"}, "10.9.8.7:7000"), "farm.example:7000");
  // Names of this host come first, and without keys there is nothing to choose from.
  EXPECT_EQ(told({"farm.example", host_name()}, "0.0.0.0:7000"), host_name() + ":7000");
  EXPECT_EQ(reachable_address("0.0.0.0:7000"), host_name() + ":7000");
  EXPECT_EQ(reachable_address("unix:/a"), "unix:/a");
}

TEST_F(TlsTest, TokensDecideWithinTheFarm) {
  listen(farm_.server());
  EXPECT_THAT(worker_error(farm_.client(), ""), HasSubstr("the token is missing or wrong"));
  EXPECT_THAT(worker_error(farm_.client(), std::string(32, '0')), HasSubstr("the token is missing or wrong"));
  EXPECT_THAT(worker_error(farm_.client(), farm_.tokens.watch),
              AllOf(HasSubstr("this token is for watching"), HasSubstr("penumbra keys")));
}

TEST_F(TlsTest, WithoutTlsNobodyIsLetIn) {
  listen(farm_.server());
  EXPECT_THAT(worker_error(nullptr, farm_.tokens.work), HasSubstr("asks for TLS: give --keys"));
}

TEST_F(TlsTest, ASchedulerWithoutTlsGetsNoToken) {
  listen(nullptr);
  EXPECT_THAT(worker_error(farm_.client(), server_->tokens().work), HasSubstr("does not speak TLS"));
}

TEST_F(TlsTest, ForeignCertificatesAreNotLetIn) {
  const FarmKeys other("penumbra farm other");
  listen(farm_.server());
  EXPECT_THAT(worker_error(other.client(), farm_.tokens.work),
              HasSubstr("the scheduler's certificate is of another authority ('penumbra farm test')"));
  // One that believes this scheduler, with a certificate of the other authority.
  auto mixed = other.client();
  mixed->authority = farm_.client()->authority;
  EXPECT_THAT(worker_error(mixed, farm_.tokens.work),
              AnyOf(HasSubstr("keys are of another"), HasSubstr("does not know the authority")));
}

TEST_F(TlsTest, WithoutACertificateNobodyIsLetIn) {
  listen(farm_.server());
  auto none = farm_.client();
  none->certificate.clear();
  none->key.clear();
  EXPECT_THAT(worker_error(none, farm_.tokens.work), HasSubstr("the scheduler ended the connection"));
}

TEST_F(TlsTest, ExpiredCertificatesAreNotLetIn) {
  listen(farm_.server());
  for (const Validity& validity : {kPast, kFuture})
    EXPECT_THAT(worker_error(farm_.client(validity), farm_.tokens.work),
                AnyOf(HasSubstr("expired"), HasSubstr("the scheduler ended the connection")));
}

TEST_F(TlsTest, ASchedulersCertificateIsNoWorkers) {
  listen(farm_.server());
  EXPECT_THAT(worker_error(farm_.server(), farm_.tokens.work),
              HasSubstr("the scheduler ended the connection"));
}

TEST_F(TlsTest, AWorkersCertificateIsNoSchedulers) {
  auto impostor = farm_.client();
  listen(impostor);
  EXPECT_THAT(worker_error(farm_.client(), farm_.tokens.work),
              HasSubstr("the scheduler's certificate ('penumbra test') is not made for this use"));
}

TEST_F(TlsTest, AnExpiredSchedulerIsNamed) {
  listen(farm_.server({"127.0.0.1"}, kPast));
  EXPECT_THAT(worker_error(farm_.client(), farm_.tokens.work),
              HasSubstr("the scheduler's certificate has expired on"));
}

TEST_F(TlsTest, AnotherHostsCertificateIsNamed) {
  listen(farm_.server({"render1", "10.0.0.7"}));
  EXPECT_THAT(worker_error(farm_.client(), farm_.tokens.work),
              HasSubstr("the scheduler's certificate is for render1, 10.0.0.7, and not for 127.0.0.1"));
  const std::string port(split_address(address_).port);
  EXPECT_THAT(worker_error(farm_.client(), farm_.tokens.work, "localhost:" + port),
              HasSubstr("and not for localhost"));
}

TEST_F(TlsTest, WhoIsNotThereIsNamed) {
  listen(farm_.server());
  server_.reset();
  EXPECT_EQ(why_unreachable(address_, farm_.client().get(), 5s), "nobody listens there");
  EXPECT_THAT(why_unreachable("no-such-host.invalid:7000", farm_.client().get(), 5s),
              HasSubstr("no address of"));
}

TEST_F(TlsTest, AWindowIsToldToo) {
  const FarmKeys other("penumbra farm other");
  listen(farm_.server());
  WatchClient client(address_, farm_.tokens.watch, other.client());
  std::string said;
  const auto deadline = std::chrono::steady_clock::now() + kLong;
  while (said.empty() && std::chrono::steady_clock::now() < deadline) {
    for (const WatchNews& news : client.take())
      if (const auto* text = std::get_if<watch_news::Said>(&news)) said = text->text;
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_THAT(said, HasSubstr("is of another authority"));
}

}  // namespace
}  // namespace penumbra
