// A client that sends what a test says, and nothing else.
#pragma once

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <string>
#include <string_view>

#include "kernels/host/owned_descriptor.h"
#include "worker/keys/tcp_address.h"

namespace penumbra {

struct HttpReply {
  int status = 0;  ///< 0: no answer
  std::string head, body;

  /// The value of a header; empty: there is none.
  [[nodiscard]] std::string header(std::string name) const {
    const auto lower = [](std::string text) {
      std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
      return text;
    };
    const std::size_t at = lower(head).find("\r\n" + lower(std::move(name)) + ": ");
    if (at == std::string::npos) return {};
    const std::size_t begin = head.find(": ", at) + 2;
    return head.substr(begin, head.find("\r\n", begin) - begin);
  }
};

class HttpClient {
 public:
  explicit HttpClient(const std::string& address) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in name{};
    name.sin_family = AF_INET;
    name.sin_port = htons(std::uint16_t(std::stoi(std::string(split_address(address).port))));
    name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_connected_ = connect(socket_.get(), reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0;
  }

  [[nodiscard]] bool is_connected() const { return is_connected_; }
  bool send(std::string_view bytes) const {
    return ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) == ssize_t(bytes.size());
  }
  /// What has come once it contains these words, or the connection has ended, or after a long while.
  std::string read_until(std::string_view words) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (text_.find(words) == std::string::npos && std::chrono::steady_clock::now() < until)
      if (!read_some()) break;
    return text_;
  }
  /// Whether the server has ended the connection, or does so within a while.
  bool is_ended() {
    while (read_some()) {
    }
    return is_over_;
  }
  void forget() { text_.clear(); }

  /// Sends a request and reads its answer.
  HttpReply ask(const std::string& request) {
    text_.clear();
    if (!send(request)) return {};
    read_until("\r\n\r\n");
    const std::size_t end = text_.find("\r\n\r\n");
    if (end == std::string::npos) return {};
    HttpReply reply{.head = text_.substr(0, end + 2), .body = text_.substr(end + 4)};
    reply.status = std::stoi(reply.head.substr(9, 3));
    const std::string length = reply.header("Content-Length");
    if (length.empty() || request.starts_with("HEAD")) return reply;
    while (text_.size() < end + 4 + std::stoul(length) && read_some()) {
    }
    reply.body = text_.substr(end + 4);
    return reply;
  }
  /// The same with a whole request of these lines.
  HttpReply get(const std::string& path, const std::string& headers = "", const std::string& method = "GET") {
    return ask(fmt::format("{} {} HTTP/1.1\r\nHost: 127.0.0.1\r\n{}\r\n", method, path, headers));
  }

 private:
  static constexpr int kPatience = 60'000;  // milliseconds

  bool read_some() {
    pollfd entry{socket_.get(), POLLIN, 0};
    if (poll(&entry, 1, kPatience) <= 0) return false;
    char part[4096];
    const ssize_t got = recv(socket_.get(), part, sizeof part, 0);
    is_over_ = got <= 0;
    if (got > 0) text_.append(part, std::size_t(got));
    return got > 0;
  }

  OwnedDescriptor socket_;
  bool is_connected_ = false, is_over_ = false;
  std::string text_;
};

}  // namespace penumbra
