// Runs another program and waits for its end.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

/// How a process ended, of waitpid's status: "exit code 1", "killed by signal 9 (Killed)".
std::string describe_exit(int status);

struct ProgramEnd {
  bool succeeded = false;
  std::string how = {};  ///< see describe_exit
  std::string output = {};
};

struct ProgramOptions {
  std::filesystem::path folder = {};  ///< working directory; empty: the current one
  bool errors_too = false;            ///< capture stderr too
  std::chrono::seconds limit{600};    ///< time limit
  /// Set: the program is killed. Null: nothing but the limit ends it.
  const std::atomic<bool>* stop = nullptr;
};

/// Runs the program (a path), waits for it, and captures its stdout. It is killed if this thread ends.
/// Errors: it could not be started, exceeded the time limit, or was stopped.
Expected<ProgramEnd> run_program(std::string program, std::vector<std::string> arguments,
                                 const ProgramOptions& options = {});

}  // namespace penumbra
