// A real Slurm starts, cancels, requeues and loses workers. The image must be that of a render without Slurm.
#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/slurm/slurm_fixture.h"
#include "tests/support/fake_processes.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
TEST_F(Slurm, ThreeNodesGiveTheBytesOfThisMachineAndNobodySeesTheToken) {
  Program program(folder_.path(),
                  render("there.exr", {"--launch", "srun -n 3", "--listen", "127.0.0.1:0"}, 128));
  const std::string token = told_for_workers().first;
  EXPECT_TRUE(eventually([&] { return tasks_running() == 3; }, 10s));
  for (const auto& process : std::filesystem::directory_iterator("/proc"))
    EXPECT_FALSE(file_contents(process.path() / "cmdline").contains(token)) << process.path();
  const ProgramResult result = program.wait();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, Not(HasSubstr("warning")));
  const auto workers = statistics("there.json")["workers"];
  ASSERT_EQ(workers.size(), 3u);
  for (const auto& worker : workers) EXPECT_GT(worker["units"], 0);
  expect_same_as_here("there.exr", 128);
  EXPECT_TRUE(eventually([&] { return cluster_.ask("squeue -h; echo done") == "done\n"; }, 5s))
      << "no job stays";
}

TEST_F(Slurm, ANodeThatIsSetDownInMidRenderIsDoneWithout) {
  Program program(folder_.path(),
                  render("down.exr", {"--launch", "srun -n 3 --no-kill", "--listen", "127.0.0.1:0"}));
  ASSERT_TRUE(eventually([&] { return tasks_running() == 3; }, 10s));
  cluster_.ask("scontrol update NodeName=n2 State=DOWN Reason=test");
  EXPECT_TRUE(eventually([&] { return tasks_running() == 2; }, 10s)) << "in mid-render";
  const ProgramResult result = program.wait();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  expect_same_as_here("down.exr");
  cluster_.ask("scontrol update NodeName=n2 State=RESUME");
}

TEST_F(Slurm, ALauncherThatEndsIsStartedAgain) {
  Program program(folder_.path(), render("again.exr", {"--launch", "srun -n 3", "--listen", "127.0.0.1:0"}));
  ASSERT_TRUE(eventually([&] { return tasks_running() == 3; }, 10s));
  cluster_.ask("scancel --me");
  const ProgramResult result = program.wait();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("the launcher of workers ended"));
  expect_same_as_here("again.exr");
}

TEST_F(Slurm, TasksOfAnArrayJoinAreCancelledAndRequeued) {
  Program program(folder_.path(), render("array.exr", {"--workers", "1", "--listen", "127.0.0.1:0"}, 320));
  const auto [token, address] = told_for_workers();
  setenv("PENUMBRA_TOKEN", token.c_str(), 1);
  write_text(folder_ / "worker.sbatch", "#!/bin/sh\nexec " PENUMBRA_BINARY_DIR
                                        "/penumbra-worker --threads 1 --connect " +
                                            address + "\n");
  const std::string job = cluster_.ask("sbatch --parsable --requeue --array=1-3 -o /dev/null " +
                                       (folder_ / "worker.sbatch").string());
  unsetenv("PENUMBRA_TOKEN");
  ASSERT_FALSE(job.empty());
  const std::string id = job.substr(0, job.find('\n'));
  ASSERT_TRUE(eventually([&] { return joined() == 3; }, 10s));
  cluster_.ask("scancel " + id + "_2");
  EXPECT_TRUE(eventually([&] { return tasks_running() == 2; }, 10s));
  cluster_.ask("scontrol requeue " + id + "_1");
  EXPECT_TRUE(eventually([&] { return tasks_running() == 1; }, 10s));
  // Slurm lets what is requeued wait for two minutes, and has reasons for some seconds of them: its node has
  // to be done with what ended there. Meanwhile the render may stand still.
  program.send_to_group(SIGSTOP);
  const std::string state = "squeue -h -o %t -j " + id + "_1";
  EXPECT_TRUE(eventually([&] { return cluster_.ask(state) == "PD\n"; }, 10s));
  std::this_thread::sleep_for(2s);
  cluster_.ask("scontrol update JobId=" + id + "_1 StartTime=now");
  EXPECT_TRUE(eventually([&] { return tasks_running() == 2; }, 10s));
  program.send_to_group(SIGCONT);
  const ProgramResult result = program.wait();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("has left: it was told to end by a signal"), Not(HasSubstr("warning"))));
  const auto json = statistics("array.json");
  EXPECT_EQ(json["workers"].size(), 5u) << "one here, three tasks, and one of them again";
  expect_same_as_here("array.exr", 320);
}

}  // namespace
}  // namespace penumbra
