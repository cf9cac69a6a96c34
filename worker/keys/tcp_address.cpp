#include "worker/keys/tcp_address.h"

#include <fmt/format.h>

#include <charconv>
#include <system_error>

namespace penumbra {
namespace {

constexpr int kLargestPort = 65535;

}  // namespace

bool is_tcp(const std::string& address) { return !address.empty() && !address.starts_with("unix:"); }

HostAndPort split_address(std::string_view address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string_view::npos) return {address, {}};
  return {address.substr(0, colon), address.substr(colon + 1)};
}

std::string bare_host(std::string_view host) {
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  return std::string(host);
}

bool is_port(std::string_view text) {
  int port = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  return error == std::errc() && end == text.data() + text.size() && port >= 0 && port <= kLargestPort;
}

bool is_loopback(std::string_view host) {
  return host == "127.0.0.1" || host == "[::1]" || host == "localhost";
}

std::string with_port(const std::string& address, int port) {
  return fmt::format("{}:{}", split_address(address).host, port);
}

}  // namespace penumbra
