// Under which names and addresses this host may be reached.
#pragma once

#include <string>
#include <vector>

namespace penumbra {

/// Its name, short and whole, and the addresses of its interfaces that are up, link-local ones left out.
std::vector<std::string> host_names();

/// "localhost", "127.0.0.1", "::1": for whoever comes through a tunnel.
std::vector<std::string> loopback_names();

}  // namespace penumbra
