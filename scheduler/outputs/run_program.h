// Another program, run to its end.
#pragma once

#include <string>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

struct ProgramEnd {
  bool succeeded = false;
  std::string output;
};

/// Starts the program (a path), waits for it, and takes what it writes to stdout, with `errors_too` also to
/// stderr. Error: it could not be started.
Expected<ProgramEnd> run_program(std::string program, std::vector<std::string> arguments, bool errors_too);

}  // namespace penumbra
