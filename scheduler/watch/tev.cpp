#include "scheduler/watch/tev.h"

#include <fmt/format.h>
#include <netdb.h>
#include <sys/socket.h>

#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <future>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "kernels/host/owned_descriptor.h"

namespace penumbra {
namespace {

using Names = std::vector<std::string>;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

// How often a waiting stream checks for a stop request.
constexpr milliseconds kStopInterval{20};

// A dot separates a layer from its channel.
const Names kRadiance{"R", "G", "B"};
const Names kDifference{"difference.R", "difference.G", "difference.B"};
const Names kStandardError{"standard_error.Y"};

/// A message to tev: its length in bytes (including the length itself), an operation and its arguments.
/// Numbers are little-endian, texts end with a 0 byte. tev does not answer.
class Packet {
 public:
  /// Creates a blank image, or replaces the one of the same name.
  static Packet create_image(const std::string& name, const WatchedJob& job, const Names& channels,
                             bool grab_focus) {
    Packet packet(4);
    packet.add(std::uint8_t(grab_focus));
    packet.add(name);
    packet.add(std::int32_t(job.film_width));
    packet.add(std::int32_t(job.film_height));
    packet.add(channels);
    return packet;
  }
  /// Replaces the pixels of a tile in some channels. All values of a pixel are adjacent.
  static Packet update_image(const std::string& name, const TileSnapshot& tile, const Names& channels,
                             const std::vector<float>& values) {
    Packet packet(6);                 // the third version of the operation
    packet.add(std::uint8_t(false));  // do not grab the focus
    packet.add(name);
    packet.add(channels);
    for (const int value : {tile.x, tile.y, tile.width, tile.height}) packet.add(std::int32_t(value));
    const auto count = std::int64_t(channels.size());
    for (std::int64_t channel = 0; channel < count; ++channel) packet.add(channel);  // offsets in `values`
    for (std::int64_t channel = 0; channel < count; ++channel) packet.add(count);    // strides
    packet.append(values.data(), values.size() * sizeof(float));
    return packet;
  }
  std::span<const std::uint8_t> bytes() {
    const auto length = std::uint32_t(bytes_.size());
    std::memcpy(bytes_.data(), &length, sizeof length);
    return bytes_;
  }

 private:
  explicit Packet(std::uint8_t operation) : bytes_{0, 0, 0, 0, operation} {}
  template <typename T>
  requires std::is_integral_v<T>
  void add(T value) { append(&value, sizeof value); }
  void add(const std::string& text) { append(text.c_str(), text.size() + 1); }
  void add(const Names& names) {
    add(std::int32_t(names.size()));
    for (const std::string& name : names) add(name);
  }
  void append(const void* data, std::size_t size) {
    static_assert(std::endian::native == std::endian::little);
    const auto* first = static_cast<const std::uint8_t*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }

  std::vector<std::uint8_t> bytes_;
};

/// Returns a connected socket, or why there is none.
std::expected<OwnedDescriptor, std::string> open_socket(const TevAddress& address) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &found))
    return std::unexpected(::gai_strerror(error));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(found, ::freeaddrinfo);
  int error = 0;
  for (const addrinfo* entry = found; entry != nullptr; entry = entry->ai_next) {
    OwnedDescriptor socket(::socket(entry->ai_family, entry->ai_socktype | SOCK_CLOEXEC, entry->ai_protocol));
    if (socket.get() >= 0 && ::connect(socket.get(), entry->ai_addr, entry->ai_addrlen) == 0) return socket;
    error = errno;
  }
  return std::unexpected(
      fmt::format("{}{}", std::strerror(error), error == ECONNREFUSED ? "; is it running?" : ""));
}

std::string seconds(milliseconds time) {
  return fmt::format("{:g} s", std::chrono::duration<double>(time).count());
}

Expected<OwnedDescriptor> connect(const std::string& text, milliseconds timeout,
                                  const std::stop_token& stop) {
  const auto address = parse_tev_address(text);
  if (!address) return std::unexpected(address.error());
  // A name lookup cannot be interrupted, so a detached thread does it and connects.
  std::packaged_task opening([address = *address] { return open_socket(address); });
  auto opened = opening.get_future();
  std::thread(std::move(opening)).detach();
  const auto deadline = steady_clock::now() + timeout;
  while (opened.wait_for(kStopInterval) != std::future_status::ready)
    if (stop.stop_requested() || steady_clock::now() > deadline)
      return fail(fmt::format("no connection to tev at {}: no answer in {}", text, seconds(timeout)));
  auto socket = opened.get();
  if (!socket) return fail(fmt::format("no connection to tev at {}: {}", text, socket.error()));
  const timeval limit{.tv_sec = timeout.count() / 1000, .tv_usec = timeout.count() % 1000 * 1000};
  ::setsockopt(socket->get(), SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
  return std::move(*socket);
}

}  // namespace

