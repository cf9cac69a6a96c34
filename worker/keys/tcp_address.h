// Addresses "host:port" in texts.
#pragma once

#include <string>
#include <string_view>

namespace penumbra {

/// Whether the address is "host:port" rather than "unix:path".
bool is_tcp(const std::string& address);

/// The parts before and after the last colon.
struct HostAndPort {
  std::string_view host, port;
};
HostAndPort split_address(std::string_view address);

/// The host without the brackets of "[::1]".
std::string bare_host(std::string_view host);

/// Whether the text is a port's number, 0 to 65535.
bool is_port(std::string_view text);

/// Whether it is the loopback interface: "127.0.0.1", "[::1]" or "localhost".
bool is_loopback(std::string_view host);

/// Replaces the port of "host:0" by the actual one.
std::string with_port(const std::string& address, int port);

}  // namespace penumbra
