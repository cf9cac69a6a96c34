// How a farm starts workers: the one place where their command line is made.
#pragma once

#include <string>
#include <vector>

namespace penumbra {

struct FarmOptions;

struct WorkerCommand {
  std::string program;
  std::vector<std::string> arguments;
  /// NAME=value. A token goes here: every user of a machine can read arguments.
  std::vector<std::string> environment;
  /// One process that starts any number of workers, maybe elsewhere and not at once.
  bool is_launcher = false;
};

/// Of a worker on this machine; or with FarmOptions::launch of what launches them. `address` is where workers
/// reach the scheduler, `token` what they have to show there, if anything.
WorkerCommand worker_command(const FarmOptions& options, const std::string& address,
                             const std::string& token);

}  // namespace penumbra
