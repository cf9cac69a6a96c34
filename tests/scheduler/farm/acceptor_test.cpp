// The second listening address: which connections are kept when many arrive.
#include "scheduler/farm/acceptor.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <charconv>
#include <cstring>
#include <future>

#include "scheduler/farm/access.h"
#include "tests/support/temporary_folder.h"
#include "worker/protocol/mailbox.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

class Descriptor {
 public:
  explicit Descriptor(int descriptor = -1) : descriptor_(descriptor) {}
  Descriptor(Descriptor&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~Descriptor() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  [[nodiscard]] int get() const { return descriptor_; }

 private:
  int descriptor_;
};

Descriptor connect_to(const std::string& address) {
  if (!is_tcp(address)) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    std::strcpy(name.sun_path, unix_path(address).c_str());
    Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    EXPECT_EQ(connect(socket.get(), reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
    return socket;
  }
  std::uint16_t port = 0;
  const std::string_view text = split_address(address).port;
  std::from_chars(text.data(), text.data() + text.size(), port);
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  name.sin_port = htons(port);
  Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  EXPECT_EQ(connect(socket.get(), reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
  return socket;
}

/// As gRPC names it to the other end.
std::string peer_of(const Descriptor& client) {
  sockaddr_in name{};
  socklen_t size = sizeof name;
  getsockname(client.get(), reinterpret_cast<sockaddr*>(&name), &size);
  return "ipv4:127.0.0.1:" + std::to_string(ntohs(name.sin_port));
}

/// Whether the other end has closed it, now or soon.
bool is_closed(const Descriptor& client, std::chrono::milliseconds patience) {
  pollfd entry{client.get(), POLLIN, 0};
  if (poll(&entry, 1, int(patience.count())) <= 0) return false;
  char byte = 0;
  return recv(client.get(), &byte, 1, MSG_DONTWAIT) <= 0;
}

class AcceptorTest : public testing::Test {
 protected:
  void open(const std::string& address, AcceptorLimits limits) {
    auto acceptor = Acceptor::listen(address, limits);
    ASSERT_TRUE(acceptor) << acceptor.error().message;
    acceptor_ = std::move(*acceptor);
    acceptor_->start([this](int descriptor, int) { came_.put(Descriptor(descriptor)); });
  }
  Descriptor come() { return connect_to(acceptor_->address()); }
  Descriptor taken() {
    std::optional<Descriptor> descriptor = came_.take(10s);
    EXPECT_TRUE(descriptor);
    return descriptor ? std::move(*descriptor) : Descriptor();
  }

  TemporaryFolder folder_;
  Mailbox<Descriptor> came_;
  std::unique_ptr<Acceptor> acceptor_;
};

TEST_F(AcceptorTest, ConnectionsWithoutATokenAreClosedAndOthersStay) {
  open("127.0.0.1:0", {.connections = 8, .time_to_show_token = 2s});
  const Descriptor unadmitted = come();
  const Descriptor unadmitted_end = taken();
  const Descriptor admitted = come();
  const Descriptor admitted_end = taken();
  acceptor_->admit(peer_of(admitted));
  EXPECT_TRUE(is_closed(unadmitted, 10s));
  EXPECT_TRUE(is_closed(unadmitted_end, 10s)) << "the receiver is told";
  EXPECT_FALSE(is_closed(admitted, 600ms));
}

TEST_F(AcceptorTest, ANewConnectionReplacesTheOldestUnadmittedOne) {
  open("127.0.0.1:0", {.connections = 3, .time_to_show_token = 1h});
  std::vector<Descriptor> clients, ends;
  for (int i = 0; i < 3; ++i) {
    clients.push_back(come());
    ends.push_back(taken());
  }
  acceptor_->admit(peer_of(clients[0]));
  clients.push_back(come());
  ends.push_back(taken());
  EXPECT_TRUE(is_closed(clients[1], 10s));
  EXPECT_FALSE(is_closed(clients[0], 50ms));
  EXPECT_FALSE(is_closed(clients[2], 50ms));
  for (const Descriptor& client : clients) acceptor_->admit(peer_of(client));
  EXPECT_TRUE(is_closed(come(), 10s)) << "all connections have been admitted";
}

TEST_F(AcceptorTest, AnEndThatTheReceiverClosesMakesRoom) {
  open("127.0.0.1:0", {.connections = 1, .time_to_show_token = 1h});
  for (int i = 0; i < 20; ++i) {
    const Descriptor client = come();
    {
      const Descriptor end = taken();
      acceptor_->admit(peer_of(client));
      EXPECT_FALSE(is_closed(client, 1ms));
      shutdown(end.get(), SHUT_RDWR);  // as gRPC does
    }
    ASSERT_TRUE(is_closed(client, 10s));
  }
}

TEST_F(AcceptorTest, AUnixSocketIsBoundedToo) {
  open("unix:" + (folder_ / "socket").string(), {.connections = 2, .time_to_show_token = 1ms});
  const Descriptor first = come();
  const Descriptor first_end = taken();
  Descriptor second = come();
  Descriptor second_end = taken();
  EXPECT_TRUE(is_closed(come(), 10s));
  EXPECT_FALSE(is_closed(first, 50ms)) << "its file's rights are what lets it in";
  second = Descriptor();
  Descriptor third;
  do {  // when the end of the second is noticed
    third = come();
  } while (is_closed(third, 50ms));
}

TEST_F(AcceptorTest, AUnixSocketIsItsOwnersWhateverTheUmask) {
  const mode_t before = umask(0);
  const std::string path = (folder_ / "socket").string();
  open("unix:" + path, {});
  umask(before);
  struct stat status {};
  ASSERT_EQ(stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
  acceptor_.reset();
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_F(AcceptorTest, WhatIsNoSocketIsNotReplaced) {
  const std::string path = (folder_ / "letter.txt").string();
  Descriptor file(::open(path.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600));
  const auto acceptor = Acceptor::listen("unix:" + path);
  ASSERT_FALSE(acceptor);
  EXPECT_THAT(acceptor.error().message, AllOf(HasSubstr(path), HasSubstr("in use")));
  EXPECT_TRUE(std::filesystem::exists(path));
  const auto too_long = Acceptor::listen("unix:/tmp/" + std::string(200, 'x'));
  ASSERT_FALSE(too_long);
  EXPECT_THAT(too_long.error().message, HasSubstr("too long"));
}

}  // namespace
}  // namespace penumbra
