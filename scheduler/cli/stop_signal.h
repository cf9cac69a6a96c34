// Ctrl-C, or a terminal that is closed: the first asks for a clean end, a second Ctrl-C ends the program at
// once.
#pragma once

#include <atomic>

namespace penumbra {

/// From now on the first SIGINT or SIGTERM sets the returned flag and restores the default action of both, so
/// that a second one kills the process (worker processes end with it). SIGHUP only sets the flag, however
/// often it comes, and nothing under nohup.
const std::atomic<bool>& install_stop_signal();

}  // namespace penumbra