Expected<TevAddress> parse_tev_address(std::string_view text) {
  TevAddress address;
  const auto wrong = [&](std::string_view what) {
    return fail(fmt::format("'{}' is no address of tev: {} (HOST:PORT, by default {}:{})", text, what,
                            TevAddress{}.host, TevAddress{}.port));
  };
  std::string_view host = text;
  std::size_t end = text.size();  // of the host, with its brackets
  if (text.starts_with('[')) {
    if (!text.contains(']')) return wrong("']' is missing");
    end = text.find(']') + 1;
    host = text.substr(1, end - 2);
  } else if (text.contains(':') && text.find(':') == text.rfind(':')) {
    end = text.find(':');
    host = text.substr(0, end);
  }  // several colons without brackets: an IPv6 address without a port
  if (!host.empty()) address.host = host;
  if (end == text.size()) return address;

  address.port = text.substr(end + 1);
  std::uint16_t number = 0;
  const char* last = address.port.data() + address.port.size();
  const auto [rest, error] = std::from_chars(address.port.data(), last, number);
  if (text[end] != ':' || error != std::errc{} || rest != last || number == 0)
    return wrong("a port is a number from 1 to 65535");
  return address;
}

TevStream::TevStream(WatchBoard& board, std::string address, milliseconds timeout)
    : address_(std::move(address)), timeout_(timeout) {
  watcher_.emplace(board);
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void TevStream::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

std::optional<std::string> TevStream::take_problem() {
  const std::lock_guard lock(mutex_);
  return std::exchange(problem_, {});
}

void TevStream::run(const std::stop_token& stop) {
  const Expected<void> streamed = stream(stop);
  if (!streamed || (stop.stop_requested() && !watcher_->at_end())) {
    const std::lock_guard lock(mutex_);
    problem_ = stop.stop_requested()
                   ? fmt::format("tev at {} was too slow to take the whole image", address_)
                   : "tev does not show this render any further: " + streamed.error().message;
  }
  watcher_.reset();  // the board need not keep tiles for it
}

Expected<void> TevStream::stream(const std::stop_token& stop) {
  const Expected<OwnedDescriptor> socket = connect(address_, timeout_, stop);
  if (!socket) return std::unexpected(socket.error());
  const std::stop_callback end_sending(stop, [&] { ::shutdown(socket->get(), SHUT_RDWR); });
  Expected<void> sent;
  const auto send = [&](Packet packet) {
    for (auto left = packet.bytes(); sent && !left.empty();) {
      const ssize_t taken = ::send(socket->get(), left.data(), left.size(), MSG_NOSIGNAL);
      if (taken >= 0) {
        left = left.subspan(std::size_t(taken));
      } else if (errno != EINTR) {
        sent = fail(fmt::format(
            "the connection to tev at {} is lost: {}", address_,
            errno == EAGAIN ? "tev has taken nothing for " + seconds(timeout_) : std::strerror(errno)));
      }
    }
  };

  const WatchedJob job = watcher_->job(kStopInterval).value();
  const std::string name = job.title.empty() ? "penumbra" : job.title;
  Names channels = kRadiance;
  if (job.hybrid) {
    channels.insert(channels.end(), kDifference.begin(), kDifference.end());
    channels.insert(channels.end(), kStandardError.begin(), kStandardError.end());
  }
  bool grab_focus = true;
  while (sent && !stop.stop_requested() && !watcher_->at_end()) {
    const std::optional<WatchItem> item = watcher_->next(kStopInterval);
    if (!item) continue;
    if (std::holds_alternative<WatchView>(*item)) {
      // Later views do not grab the focus: the user turns the camera in another window.
      send(Packet::create_image(name, job, channels, std::exchange(grab_focus, false)));
    } else if (const auto* tile = std::get_if<std::shared_ptr<const TileSnapshot>>(&*item)) {
      send(Packet::update_image(name, **tile, kRadiance, (*tile)->radiance));
      if (job.hybrid) send(Packet::update_image(name, **tile, kDifference, (*tile)->difference));
      if (job.hybrid) send(Packet::update_image(name, **tile, kStandardError, (*tile)->standard_error));
    }
  }
  return sent;
}

}  // namespace penumbra
