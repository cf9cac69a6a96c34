// The exit codes of `penumbra`.
#pragma once

namespace penumbra {

enum ExitCode : int {
  kAllDone = 0,
  kIncomplete = 1,  ///< something that was asked for is incomplete or failed; what exactly is on stderr
  kBadInput = 2,    ///< bad usage, a bad scene, an output that cannot be written
};

}  // namespace penumbra
