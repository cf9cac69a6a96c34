#include "scheduler/watch/tev.h"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <condition_variable>
#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <type_traits>
#include <utility>

#include "kernels/host/owned_descriptor.h"

namespace penumbra {
namespace {

using Milliseconds = std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

enum class Operation : std::uint8_t { kCloseImage = 2, kCreateImage = 4, kUpdateImageV3 = 6 };

/// The bytes of one packet. The length is filled in at the end.
class PacketWriter {
 public:
  explicit PacketWriter(Operation operation) : bytes_{0, 0, 0, 0, static_cast<std::uint8_t>(operation)} {}
  void reserve(std::size_t more) { bytes_.reserve(bytes_.size() + more); }
  void flag(bool value) { bytes_.push_back(value ? 1 : 0); }
  void text(std::string_view value) {
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    bytes_.push_back(0);
  }
  template <typename T>
  void integer(T value) {
    const auto bits = static_cast<std::make_unsigned_t<T>>(value);
    for (std::size_t k = 0; k < sizeof(T); ++k) bytes_.push_back(static_cast<std::uint8_t>(bits >> (8 * k)));
  }
  void floats(std::span<const float> values) {
    static_assert(sizeof(float) == 4);
    if constexpr (std::endian::native == std::endian::little) {
      const auto raw = std::as_bytes(values);
      const auto* first = reinterpret_cast<const std::uint8_t*>(raw.data());
      bytes_.insert(bytes_.end(), first, first + raw.size());
    } else {
      for (const float value : values) integer(std::bit_cast<std::uint32_t>(value));
    }
  }
  Expected<TevPacket> finish() {
    if (bytes_.size() > UINT32_MAX) return fail("a tile of 4 GiB or more cannot be sent to tev");
    const auto length = static_cast<std::uint32_t>(bytes_.size());
    for (std::size_t k = 0; k < sizeof length; ++k) bytes_[k] = static_cast<std::uint8_t>(length >> (8 * k));
    return std::move(bytes_);
  }

 private:
  TevPacket bytes_;
};

std::optional<Error> problem_with(std::string_view text, std::string_view what) {
  if (text.empty()) return Error{fmt::format("{} for tev without a name", what)};
  if (text.contains('\0')) return Error{fmt::format("{} for tev has a byte 0 in its name", what)};
  return std::nullopt;
}

std::optional<Error> problem_with(std::string_view name, std::int32_t width, std::int32_t height,
                                  std::span<const std::string> channels) {
  if (auto error = problem_with(name, "an image")) return error;
  if (width <= 0 || height <= 0)
    return Error{fmt::format("tev cannot show '{}' with {} x {} pixels", name, width, height)};
  if (channels.empty()) return Error{fmt::format("tev cannot show '{}' without channels", name)};
  for (const std::string& channel : channels) {
    if (auto error = problem_with(channel, "a channel")) return error;
  }
  return std::nullopt;
}

// How often a thread that waits for tev checks for a stop request.
constexpr Milliseconds kStopInterval{20};

/// Returns 0, ETIMEDOUT, ECANCELED after a stop request, or the error of poll.
int wait_until_writable(int descriptor, Milliseconds timeout, const std::stop_token& stop) {
  const auto deadline = Clock::now() + timeout;
  while (true) {
    if (stop.stop_requested()) return ECANCELED;
    const auto left = std::chrono::ceil<Milliseconds>(deadline - Clock::now());
    const Milliseconds most = stop.stop_possible() ? kStopInterval : Milliseconds(INT32_MAX);
    pollfd entry{descriptor, POLLOUT, 0};
    const int ready = ::poll(&entry, 1, static_cast<int>(std::clamp(left, Milliseconds(0), most).count()));
    if (ready > 0) return 0;
    if (ready < 0 && errno != EINTR) return errno;
    if (ready == 0 && Clock::now() >= deadline) return ETIMEDOUT;
  }
}

/// Returns a connected non-blocking socket, or an errno.
std::expected<int, int> connect_to(const addrinfo& address, Milliseconds timeout,
                                   const std::stop_token& stop) {
  OwnedDescriptor socket(
      ::socket(address.ai_family, address.ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, address.ai_protocol));
  if (socket.get() < 0) return std::unexpected(errno);
  if (::connect(socket.get(), address.ai_addr, address.ai_addrlen) != 0) {
    if (errno != EINPROGRESS && errno != EINTR) return std::unexpected(errno);
    if (const int error = wait_until_writable(socket.get(), timeout, stop)) return std::unexpected(error);
    int error = 0;
    socklen_t size = sizeof error;
    if (::getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &error, &size) != 0) return std::unexpected(errno);
    if (error != 0) return std::unexpected(error);
  }
  // A tile is one packet without an answer, so delaying packets brings nothing. Failing to set this is not an
  // error.
  const int on = 1;
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return socket.release();
}

/// The result of a name lookup.
struct LookUp {
  LookUp() = default;
  LookUp(const LookUp&) = delete;
  LookUp& operator=(const LookUp&) = delete;
  ~LookUp() {
    if (addresses != nullptr) ::freeaddrinfo(addresses);
  }

