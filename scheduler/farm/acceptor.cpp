#include "scheduler/farm/acceptor.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
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
constexpr int kFewestConnections = 4;
constexpr rlim_t kMostDescriptors = 1 << 30;  // used if there is no limit
constexpr int kMostUnsent = 512 << 10;        // bytes
// How long a connection waits if there is no free descriptor for it.
constexpr std::chrono::milliseconds kPauseWithoutDescriptors{100};

rlim_t descriptor_limit() {
  rlimit limit{};
  return getrlimit(RLIMIT_NOFILE, &limit) == 0 ? limit.rlim_cur : 0;
}

/// The peer as "address port", from a socket address or from gRPC's "ipv4:127.0.0.1:7000" and
/// "ipv6:%5B::1%5D:7000". IPv4-mapped IPv6 addresses become IPv4. Empty for anything else.
std::string peer_name(const in6_addr& six, int port) {
  char text[INET6_ADDRSTRLEN] = "";
  if (IN6_IS_ADDR_V4MAPPED(&six))
    inet_ntop(AF_INET, six.s6_addr + 12, text, sizeof text);
  else
    inet_ntop(AF_INET6, &six, text, sizeof text);
  return fmt::format("{} {}", text, port);
}

std::string peer_name(const sockaddr_storage& name) {
  if (name.ss_family == AF_INET6) {
    const auto& six = reinterpret_cast<const sockaddr_in6&>(name);
    return peer_name(six.sin6_addr, ntohs(six.sin6_port));
  }
  if (name.ss_family != AF_INET) return "";
  const auto& four = reinterpret_cast<const sockaddr_in&>(name);
  char text[INET_ADDRSTRLEN] = "";
  inet_ntop(AF_INET, &four.sin_addr, text, sizeof text);
  return fmt::format("{} {}", text, ntohs(four.sin_port));
}

std::string peer_name(const std::string& peer) {
  const HostAndPort parts = split_address(peer);
  std::string_view host = parts.host;
  const bool is_six = host.starts_with("ipv6:");
  host.remove_prefix(std::min(host.size(), std::string_view("ipv6:").size()));
  for (const std::string_view bracket : {"%5B", "["})
    if (host.starts_with(bracket)) host.remove_prefix(bracket.size());
  host = host.substr(0, host.find_first_of("%]"));  // also cuts a zone
  if (!is_six) return fmt::format("{} {}", host, parts.port);
  in6_addr six{};
  int port = 0;
  std::from_chars(parts.port.data(), parts.port.data() + parts.port.size(), port);
  return inet_pton(AF_INET6, std::string(host).c_str(), &six) == 1 ? peer_name(six, port) : "";
}

int port_of(const sockaddr_storage& name) {
  if (name.ss_family == AF_INET) return ntohs(reinterpret_cast<const sockaddr_in&>(name).sin_port);
  if (name.ss_family == AF_INET6) return ntohs(reinterpret_cast<const sockaddr_in6&>(name).sin6_port);
  return 0;
}

Error cannot_listen(const std::string& address, const std::string& why) {
  return {fmt::format("cannot listen on {}: {}", address, why)};
}

/// Makes a listening socket, or returns an errno.
std::expected<int, int> listen_at(const sockaddr* name, socklen_t size) {
  const int descriptor = socket(name->sa_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return std::unexpected(errno);
  const int on = 1;
  if (name->sa_family == AF_UNIX) {
    // On Linux the socket's file gets the mode of its descriptor, so at no time can others access it.
    fchmod(descriptor, S_IRUSR | S_IWUSR);
  } else {
    // Allows a port with lingering connections.
    setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  }
  if (bind(descriptor, name, size) == 0 && listen(descriptor, kBacklog) == 0) return descriptor;
  const int error = errno;
  close(descriptor);
  return std::unexpected(error);
}

std::expected<int, std::string> listen_unix(const std::string& path) {
  const std::optional<sockaddr_un> name = unix_socket_name(path);
  if (!name) return std::unexpected(std::strerror(ENAMETOOLONG));
  // A socket's file without a listener was left by a process that died.
  struct stat status {};
  if (lstat(path.c_str(), &status) == 0 && S_ISSOCK(status.st_mode)) unlink(path.c_str());
  const std::expected<int, int> listener = listen_at(reinterpret_cast<const sockaddr*>(&*name), sizeof *name);
  if (!listener) return std::unexpected(std::strerror(listener.error()));
  return *listener;
}

/// Listens on the first address of the name that belongs to this host. "localhost" means IPv4.
std::expected<int, std::string> listen_tcp(const HostAndPort& address) {
  const std::string host = address.host == "localhost" ? "127.0.0.1" : bare_host(address.host);
  addrinfo hints{}, *found = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  if (const int error = getaddrinfo(host.c_str(), std::string(address.port).c_str(), &hints, &found);
      error != 0)
    return std::unexpected(gai_strerror(error));
  std::expected<int, int> listener = std::unexpected(EADDRNOTAVAIL);
  for (const addrinfo* at = found; at != nullptr && !listener; at = at->ai_next)
    listener = listen_at(at->ai_addr, at->ai_addrlen);
  freeaddrinfo(found);
  if (!listener) return std::unexpected(std::strerror(listener.error()));
  return *listener;
}

bool is_loopback_name(const sockaddr_storage& name) {
  if (name.ss_family == AF_INET)
    return (ntohl(reinterpret_cast<const sockaddr_in&>(name).sin_addr.s_addr) >> 24) == IN_LOOPBACKNET;
  return name.ss_family == AF_INET6 &&
         IN6_IS_ADDR_LOOPBACK(&reinterpret_cast<const sockaddr_in6&>(name).sin6_addr) != 0;
}

}  // namespace

