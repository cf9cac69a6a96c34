// What `penumbra` tells its caller.
#pragma once

#include <string_view>

#include "kernels/host/error.h"

namespace penumbra {

enum ExitCode : int {
  kAllDone = 0,
  kIncomplete = 1,  ///< something that was asked for is incomplete or failed; what exactly is on stderr
  kBadInput = 2,    ///< bad usage, a bad scene, an output that cannot be written
};

/// Prints the message to stderr, after `penumbra: error:` unless it names a place in a file itself.
void print_error(const Error& error);

/// Prints `penumbra: warning: …` to stderr, or the text alone if it names a place in a file itself.
void print_warning(std::string_view text);

}  // namespace penumbra
