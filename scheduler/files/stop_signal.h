// Handling of Ctrl-C and of a closed terminal. The first signal requests a clean end; a second Ctrl-C ends
// the program at once.
#pragma once

#include <atomic>

namespace penumbra {

/// From now on the first SIGINT or SIGTERM sets the returned flag and restores the default action of both, so
/// that a second one kills the process (and with it the worker processes). SIGHUP only sets the flag, any
/// number of times; under nohup it is ignored. The environment variable PENUMBRA_OWNER_PIPE may hold the
/// number of an inherited reading end of a pipe: SIGTERM comes when the other end is closed, as by the death
/// of who has started this.
const std::atomic<bool>& install_stop_signal();

/// The same flag, which stays unset where nothing has installed it.
const std::atomic<bool>& stop_signal();

}  // namespace penumbra
