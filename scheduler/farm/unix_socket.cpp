#include "scheduler/farm/unix_socket.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace penumbra {

std::optional<sockaddr_un> unix_socket_name(const std::string& path) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  if (path.size() >= sizeof name.sun_path) return {};
  std::memcpy(name.sun_path, path.data(), path.size());
  return name;
}

int probe_unix_socket(const std::string& path) {
  const std::optional<sockaddr_un> name = unix_socket_name(path);
  if (!name) return ENAMETOOLONG;
  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return errno;
  const bool connected = connect(descriptor, reinterpret_cast<const sockaddr*>(&*name), sizeof *name) == 0;
  const int error = connected || errno == EAGAIN ? 0 : errno;  // EAGAIN: the listener's queue is full
  close(descriptor);
  return error;
}

}  // namespace penumbra
