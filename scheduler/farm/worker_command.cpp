#include "scheduler/farm/worker_command.h"

#include <fmt/format.h>

#include <filesystem>

#include "scheduler/farm/render_farm.h"
#include "worker/keys/client_access.h"
#include "worker/keys/tcp_address.h"

namespace penumbra {

WorkerCommand worker_command(const FarmOptions& options, const std::string& address,
                             const std::string& token) {
  WorkerCommand command{.program = options.worker_executable,
                        .arguments = {"--connect", address},
                        .environment = {},
                        .is_launcher = !options.launch.empty()};
  if (!token.empty()) command.environment.push_back(fmt::format("{}={}", kTokenVariable, token));
  if (!command.is_launcher) return command;
  if (options.keys && is_tcp(address)) {
    // The worker's keys are in a folder beside the scheduler's.
    std::filesystem::path folder = std::filesystem::absolute(options.keys->folder).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    if (folder.filename() == info(KeyRole::kScheduler).folder) folder = folder.parent_path();
    command.environment.push_back(fmt::format("{}={}", kKeysVariable, folder.string()));
  }
  // Another machine may have another number of cores.
  command.arguments.insert(command.arguments.end(), {"--threads", options.launch_threads});
  // A shell interprets the user's words, but not ours.
  std::vector<std::string> words = {"-c", "exec " + options.launch + " \"$@\"", "sh", command.program};
  words.insert(words.end(), command.arguments.begin(), command.arguments.end());
  command.program = "/bin/sh";
  command.arguments = std::move(words);
  return command;
}

}  // namespace penumbra
