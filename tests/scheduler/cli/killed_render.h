// Starts a render of the small scene and kills it before it is done.
#pragma once

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/fake_processes.h"
#include "tests/support/program.h"

namespace penumbra {

/// Small tiles and passes that are often kept, by two workers; without the number of samples.
inline const std::vector<std::string> kManyUnits = {
    "--pass", "32", "--tile", "8", "--workers", "2", "--threads", "1", "--checkpoint-interval", "0.02"};

/// Whether there is a checkpoint, in time.
inline bool comes(const std::filesystem::path& checkpoint) {
  return eventually([&] { return std::filesystem::exists(checkpoint); }, std::chrono::seconds(15));
}

/// Kills it some time after it has kept something.
inline void kill_after(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
                       const std::string& checkpoint, std::chrono::milliseconds after) {
  Program program(folder, arguments);
  ASSERT_TRUE(comes(folder / checkpoint));
  std::this_thread::sleep_for(after);
  program.send(SIGKILL);
  program.wait();
}

}  // namespace penumbra
