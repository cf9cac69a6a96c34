// A directory for a Unix socket that only this user can access.
#pragma once

#include <string>

#include "kernels/host/error.h"

namespace penumbra {

/// A new directory of mode 0700 under $XDG_RUNTIME_DIR, or under /tmp if the former is not usable or too long
/// for a socket's path. The destructor removes it. If the process is killed, its directory remains, and the
/// next process removes it. A live process holds a lock on its directory (flock, which programs that clean up
/// /tmp respect too), whether or not it is listening there at the moment.
class PrivateSocket {
 public:
  static Expected<PrivateSocket> create();
  PrivateSocket(PrivateSocket&& other) noexcept;
  PrivateSocket& operator=(PrivateSocket&&) = delete;
  ~PrivateSocket();

  [[nodiscard]] const std::string& directory() const { return directory_; }
  /// The address for gRPC: "unix:" and the path of the socket, which the listening process creates.
  [[nodiscard]] std::string address() const;

 private:
  PrivateSocket(std::string directory, int lock) : directory_(std::move(directory)), lock_(lock) {}
  std::string directory_;
  int lock_ = -1;
};

}  // namespace penumbra