  std::mutex mutex;
  std::condition_variable changed;
  bool done = false;
  int error = 0, system_error = 0;
  addrinfo* addresses = nullptr;
};

/// Name lookup has no timeout and cannot be interrupted, so a detached thread does it. Returns null if there
/// is no answer in time, or after a stop request.
std::shared_ptr<const LookUp> look_up(const TevAddress& address, Milliseconds timeout,
                                      const std::stop_token& stop) {
  const auto shared = std::make_shared<LookUp>();
  std::thread([shared, host = address.host, port = std::to_string(address.port)] {
    addrinfo hints{};
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_flags = AI_NUMERICSERV;
    addrinfo* found = nullptr;
    const int error = ::getaddrinfo(host.c_str(), port.c_str(), &hints, &found);
    const int system_error = errno;
    {
      const std::lock_guard lock(shared->mutex);
      shared->error = error;
      shared->system_error = system_error;
      shared->addresses = error == 0 ? found : nullptr;
      shared->done = true;
    }
    shared->changed.notify_all();
  }).detach();
  const auto deadline = Clock::now() + timeout;
  std::unique_lock lock(shared->mutex);
  while (!shared->done && !stop.stop_requested() && Clock::now() < deadline)
    shared->changed.wait_for(lock, kStopInterval);
  return shared->done ? shared : nullptr;
}

std::string describe(const TevAddress& address) {
  return address.host.contains(':') ? fmt::format("[{}]:{}", address.host, address.port)
                                    : fmt::format("{}:{}", address.host, address.port);
}

double seconds(Milliseconds time) { return std::chrono::duration<double>(time).count(); }

}  // namespace

Expected<TevAddress> parse_tev_address(std::string_view host_and_port) {
  const auto wrong = [&](std::string_view what) {
    return fail(fmt::format("'{}' is no address of tev: {} (HOST:PORT, by default {}:{})", host_and_port,
                            what, kTevDefaultHost, kTevDefaultPort));
  };
  std::string_view host = host_and_port, port;
  bool has_port = false;
  if (host.starts_with('[')) {
    const std::size_t close = host.find(']');
    if (close == host.npos) return wrong("']' is missing");
    const std::string_view rest = host.substr(close + 1);
    host = host.substr(1, close - 1);
    if (!rest.empty() && rest[0] != ':') return wrong("a port follows ']' after a colon");
    has_port = !rest.empty();
    port = has_port ? rest.substr(1) : rest;
    if (host.empty()) return wrong("there is nothing between the brackets");
  } else if (const std::size_t colon = host.find(':'); colon != host.npos && colon == host.rfind(':')) {
    has_port = true;
    port = host.substr(colon + 1);
    host = host.substr(0, colon);
  }  // several colons without brackets: an IPv6 address without a port
  if (host.contains('\0')) return wrong("it has a byte 0 in it");
  TevAddress address{std::string(host.empty() ? kTevDefaultHost : host)};
  if (has_port) {
    const auto [end, code] = std::from_chars(port.data(), port.data() + port.size(), address.port);
    if (code != std::errc{} || end != port.data() + port.size() || address.port == 0)
      return wrong("a port is a number from 1 to 65535");
  }
  return address;
}

Expected<TevPacket> encode_create_image(std::string_view name, std::int32_t width, std::int32_t height,
                                        std::span<const std::string> channels, bool grab_focus) {
  if (auto error = problem_with(name, width, height, channels)) return std::unexpected(*error);
  PacketWriter packet(Operation::kCreateImage);
  packet.flag(grab_focus);
  packet.text(name);
  packet.integer(width);
  packet.integer(height);
  packet.integer(static_cast<std::int32_t>(channels.size()));
  for (const std::string& channel : channels) packet.text(channel);
  return packet.finish();
}

Expected<TevPacket> encode_update_tile(std::string_view name, TevTile tile,
                                       std::span<const std::string> channels, std::span<const float> values,
                                       TevLayout layout, bool grab_focus) {
  if (auto error = problem_with(name, tile.width, tile.height, channels)) return std::unexpected(*error);
  if (tile.x < 0 || tile.y < 0)
    return fail(fmt::format("a tile at ({}, {}) is outside of '{}'", tile.x, tile.y, name));
  const auto pixels = std::int64_t{tile.width} * tile.height;
  const auto count = static_cast<std::int64_t>(channels.size());
  // The product of two 31-bit sizes and the number of channels may overflow 64 bits, so divide instead.
  const auto given = static_cast<std::int64_t>(values.size());
  if (given % count != 0 || given / count != pixels) {
    return fail(fmt::format("a tile of {} x {} pixels of '{}' with {} channels has {} values", tile.width,
                            tile.height, name, count, given));
  }
  PacketWriter packet(Operation::kUpdateImageV3);
  packet.reserve(values.size_bytes() + 256);
  packet.flag(grab_focus);
  packet.text(name);
  packet.integer(static_cast<std::int32_t>(count));
  for (const std::string& channel : channels) packet.text(channel);
  for (const std::int32_t value : {tile.x, tile.y, tile.width, tile.height}) packet.integer(value);
  const bool planar = layout == TevLayout::kPlanar;
  // Offsets, counted in values.
  for (std::int64_t c = 0; c < count; ++c) packet.integer(planar ? c * pixels : c);
  // Strides, counted in values.
  for (std::int64_t c = 0; c < count; ++c) packet.integer(planar ? std::int64_t{1} : count);
  packet.floats(values);
  return packet.finish();
}

