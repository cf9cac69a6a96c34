// Helpers for Unix sockets given by file paths.
#pragma once

#include <sys/un.h>

#include <optional>
#include <string>

namespace penumbra {

/// The socket address for the path; nothing if the path is too long.
std::optional<sockaddr_un> unix_socket_name(const std::string& path);

/// Tries to connect without waiting. Returns 0 if some process listens there, even if it is busy; else errno,
/// which is ECONNREFUSED if none listens.
int probe_unix_socket(const std::string& path);

}  // namespace penumbra