void raise_descriptor_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == limit.rlim_max) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

Expected<std::unique_ptr<Acceptor>> Acceptor::listen(const std::string& address, AcceptorLimits limits,
                                                     bool has_keys) {
  if (const Expected<void> checked = check_listen_address(address, has_keys); !checked)
    return std::unexpected(checked.error());
  if (!is_tcp(address) && probe_unix_socket(unix_path(address)) == 0)
    return std::unexpected(cannot_listen(address, "another process is already listening there"));
  const std::expected<int, std::string> listener =
      is_tcp(address) ? listen_tcp(split_address(address)) : listen_unix(unix_path(address));
  if (!listener) return std::unexpected(cannot_listen(address, listener.error()));
  std::string reachable = address;
  if (is_tcp(address)) {
    sockaddr_storage name{};
    socklen_t size = sizeof name;
    getsockname(*listener, reinterpret_cast<sockaddr*>(&name), &size);
    reachable = with_port(address, port_of(name));
    if (is_loopback_name(name) && !is_loopback(split_address(address).host)) {
      close(*listener);
      return std::unexpected(cannot_listen(
          address, fmt::format("that name means this machine alone here; 0.0.0.0:{} listens at all of "
                               "its addresses",
                               split_address(address).port)));
    }
  }
  std::unique_ptr<Acceptor> acceptor(new Acceptor(std::move(reachable), *listener, limits));
  if (acceptor->wake_ < 0) return std::unexpected(cannot_listen(address, "there are no more descriptors"));
  return acceptor;
}

Acceptor::Acceptor(std::string address, int listener, AcceptorLimits limits)
    : address_(std::move(address)),
      listener_(listener),
      limits_{.connections = std::min(limits.connections,
                                      int(std::clamp(descriptor_limit() / rlim_t(limits.share_of_descriptors),
                                                     rlim_t(kFewestConnections), kMostDescriptors))),
              .strangers = limits.strangers,
              .time_to_show_token = limits.time_to_show_token,
              .share_of_descriptors = limits.share_of_descriptors},
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

void Acceptor::admit(const std::string& peer) { admit_named(peer_name(peer)); }

void Acceptor::admit(int descriptor) {
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  if (getpeername(descriptor, reinterpret_cast<sockaddr*>(&name), &size) == 0) admit_named(peer_name(name));
}

void Acceptor::admit_named(const std::string& name) {
  if (!is_tcp_) return;
  const std::lock_guard lock(mutex_);
  for (Connection& connection : connections_)
    if (connection.peer == name) connection.admitted = true;
}

void Acceptor::cut_off() {
  const std::lock_guard lock(mutex_);
  for (const Connection& connection : connections_) shutdown(connection.descriptor, SHUT_RDWR);
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
    const auto strangers = std::ranges::count(connections_, false, &Connection::admitted);
    if (int(connections_.size()) >= limits_.connections || (is_tcp_ && strangers >= limits_.strangers)) {
      const auto oldest_unadmitted =
          is_tcp_ ? std::ranges::find(connections_, false, &Connection::admitted) : connections_.end();
      if (oldest_unadmitted == connections_.end()) {
        close(second);
        close(descriptor);
        return;
      }
      drop(std::size_t(oldest_unadmitted - connections_.begin()), true);
    }
    connections_.push_back({second, peer_name(name), Clock::now(), false});
  }
  const int on = 1;
  if (is_tcp_) {
    setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    // Otherwise the system buffers some MiB for each peer that does not read.
    setsockopt(descriptor, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &kMostUnsent, sizeof kMostUnsent);
  }
  hand_over_(descriptor, listener_);
}

/// The receiver closes its own descriptor when it notices the end.
void Acceptor::drop(std::size_t index, bool by_force) {
  if (by_force) shutdown(connections_[index].descriptor, SHUT_RDWR);
  close(connections_[index].descriptor);
  connections_.erase(connections_.begin() + std::ptrdiff_t(index));
}

}  // namespace penumbra
