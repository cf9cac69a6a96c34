// A fake tev: it takes what a client sends and decodes it by the protocol's description.
#pragma once

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "kernels/host/owned_descriptor.h"

namespace penumbra {

/// A socket of the loopback device. Without a call of `accept` it is like a tev that hangs.
struct Listener {
  static constexpr int kClosed = -1;  ///< a backlog: connections are refused

  explicit Listener(int backlog = 5) : socket(::socket(AF_INET, SOCK_STREAM, 0)) {
    auto* any = reinterpret_cast<sockaddr*>(&address);
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(socket.get(), any, size), 0);
    if (backlog != kClosed) EXPECT_EQ(::listen(socket.get(), backlog), 0);
    EXPECT_EQ(::getsockname(socket.get(), any, &size), 0);
  }
  [[nodiscard]] std::string host() const { return fmt::format("127.0.0.1:{}", ntohs(address.sin_port)); }
  /// The next connection; none if there is none in time.
  [[nodiscard]] OwnedDescriptor accept() const {
    pollfd entry{socket.get(), POLLIN, 0};
    return OwnedDescriptor(::poll(&entry, 1, 20000) > 0 ? ::accept(socket.get(), nullptr, nullptr) : -1);
  }

  OwnedDescriptor socket;
  sockaddr_in address{};
};

/// Takes all bytes of one connection.
class FakeTev {
 public:
  FakeTev() : thread_([this] { serve(); }) {}
  [[nodiscard]] std::string host() const { return listener_.host(); }
  /// What was sent, once the client has closed the connection.
  std::vector<std::uint8_t> bytes() {
    thread_.join();
    return bytes_;
  }

 private:
  void serve() {
    const OwnedDescriptor connection = listener_.accept();
    std::vector<std::uint8_t> buffer(65536);
    while (true) {
      const ssize_t count = ::recv(connection.get(), buffer.data(), buffer.size(), 0);
      if (count <= 0) return;
      bytes_.insert(bytes_.end(), buffer.begin(), buffer.begin() + count);
    }
  }

  Listener listener_;
  std::vector<std::uint8_t> bytes_;
  std::jthread thread_;
};

/// What tev shows after these bytes.
class Shown {
 public:
  explicit Shown(std::vector<std::uint8_t> bytes) : bytes_(std::move(bytes)) {
    while (at_ < bytes_.size()) {
      const std::size_t end = at_ + number<std::uint32_t>();
      const int operation = number<std::uint8_t>();
      if (operation == 4) {
        create();
      } else if (operation == 6) {
        update(end);
      } else {
        ADD_FAILURE() << "operation " << operation;
      }
      if (at_ != end) {
        ADD_FAILURE() << "a packet's length is wrong";
        return;
      }
    }
  }

  int images = 0, width = 0, height = 0;
  std::vector<bool> grabs;
  std::string name;
  std::vector<std::string> channels;
  std::map<std::string, std::map<std::pair<int, int>, float>> pixels;  ///< by channel and place

 private:
  void create() {
    ++images;
    pixels.clear();
    grabs.push_back(number<std::uint8_t>() == 1);
    name = text();
    width = number<std::int32_t>();
    height = number<std::int32_t>();
    channels = texts();
  }
  void update(std::size_t end) {
    EXPECT_EQ(number<std::uint8_t>(), 0) << "tev goes on showing the image that its user has selected";
    EXPECT_EQ(text(), name);
    const std::vector<std::string> updated = texts();
    int area[4];
    for (int& value : area) value = number<std::int32_t>();
    const auto [x, y, w, h] = area;
    std::vector<std::int64_t> offsets, strides;
    for (std::size_t c = 0; c < updated.size(); ++c) offsets.push_back(number<std::int64_t>());
    for (std::size_t c = 0; c < updated.size(); ++c) strides.push_back(number<std::int64_t>());
    std::vector<float> values;
    while (at_ < end) values.push_back(number<float>());
    for (std::size_t c = 0; c < updated.size(); ++c) {
      EXPECT_THAT(channels, testing::Contains(updated[c]));
      auto& channel = pixels[updated[c]];
      for (int p = 0; p < w * h; ++p)
        channel[{x + p % w, y + p / w}] = values.at(std::size_t(offsets[c] + p * strides[c]));
    }
  }
  template <typename T>
  T number() {
    T value{};
    for (std::size_t k = 0; k < sizeof value; ++k)
      reinterpret_cast<std::uint8_t*>(&value)[k] = bytes_.at(at_++);
    return value;
  }
  std::string text() {
    std::string value;
    while (const auto c = char(number<std::uint8_t>())) value += c;
    return value;
  }
  std::vector<std::string> texts() {
    std::vector<std::string> all;
    for (auto count = number<std::int32_t>(); count > 0; --count) all.push_back(text());
    return all;
  }

  std::vector<std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

}  // namespace penumbra
