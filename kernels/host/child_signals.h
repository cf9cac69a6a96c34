// What a child process must not inherit.
#pragma once

#include <signal.h>

namespace penumbra {

/// Between fork and exec, or right before an exec: signals that this program ignores or blocks act in the
/// next one as they do by default; those that it catches do by themselves. Async-signal-safe.
inline void restore_default_signals() {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int number : {SIGPIPE, SIGXFSZ, SIGCHLD}) signal(number, SIG_DFL);
}

}  // namespace penumbra
