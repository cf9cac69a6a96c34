// Unix sockets by the paths of their files.
#pragma once

#include <sys/un.h>

#include <optional>
#include <string>

namespace penumbra {

/// The path as the name of a socket; nothing if it is longer than one may be.
std::optional<sockaddr_un> unix_socket_name(const std::string& path);

/// Tries to connect, without waiting: 0 where somebody listens, be it that he has no time at the moment; else
/// errno, ECONNREFUSED where nobody does.
int probe_unix_socket(const std::string& path);

}  // namespace penumbra
