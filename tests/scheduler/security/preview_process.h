// A scheduler process that uses TLS, and its keys.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <regex>
#include <string>

#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/fake_processes.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "worker/keys/key_folder.h"
#include "worker/keys/make_keys.h"

namespace penumbra {

/// A folder with a small scene `s.xml` and the keys `keys`, in which a scheduler runs.
class SchedulerProcess {
 public:
  explicit SchedulerProcess(std::vector<std::string> arguments) {
    write_small_scene(folder / "s.xml");
    EXPECT_TRUE(make_keys({.folder = folder / "keys", .names = {"localhost", "127.0.0.1"}}));
    // One heap: else the allocator makes one more for each of many threads, and growth tells nothing.
    setenv("MALLOC_ARENA_MAX", "1", 1);
    arguments.insert(arguments.end(), {"--listen", "127.0.0.1:0", "--keys", "keys"});
    program.emplace(folder.path(), arguments);
    const std::regex printed("--connect (127\\.0\\.0\\.1:(\\d+)) --keys");
    std::smatch found;
    std::string text;
    EXPECT_TRUE(eventually(
        [&] { return std::regex_search(text = file_contents(folder / ".stderr"), found, printed); },
        std::chrono::seconds(60)))
        << text;
    address = found[1];
    port = std::atoi(found[2].str().c_str());
  }

  [[nodiscard]] std::shared_ptr<const Keys> keys(KeyRole role) const {
    return read_keys(folder / "keys", role).value();
  }

  /// Memory of its own, KiB. Pages of the program and of libraries are not counted: the system drops and
  /// reads them as it likes.
  [[nodiscard]] long memory() const {
    std::ifstream status("/proc/" + std::to_string(program->pid()) + "/status");
    long sum = 0;
    for (std::string line; std::getline(status, line);)
      if (line.starts_with("RssAnon:") || line.starts_with("VmSwap:"))
        sum += std::atol(line.c_str() + line.find(':') + 1);
    return sum;
  }

  TemporaryFolder folder;
  std::optional<Program> program;
  std::string address;
  int port = 0;
};

}  // namespace penumbra
