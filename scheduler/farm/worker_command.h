// Builds the command line with which a farm starts workers.
#pragma once

#include <string>
#include <vector>

namespace penumbra {

struct FarmOptions;

struct WorkerCommand {
  std::string program;
  std::vector<std::string> arguments;
  /// NAME=value. Tokens are passed here, because every user of a machine can read command-line arguments.
  std::vector<std::string> environment;
  /// The process starts any number of workers, possibly on other machines and later.
  bool is_launcher = false;
};

/// The command for a local worker, or with FarmOptions::launch for the launcher. `address` is where workers
/// reach the scheduler; `token` may be empty.
WorkerCommand worker_command(const FarmOptions& options, const std::string& address,
                             const std::string& token);

}  // namespace penumbra