Expected<TevPacket> encode_close_image(std::string_view name) {
  if (auto error = problem_with(name, "an image")) return std::unexpected(*error);
  PacketWriter packet(Operation::kCloseImage);
  packet.text(name);
  return packet.finish();
}

Expected<TevClient> TevClient::connect(const std::string& host_and_port, Milliseconds timeout,
                                       std::stop_token stop) {
  const auto address = parse_tev_address(host_and_port);
  if (!address) return std::unexpected(address.error());
  const std::string described = describe(*address);

  const std::shared_ptr<const LookUp> found = look_up(*address, timeout, stop);
  if (found == nullptr)
    return fail(fmt::format("no connection to tev at {}: the name service does not answer", described));
  if (found->error != 0) {
    const char* why =
        found->error == EAI_SYSTEM ? std::strerror(found->system_error) : ::gai_strerror(found->error);
    return fail(fmt::format("no connection to tev at {}: {}", described, why));
  }
  int error = 0;
  for (const addrinfo* entry = found->addresses; entry != nullptr; entry = entry->ai_next) {
    const auto socket = connect_to(*entry, timeout, stop);
    if (socket) return TevClient(*socket, described, timeout, std::move(stop));
    error = socket.error();
  }
  if (error == ETIMEDOUT)
    return fail(fmt::format("no connection to tev at {}: no answer in {:g} s", described, seconds(timeout)));
  return fail(fmt::format("no connection to tev at {}: {}{}", described, std::strerror(error),
                          error == ECONNREFUSED ? "; is it running?" : ""));
}

TevClient::TevClient(int socket, std::string address, Milliseconds timeout, std::stop_token stop)
    : socket_(socket), address_(std::move(address)), timeout_(timeout), stop_(std::move(stop)) {}

TevClient::TevClient(TevClient&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)),
      address_(std::move(other.address_)),
      timeout_(other.timeout_),
      stop_(std::move(other.stop_)) {}

TevClient& TevClient::operator=(TevClient&& other) noexcept {
  if (this != &other) {
    close_socket();
    socket_ = std::exchange(other.socket_, -1);
    address_ = std::move(other.address_);
    timeout_ = other.timeout_;
    stop_ = std::move(other.stop_);
  }
  return *this;
}

TevClient::~TevClient() { close_socket(); }

void TevClient::close_socket() {
  if (socket_ >= 0) ::close(std::exchange(socket_, -1));
}

Expected<void> TevClient::create_image(std::string_view name, int width, int height,
                                       std::span<const std::string> channels, bool grab_focus) {
  return send(encode_create_image(name, width, height, channels, grab_focus));
}

Expected<void> TevClient::update_tile(std::string_view name, int x, int y, int width, int height,
                                      std::span<const std::string> channels, std::span<const float> values,
                                      TevLayout layout) {
  return send(encode_update_tile(name, {x, y, width, height}, channels, values, layout));
}

Expected<void> TevClient::close_image(std::string_view name) { return send(encode_close_image(name)); }

Expected<void> TevClient::send(const Expected<TevPacket>& packet) {
  if (!packet) return std::unexpected(packet.error());
  if (socket_ < 0) return fail(fmt::format("the connection to tev at {} is closed", address_));
  auto sent = send_all(*packet);
  // After half a packet, tev would read what follows as the rest of it.
  if (!sent) close_socket();
  return sent;
}

Expected<void> TevClient::send_all(std::span<const std::uint8_t> bytes) {
  const auto lost = [&](std::string_view why) {
    return fail(fmt::format("the connection to tev at {} is lost: {}", address_, why));
  };
  // The first write to a connection that the peer has closed would seem to succeed.
  if (closed_by_peer()) return lost("tev has closed it");
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return lost(std::strerror(errno));
    const int error = wait_until_writable(socket_, timeout_, stop_);
    if (error == ETIMEDOUT) return lost(fmt::format("tev has taken nothing for {:g} s", seconds(timeout_)));
    if (error != 0) return lost(std::strerror(error));
  }
  return {};
}

bool TevClient::closed_by_peer() const {
  // tev never answers. Any bytes that come nevertheless are dropped, because closing a socket with unread
  // bytes would discard data still to be sent. The number of reads is limited, so that a peer that sends
  // endlessly cannot block us.
  char unread[4096];
  for (int reads = 0; reads < 16; ++reads) {
    const ssize_t count = ::recv(socket_, unread, sizeof unread, MSG_DONTWAIT);
    if (count == 0) return true;
    if (count < 0 && errno != EINTR) return errno != EAGAIN && errno != EWOULDBLOCK;
  }
  return false;
}

}  // namespace penumbra
