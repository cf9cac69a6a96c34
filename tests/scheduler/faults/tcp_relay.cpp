#include "tests/scheduler/faults/tcp_relay.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <deque>
#include <memory>
#include <stdexcept>
#include <utility>

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr int kPollMilliseconds = 2;
constexpr std::size_t kSlowPiece = 4096;
constexpr int kReceiveBuffer = 32 << 10;  // of a connection, so that a slow one is felt by its sender

sockaddr_in loopback(int port) {
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  name.sin_port = htons(std::uint16_t(port));
  return name;
}

bool send_all(int to, const std::string& data) {
  for (std::size_t sent = 0; sent < data.size();) {
    const ssize_t count = send(to, data.data() + sent, data.size() - sent, MSG_NOSIGNAL);
    if (count <= 0) return false;
    sent += std::size_t(count);
  }
  return true;
}

}  // namespace

TcpRelay::TcpRelay(const std::string& target)
    : target_port_(std::stoi(target.substr(target.rfind(':') + 1))) {
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in name = loopback(0);
  socklen_t size = sizeof name;
  setsockopt(listener_, SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer, sizeof kReceiveBuffer);
  if (bind(listener_, reinterpret_cast<sockaddr*>(&name), size) != 0 || listen(listener_, 16) != 0 ||
      getsockname(listener_, reinterpret_cast<sockaddr*>(&name), &size) != 0)
    throw std::runtime_error("no socket for a relay");
  port_ = ntohs(name.sin_port);
  acceptor_ = std::thread([this] { accept_all(); });
}

TcpRelay::~TcpRelay() {
  over_ = true;
  acceptor_.join();
  for (std::thread& thread : threads_) thread.join();
  close(listener_);
}

std::string TcpRelay::address() const { return "127.0.0.1:" + std::to_string(port_); }

void TcpRelay::accept_all() {
  while (!over_) {
    pollfd waiting{.fd = listener_, .events = POLLIN, .revents = 0};
    if (poll(&waiting, 1, kPollMilliseconds) != 1) continue;
    const int client = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    const int server = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const sockaddr_in name = loopback(target_port_);
    if (client < 0 || connect(server, reinterpret_cast<const sockaddr*>(&name), sizeof name) != 0) {
      close(client);
      close(server);
      continue;
    }
    // Whichever ends last closes both.
    const std::shared_ptr<void> both(nullptr, [client, server](void*) { close(client), close(server); });
    threads_.emplace_back([this, client, server, both] { relay(client, server, true); });
    threads_.emplace_back([this, client, server, both] { relay(server, client, false); });
  }
}

void TcpRelay::relay(int from, int to, bool is_up) {
  std::deque<std::pair<Clock::time_point, std::string>> on_the_way;
  char buffer[65536];
  Clock::time_point free_at = Clock::now();  // the slow connection, of what it has taken
  while (!over_) {
    pollfd waiting{.fd = from, .events = POLLIN, .revents = 0};
    const int rate = is_up ? rate_.load() : 0;
    if (rate > 0) std::this_thread::sleep_until(std::min(free_at, Clock::now() + 10ms));
    if (!cut_ && (rate == 0 || free_at <= Clock::now()) && poll(&waiting, 1, kPollMilliseconds) == 1) {
      const ssize_t count = recv(from, buffer, rate > 0 ? kSlowPiece : sizeof buffer, 0);
      if (count <= 0) break;
      if (rate > 0)
        free_at = std::max(free_at, Clock::now()) +
                  std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(count) / rate);
      on_the_way.emplace_back(Clock::now() + std::chrono::milliseconds(delay_ms_),
                              std::string(buffer, std::size_t(count)));
    }
    if (cut_) std::this_thread::sleep_for(2ms);
    for (; !cut_ && !on_the_way.empty() && on_the_way.front().first <= Clock::now(); on_the_way.pop_front())
      if (!send_all(to, on_the_way.front().second)) return;
  }
  shutdown(to, SHUT_RDWR);
  shutdown(from, SHUT_RDWR);
}

}  // namespace penumbra
