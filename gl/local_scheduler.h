// The scheduler that the window starts when it is given a scene: `penumbra preview`, as a process of its own.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/farm/child_processes.h"
#include "scheduler/farm/private_socket.h"

namespace penumbra {

/// Listens at the same address however often it is started anew. Ends with the window. The rules of
/// ChildProcesses about threads hold.
class LocalScheduler {
 public:
  /// `arguments` of `penumbra preview`, without --listen. Errors: there is no such program, or no place for
  /// its socket.
  static Expected<std::unique_ptr<LocalScheduler>> start(const std::filesystem::path& penumbra,
                                                         std::vector<std::string> arguments);

  [[nodiscard]] std::string address() const { return socket_.address(); }
  /// Ends it, and starts another one, which reads the scene anew.
  Expected<void> restart();
  /// How it has ended, if it has since the last call; another one is not started by itself.
  std::optional<ChildExit> ended();

 private:
  LocalScheduler(PrivateSocket socket, const std::filesystem::path& penumbra,
                 std::vector<std::string> arguments);

  PrivateSocket socket_;
  ChildProcesses process_;
};

}  // namespace penumbra
