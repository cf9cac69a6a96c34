// A Unix socket's place that only this user can reach.
#pragma once

#include <string>

#include "kernels/host/error.h"

namespace penumbra {

/// A fresh directory of mode 0700 under $XDG_RUNTIME_DIR, or /tmp where that is not usable or too long for a
/// socket's path; removed with the object. A killed process leaves its directory behind: the next one that
/// comes removes it.
class PrivateSocket {
 public:
  static Expected<PrivateSocket> create();
  PrivateSocket(PrivateSocket&& other) noexcept;
  PrivateSocket& operator=(PrivateSocket&&) = delete;
  ~PrivateSocket();

  [[nodiscard]] const std::string& directory() const { return directory_; }
  /// For gRPC: "unix:" and the path of the socket, which whoever listens creates.
  [[nodiscard]] std::string address() const;

 private:
  explicit PrivateSocket(std::string directory) : directory_(std::move(directory)) {}
  std::string directory_;
};

}  // namespace penumbra
