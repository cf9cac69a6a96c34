// Runs another program and waits for its end.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

struct ProgramEnd {
  bool succeeded = false;
  std::string output;
};

struct ProgramOptions {
  std::filesystem::path folder = {};  ///< working directory; empty: the current one
  bool errors_too = false;            ///< capture stderr too
  std::chrono::seconds limit{600};    ///< time limit
};

/// Runs the program (a path), waits for it, and captures its stdout. Errors: it could not be started, or it
/// exceeded the time limit and was killed.
Expected<ProgramEnd> run_program(std::string program, std::vector<std::string> arguments,
                                 const ProgramOptions& options = {});

}  // namespace penumbra
