// The scheduler that the window starts for a scene: `penumbra preview` as a child process.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "kernels/host/error.h"
#include "kernels/host/owned_descriptor.h"
#include "scheduler/farm/child_processes.h"
#include "scheduler/farm/private_socket.h"

namespace penumbra {

/// It listens at the same address after every restart, and ends with the window. The rules of ChildProcesses
/// about threads apply.
class LocalScheduler {
 public:
  /// `arguments`: those of `penumbra preview` without --listen. Errors: the program does not exist; its
  /// socket cannot be created.
  static Expected<std::unique_ptr<LocalScheduler>> start(const std::filesystem::path& penumbra,
                                                         std::vector<std::string> arguments);

  [[nodiscard]] std::string address() const { return socket_.address(); }
  /// Ends it and starts another one, which reads the scene again.
  Expected<void> restart();
  /// How it ended, if it ended since the last call. It is not restarted automatically.
  std::optional<ChildExit> ended();
  /// The lines that it, and its workers, have written since the last call. They also go to our standard
  /// error.
  std::vector<std::string> take_lines();

 private:
  LocalScheduler(PrivateSocket socket, const std::filesystem::path& penumbra,
                 std::vector<std::string> arguments, int read_end, int write_end);
  void forward(const std::stop_token& stop);

  PrivateSocket socket_;
  OwnedDescriptor read_end_, write_end_;
  std::mutex mutex_;
  std::vector<std::string> lines_;
  std::jthread forwarder_;
  ChildProcesses process_;  // the last member: its output is forwarded until it has ended
};

}  // namespace penumbra
