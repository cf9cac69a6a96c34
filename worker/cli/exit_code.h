// The exit codes of `penumbra`.
#pragma once

namespace penumbra {

enum ExitCode : int {
  kAllDone = 0,
  kIncomplete = 1,  ///< something requested is incomplete or failed; details are on stderr
  kBadInput = 2,    ///< wrong usage, an invalid scene, or an output that cannot be written
};

}  // namespace penumbra
