// Another program, run to its end.
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
  std::filesystem::path folder = {};  ///< where it runs; empty: here
  bool errors_too = false;            ///< what it writes to stderr is taken as well
  std::chrono::seconds limit{600};    ///< longer than it may take
};

/// Starts the program (a path), waits for it, and takes what it writes to stdout. Errors: it could not be
/// started, or did not end in time and was killed.
Expected<ProgramEnd> run_program(std::string program, std::vector<std::string> arguments,
                                 const ProgramOptions& options = {});

}  // namespace penumbra
