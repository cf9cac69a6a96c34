// A fake tev. It decodes the bytes by the protocol's description, with a decoder of its own.
#pragma once

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace penumbra {

// A hang that is noticed takes the timeout and what a loaded machine adds; nothing near the test's own limit.
inline constexpr std::chrono::milliseconds kTevSoon{20000};

/// Reads one packet's fields in order; throws where bytes are missing.
class Decoder {
 public:
  explicit Decoder(std::vector<std::uint8_t> bytes) : bytes_(std::move(bytes)) {}

  std::uint8_t byte() { return bytes_.at(at_++); }
  std::uint64_t unsigned_integer(int size) {
    std::uint64_t value = 0, place = 1;
    for (int k = 0; k < size; ++k, place *= 256) value += place * byte();
    return value;
  }
  std::int32_t int32() { return std::int32_t(std::uint32_t(unsigned_integer(4))); }
  std::int64_t int64() { return std::int64_t(unsigned_integer(8)); }
  std::string text() {
    std::string value;
    for (char c; (c = char(byte())) != '\0';) value += c;
    return value;
  }
  float number() {
    const auto bits = std::uint32_t(unsigned_integer(4));
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

struct Update {
  bool grab_focus = false;
  std::string name;
  std::vector<std::string> channels;
  int x = 0, y = 0, width = 0, height = 0;
  std::vector<std::int64_t> offsets, strides;
  std::vector<float> values;

  /// As tev reads channel c of pixel p.
  [[nodiscard]] float at(std::size_t c, int p) const {
    return values.at(std::size_t(offsets[c] + p * strides[c]));
  }
};

/// Checks length and operation.
inline Decoder open(const std::vector<std::uint8_t>& packet, int operation) {
  Decoder decoder(packet);
  EXPECT_EQ(decoder.unsigned_integer(4), packet.size());
  EXPECT_EQ(int(decoder.byte()), operation);
  return decoder;
}

inline Update decode_update(const std::vector<std::uint8_t>& packet) {
  Decoder in = open(packet, 6);
  Update update;
  const int focus = in.byte();
  EXPECT_TRUE(focus == 0 || focus == 1);
  update.grab_focus = focus == 1;
  update.name = in.text();
  const int channels = in.int32();
  if (channels < 1 || channels > 100) throw std::runtime_error("channels");
  for (int c = 0; c < channels; ++c) update.channels.push_back(in.text());
  update.x = in.int32();
  update.y = in.int32();
  update.width = in.int32();
  update.height = in.int32();
  for (int c = 0; c < channels; ++c) update.offsets.push_back(in.int64());
  for (int c = 0; c < channels; ++c) update.strides.push_back(in.int64());
  // What tev expects: up to the last value that any channel names, and no more.
  std::int64_t expected = 0;
  for (int c = 0; c < channels; ++c) {
    const std::int64_t last =
        update.offsets[std::size_t(c)] +
        (std::int64_t{update.width} * update.height - 1) * update.strides[std::size_t(c)];
    expected = std::max(expected, last + 1);
  }
  EXPECT_EQ(in.left(), std::size_t(expected) * 4);
  while (in.left() > 0) update.values.push_back(in.number());
  return update;
}

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  Descriptor(const Descriptor&) = delete;
  ~Descriptor() { reset(); }
  void reset() {
    if (value_ >= 0) ::close(std::exchange(value_, -1));
  }
  operator int() const { return value_; }

 private:
  int value_;
};

/// A socket of the loopback device and the port that it has.
struct Listener {
  explicit Listener(int family = AF_INET, int backlog = 5) : socket(::socket(family, SOCK_STREAM, 0)) {
    sockaddr_in v4{};
    v4.sin_family = AF_INET;
    v4.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    sockaddr_in6 v6{};
    v6.sin6_family = AF_INET6;
    v6.sin6_addr = in6addr_loopback;
    const bool six = family == AF_INET6;
    const auto* address =
        six ? reinterpret_cast<const sockaddr*>(&v6) : reinterpret_cast<const sockaddr*>(&v4);
    const socklen_t size = six ? sizeof v6 : sizeof v4;
    if (socket < 0 || ::bind(socket, address, size) != 0) return;
    if (backlog >= 0 && ::listen(socket, backlog) != 0) return;
    sockaddr_storage bound{};
    socklen_t length = sizeof bound;
    if (::getsockname(socket, reinterpret_cast<sockaddr*>(&bound), &length) != 0) return;
    port = ntohs(six ? reinterpret_cast<sockaddr_in6*>(&bound)->sin6_port
                     : reinterpret_cast<sockaddr_in*>(&bound)->sin_port);
  }
  [[nodiscard]] std::string host() const { return fmt::format("127.0.0.1:{}", port); }
  /// The next connection; none if there is none in time.
  [[nodiscard]] int accept() const {
    pollfd entry{socket, POLLIN, 0};
    return ::poll(&entry, 1, int(kTevSoon.count())) > 0 ? ::accept(socket, nullptr, nullptr) : -1;
  }
  Descriptor socket;
  std::uint16_t port = 0;  ///< 0: it did not work
};

/// Takes packets of one connection, at most `chunk` bytes at a time, until the client closes it.
class FakeTev {
 public:
  explicit FakeTev(std::size_t chunk = 65536, int family = AF_INET) : listener_(family), chunk_(chunk) {
    if (listener_.port != 0) thread_ = std::thread([this] { serve(); });
  }
  ~FakeTev() {
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] const Listener& listener() const { return listener_; }

  /// After the client is gone.
  std::vector<std::vector<std::uint8_t>> packets() {
    thread_.join();
    EXPECT_TRUE(rest_.empty()) << rest_.size() << " bytes of an unfinished packet";
    return std::move(packets_);
  }

 private:
  void serve() {
    const Descriptor connection(listener_.accept());
    if (connection < 0) return;
    std::vector<std::uint8_t> buffer(chunk_);
    while (true) {
      const ssize_t count = ::recv(connection, buffer.data(), buffer.size(), 0);
      if (count <= 0) return;
      rest_.insert(rest_.end(), buffer.begin(), buffer.begin() + count);
      while (rest_.size() >= 4) {
        const std::size_t length = rest_[0] + 256u * rest_[1] + 65536u * rest_[2] + 16777216u * rest_[3];
        if (length < 5 || rest_.size() < length) break;
        packets_.emplace_back(rest_.begin(), rest_.begin() + std::ptrdiff_t(length));
        rest_.erase(rest_.begin(), rest_.begin() + std::ptrdiff_t(length));
      }
    }
  }

  Listener listener_;
  std::size_t chunk_;
  std::vector<std::uint8_t> rest_;
  std::vector<std::vector<std::uint8_t>> packets_;
  std::thread thread_;
};

}  // namespace penumbra
