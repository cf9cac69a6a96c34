// Tests `penumbra status --watch` on a terminal.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

/// A program with a terminal of its own.
class OnTerminal {
 public:
  explicit OnTerminal(const std::vector<std::string>& arguments) {
    winsize size{};
    size.ws_col = 100;
    size.ws_row = 12;
    std::vector<char*> argv;
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    pid_ = forkpty(&terminal_, nullptr, nullptr, &size);
    if (pid_ == 0) {
      setenv("TERM", "xterm", 1);
      execv(argv[0], argv.data());
      _exit(127);
    }
  }
  ~OnTerminal() {
    kill(pid_, SIGKILL);
    if (!ended_) waitpid(pid_, nullptr, 0);
    close(terminal_);
  }
  OnTerminal(const OnTerminal&) = delete;
  OnTerminal& operator=(const OnTerminal&) = delete;

  /// Reads until the text is there, or for too long.
  const std::string& read_until(const std::string& text) {
    for (int i = 0; i < 1000 && seen_.find(text) == std::string::npos; ++i) {
      pollfd input{terminal_, POLLIN, 0};
      if (poll(&input, 1, 20) <= 0) continue;
      char bytes[4096];
      const ssize_t count = read(terminal_, bytes, sizeof bytes);
      if (count <= 0) break;
      seen_.append(bytes, std::size_t(count));
    }
    return seen_;
  }
  void type(char key) const { EXPECT_EQ(write(terminal_, &key, 1), 1); }
  int exit_code() {
    int status = 0;
    waitpid(pid_, &status, 0);
    ended_ = true;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  int terminal_ = -1;
  pid_t pid_ = -1;
  bool ended_ = false;
  std::string seen_;
};

TEST(WatchScreen, ShowsTheServiceAndLeavesTheTerminalAsItWas) {
  const TemporaryFolder folder;
  const std::string address = "unix:" + (folder / "socket").string();
  const std::string penumbra = std::string(PENUMBRA_BINARY_DIR) + "/penumbra";
  OnTerminal watching({penumbra, "status", "--watch", "--to", address});
  // It waits for a service that is not there yet.
  EXPECT_THAT(watching.read_until("trying again"), HasSubstr("\x1b[?1049h"));
  Program service(folder.path(),
                  {"serve", "--listen", address, "--spool", "spool", "--workers", "1", "--threads", "1"});
  EXPECT_THAT(watching.read_until("1 worker"), HasSubstr("0 jobs"));
  watching.type('q');
  EXPECT_EQ(watching.exit_code(), 0);
  EXPECT_THAT(watching.read_until("\x1b[?1049l"), HasSubstr("\x1b[?25h\x1b[?1049l"));
}

}  // namespace
}  // namespace penumbra
