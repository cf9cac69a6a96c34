// The names and addresses of this host.
#pragma once

#include <string>
#include <vector>

namespace penumbra {

/// The host's short and full name, and the addresses of all interfaces that are up, except link-local ones.
std::vector<std::string> host_names();

/// "localhost", "127.0.0.1", "::1", for clients that connect through a tunnel.
std::vector<std::string> loopback_names();

}  // namespace penumbra
