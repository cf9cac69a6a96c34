#include "scheduler/farm/acceptor.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <utility>

#include "scheduler/farm/access.h"
#include "scheduler/farm/unix_socket.h"

namespace penumbra {
namespace {

constexpr int kBacklog = SOMAXCONN;
// Where descriptors are few, connections get their share and the workers the rest.
constexpr rlim_t kShareOfDescriptors = 8;
constexpr int kFewestConnections = 4;
// A connection waits while there is no free descriptor for it.
constexpr std::chrono::milliseconds kPauseWithoutDescriptors{100};

rlim_t descriptor_limit() {
  rlimit limit{};
  return getrlimit(RLIMIT_NOFILE, &limit) == 0 ? limit.rlim_cur : 0;
}

int port_of(const sockaddr_storage& name) {
  if (name.ss_family == AF_INET) return ntohs(reinterpret_cast<const sockaddr_in&>(name).sin_port);
  if (name.ss_family == AF_INET6) return ntohs(reinterpret_cast<const sockaddr_in6&>(name).sin6_port);
  return 0;
}

Error cannot_listen(const std::string& address, const std::string& why) {
  return {fmt::format("cannot listen on {}: {}", address, why)};
}

/// The listening socket, or an errno.
std::expected<int, int> listen_at(const sockaddr* name, socklen_t size) {
  const int descriptor = socket(name->sa_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return std::unexpected(errno);
  const int on = 1;
  if (name->sa_family == AF_UNIX) {
    // On Linux a socket's file gets the mode of its descriptor: there is no moment at which others reach it.
    fchmod(descriptor, S_IRUSR | S_IWUSR);
  } else {
    setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);  // a port of connections that linger
  }
  if (bind(descriptor, name, size) == 0 && listen(descriptor, kBacklog) == 0) return descriptor;
  const int error = errno;
  close(descriptor);
  return std::unexpected(error);
}

std::expected<int, int> listen_unix(const std::string& path) {
  const std::optional<sockaddr_un> name = unix_socket_name(path);
  if (!name) return std::unexpected(ENAMETOOLONG);
  // A socket's file without a listener is left over from a process that died.
  struct stat status {};
  if (lstat(path.c_str(), &status) == 0 && S_ISSOCK(status.st_mode)) unlink(path.c_str());
  return listen_at(reinterpret_cast<const sockaddr*>(&*name), sizeof *name);
}

std::expected<int, int> listen_tcp(const HostAndPort& address) {
  std::uint16_t port = 0;
  std::from_chars(address.port.data(), address.port.data() + address.port.size(), port);
  if (address.host == "[::1]") {
    sockaddr_in6 name{};
    name.sin6_family = AF_INET6;
    name.sin6_addr = in6addr_loopback;
    name.sin6_port = htons(port);
    return listen_at(reinterpret_cast<const sockaddr*>(&name), sizeof name);
  }
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  name.sin_port = htons(port);
  return listen_at(reinterpret_cast<const sockaddr*>(&name), sizeof name);
}

}  // namespace

void raise_descriptor_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == limit.rlim_max) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

Expected<std::unique_ptr<Acceptor>> Acceptor::listen(const std::string& address, AcceptorLimits limits) {
  if (const Expected<void> checked = check_listen_address(address); !checked)
    return std::unexpected(checked.error());
  if (!is_tcp(address) && probe_unix_socket(unix_path(address)) == 0)
    return std::unexpected(cannot_listen(address, "another process is already listening there"));
  const std::expected<int, int> listener =
      is_tcp(address) ? listen_tcp(split_address(address)) : listen_unix(unix_path(address));
  if (!listener) return std::unexpected(cannot_listen(address, std::strerror(listener.error())));
  std::string reachable = address;
  if (is_tcp(address)) {
    sockaddr_storage name{};
    socklen_t size = sizeof name;
    getsockname(*listener, reinterpret_cast<sockaddr*>(&name), &size);
    reachable = with_port(address, port_of(name));
  }
  std::unique_ptr<Acceptor> acceptor(new Acceptor(std::move(reachable), *listener, limits));
  if (acceptor->wake_ < 0) return std::unexpected(cannot_listen(address, "there are no more descriptors"));
  return acceptor;
}

