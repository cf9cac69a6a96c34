#include "scheduler/files/stop_signal.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <string_view>
#include <thread>

namespace penumbra {
namespace {

std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch nothing else");

void on_signal(int number) {
  stop_requested = true;
  if (number == SIGHUP) return;  // it comes twice: from the terminal, and from the shell that ends with it
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

/// Ends like Ctrl-C as soon as the other end of this pipe is closed.
void stop_with_owner() {
  const char* text = std::getenv("PENUMBRA_OWNER_PIPE");
  if (text == nullptr) return;
  int pipe = -1;
  const std::string_view digits = text;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), pipe);
  const bool is_open =
      error == std::errc() && end == digits.data() + digits.size() && fcntl(pipe, F_SETFD, FD_CLOEXEC) == 0;
  unsetenv("PENUMBRA_OWNER_PIPE");
  if (!is_open) return;
  std::thread([pipe] {
    pollfd closed{pipe, 0, 0};
    while (poll(&closed, 1, -1) < 0 && errno == EINTR) {
    }
    kill(getpid(), SIGTERM);
  }).detach();
}

}  // namespace

const std::atomic<bool>& stop_signal() { return stop_requested; }

const std::atomic<bool>& install_stop_signal() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction inherited {};
  sigaction(SIGHUP, nullptr, &inherited);
  // Otherwise this runs under nohup.
  if (inherited.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  stop_with_owner();
  return stop_requested;
}

}  // namespace penumbra
