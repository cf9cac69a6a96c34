// The real programs, `penumbra render` and its workers, are killed and stopped at random times, and resumed.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <random>
#include <thread>

#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/fake_processes.h"
#include "tests/support/fault_schedules.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;

std::vector<std::string> arguments(const std::string& image, bool resume) {
  std::vector<std::string> all = {
      "render", "s.xml", "--spp",     "24000", "--pass",    "32", "--tile", "8",
      "-o",     image,   "--workers", "2",     "--threads", "1",  "-q",     "--checkpoint-interval",
      "0.02"};
  if (resume) all.push_back("--resume");
  return all;
}

TEST(RestartFaults, TheImageIsTheSameWhoeverIsKilledWhen) {
  TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  ASSERT_EQ(run_penumbra(folder.path(), arguments("a.exr", false)).exit_code, 0);
  const std::string expected = file_contents(folder / "a.exr");
  int restarts = 0;
  for (const unsigned seed : fault_seeds(2)) {
    SCOPED_TRACE(testing::Message() << "PENUMBRA_FAULT_SEED=" << seed);
    std::mt19937 random(seed);
    const std::string image = "b" + std::to_string(seed) + ".exr";
    for (int life = 0; life < 4; ++life) {
      Program program(folder.path(), arguments(image, life > 0));
      std::this_thread::sleep_for(std::chrono::milliseconds(100 + random() % 400));
      const std::vector<pid_t> workers = children_of(program.pid());
      if (!workers.empty() && random() % 2 == 0) {
        kill(workers[random() % workers.size()], random() % 2 == 0 ? SIGKILL : SIGSTOP);
        std::this_thread::sleep_for(std::chrono::milliseconds(random() % 200));
      }
      program.send(SIGKILL);
      program.wait();
      if (std::filesystem::exists(folder / image)) break;
      ++restarts;
    }
    const ProgramResult last = run_penumbra(folder.path(), arguments(image, true));
    ASSERT_EQ(last.exit_code, 0) << last.err;
    ASSERT_EQ(file_contents(folder / image), expected);
  }
  EXPECT_GT(restarts, 0) << "it was over before it could be killed";
}

}  // namespace
}  // namespace penumbra
