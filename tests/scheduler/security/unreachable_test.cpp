// What users read where no scheduler answers.
#include "worker/keys/unreachable.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "kernels/host/owned_descriptor.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;

constexpr auto kTestPatience = 300ms;

/// Listens at a free port, answers each connection with a text (empty: nothing), and keeps it open.
class OtherServer {
 public:
  explicit OtherServer(std::string answer) : answer_(std::move(answer)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(bind(socket_.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
    EXPECT_EQ(listen(socket_.get(), 8), 0);
    socklen_t size = sizeof at;
    getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&at), &size);
    port_ = ntohs(at.sin_port);
    thread_ = std::thread([this] {
      for (;;) {
        OwnedDescriptor connection(accept(socket_.get(), nullptr, nullptr));
        if (connection.get() < 0) return;
        if (!answer_.empty())
          EXPECT_GT(send(connection.get(), answer_.data(), answer_.size(), MSG_NOSIGNAL), 0);
        open_.push_back(std::move(connection));
      }
    });
  }
  OtherServer(const OtherServer&) = delete;
  OtherServer& operator=(const OtherServer&) = delete;
  ~OtherServer() {
    shutdown(socket_.get(), SHUT_RDWR);
    thread_.join();
  }
  [[nodiscard]] std::string address() const { return fmt::format("127.0.0.1:{}", port_); }

 private:
  std::string answer_;
  OwnedDescriptor socket_{::socket(AF_INET, SOCK_STREAM, 0)};
  int port_ = 0;
  std::vector<OwnedDescriptor> open_;
  std::thread thread_;
};

TEST(Unreachable, AnotherProgramIsNoScheduler) {
  const OtherServer web("HTTP/1.0 400 Bad Request\r\n\r\n");
  EXPECT_EQ(why_unreachable(web.address(), nullptr, kTestPatience), "what answers there is no scheduler");
}

TEST(Unreachable, ASilentProgramGivesNoAnswer) {
  const OtherServer silent("");
  EXPECT_EQ(why_unreachable(silent.address(), nullptr, kTestPatience), "nothing answers there in time");
}

TEST(Unreachable, SettingsOfHttp2AreASchedulersAnswer) {
  const OtherServer http2(std::string("\0\0\0\4\0\0\0\0\0", 9));
  EXPECT_EQ(why_unreachable(http2.address(), nullptr, kTestPatience).find("no scheduler"), std::string::npos);
}

TEST(Unreachable, SocketsAreLookedAt) {
  const TemporaryFolder folder;
  const std::string path = (folder / "socket").string(), address = "unix:" + path;
  EXPECT_EQ(why_unreachable(address, nullptr, kTestPatience), kNobodyListens);
  {
    const OwnedDescriptor socket(::socket(AF_UNIX, SOCK_STREAM, 0));
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    std::copy(path.begin(), path.end(), at.sun_path);
    ASSERT_EQ(bind(socket.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
    ASSERT_EQ(listen(socket.get(), 1), 0);
    EXPECT_EQ(why_unreachable(address, nullptr, kTestPatience), "");
  }
  EXPECT_EQ(why_unreachable(address, nullptr, kTestPatience), kNobodyListens) << "of an ended scheduler";
}

}  // namespace
}  // namespace penumbra