Acceptor::Acceptor(std::string address, int listener, AcceptorLimits limits)
    : address_(std::move(address)),
      listener_(listener),
      limits_{.connections = std::min(
                  limits.connections,
                  int(std::max(descriptor_limit() / kShareOfDescriptors, rlim_t(kFewestConnections)))),
              .time_to_show_token = limits.time_to_show_token},
      is_tcp_(is_tcp(address_)),
      wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

Acceptor::~Acceptor() {
  stop();
  for (const Connection& connection : connections_) close(connection.descriptor);
  close(listener_);
  if (wake_ >= 0) close(wake_);
  if (!is_tcp_) unlink(unix_path(address_).c_str());
}

void Acceptor::start(std::function<void(int, int)> hand_over) {
  hand_over_ = std::move(hand_over);
  thread_ = std::thread([this] { serve(); });
}

void Acceptor::stop() {
  if (!thread_.joinable()) return;
  eventfd_write(wake_, 1);
  thread_.join();
}

void Acceptor::admit(const std::string& peer) {
  if (!is_tcp_) return;
  int port = 0;
  const std::string_view text = split_address(peer).port;
  std::from_chars(text.data(), text.data() + text.size(), port);
  const std::lock_guard lock(mutex_);
  for (Connection& connection : connections_)
    if (connection.port == port) connection.admitted = true;
}

int Acceptor::milliseconds_to_wait() {
  if (!is_tcp_) return -1;
  const auto first = std::ranges::find(connections_, false, &Connection::admitted);
  if (first == connections_.end()) return -1;
  const auto left =
      std::chrono::ceil<std::chrono::milliseconds>(first->since + limits_.time_to_show_token - Clock::now());
  return int(std::max<std::int64_t>(left.count(), 0));
}

void Acceptor::serve() {
  for (;;) {
    std::vector<pollfd> watched{{wake_, POLLIN, 0}, {listener_, POLLIN, 0}};
    int patience = 0;
    {
      const std::lock_guard lock(mutex_);
      for (const Connection& connection : connections_)
        watched.push_back({connection.descriptor, POLLRDHUP, 0});
      patience = milliseconds_to_wait();
    }
    if (poll(watched.data(), watched.size(), patience) < 0) {
      if (errno == EINTR) continue;
      return;
    }
    if (watched[0].revents != 0) return;
    {
      const std::lock_guard lock(mutex_);
      const auto oldest = Clock::now() - limits_.time_to_show_token;
      for (std::size_t i = connections_.size(); i-- > 0;) {
        const bool is_late = is_tcp_ && !connections_[i].admitted && connections_[i].since <= oldest;
        if (watched[i + 2].revents != 0 || is_late) drop(i, is_late);
      }
    }
    if (watched[1].revents != 0) accept_one();
  }
}

void Acceptor::accept_one() {
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  const int descriptor =
      accept4(listener_, reinterpret_cast<sockaddr*>(&name), &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
  const int second = descriptor < 0 ? -1 : fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
  if (second < 0) {
    const bool none_left = errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM;
    if (descriptor >= 0) close(descriptor);
    if (none_left) std::this_thread::sleep_for(kPauseWithoutDescriptors);
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    if (int(connections_.size()) >= limits_.connections) {
      const auto oldest_unadmitted =
          is_tcp_ ? std::ranges::find(connections_, false, &Connection::admitted) : connections_.end();
      if (oldest_unadmitted == connections_.end()) {
        close(second);
        close(descriptor);
        return;
      }
      drop(std::size_t(oldest_unadmitted - connections_.begin()), true);
    }
    connections_.push_back({second, port_of(name), Clock::now(), false});
  }
  const int on = 1;
  if (is_tcp_) setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  hand_over_(descriptor, listener_);
}

/// The receiver's descriptor is closed by the receiver, which notices.
void Acceptor::drop(std::size_t index, bool by_force) {
  if (by_force) shutdown(connections_[index].descriptor, SHUT_RDWR);
  close(connections_[index].descriptor);
  connections_.erase(connections_.begin() + std::ptrdiff_t(index));
}

}  // namespace penumbra
