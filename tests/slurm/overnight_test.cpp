// The recipes of scheduler/farm/CLUSTER.md with keys, on a real Slurm: a scheduler in a batch job that is
// killed and submitted again, a window behind a tunnel, and workers of a job array.
#include <gmock/gmock.h>

#include <algorithm>

#include "scheduler/watch/watch_client.h"
#include "tests/scheduler/faults/tcp_relay.h"
#include "tests/slurm/slurm_fixture.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class Overnight : public Slurm {
 protected:
  void SetUp() override {
    Slurm::SetUp();
    if (IsSkipped()) return;
    const ProgramResult keys = run_penumbra(folder_.path(), {"keys", "farm"});
    ASSERT_EQ(keys.exit_code, 0) << keys.err;
  }

  /// Submits the script; its output is appended to night.out.
  std::string submit(const std::string& script) const {
    const std::string job =
        cluster_.ask("sbatch --parsable -D " + folder_.path().string() + " " + (folder_ / script).string());
    return job.substr(0, job.find('\n'));
  }
  [[nodiscard]] std::string output() const { return file_contents(folder_ / "night.out"); }
  /// Whether a window at the other end of a tunnel, as of `ssh -L`, receives a tile.
  [[nodiscard]] bool is_watched(const std::string& port) const {
    const TcpRelay tunnel("127.0.0.1:" + port);
    const auto keys = read_keys(folder_ / "farm", KeyRole::kViewer);
    if (!keys) return ADD_FAILURE() << keys.error().message, false;
    const std::string address = tunnel.address();
    WatchClient window("localhost" + address.substr(address.find(':')), (*keys)->tokens.watch, *keys);
    const auto is_tile = [](const WatchNews& news) { return std::holds_alternative<TileSnapshot>(news); };
    return eventually([&] { return std::ranges::any_of(window.take(), is_tile); }, 10s);
  }
  bool ends(const std::string& job) const {
    return eventually([&] { return cluster_.ask("squeue -h -j " + job + "; echo done") == "done\n"; }, 60s);
  }
};

/// The port at which the scheduler says that it listens.
std::string port_in(const std::string& text) {
  const std::regex wanted("--connect \\S+:([0-9]+)");
  std::smatch found;
  return std::regex_search(text, found, wanted) ? found[1].str() : "";
}

TEST_F(Overnight, ABatchJobThatIsKilledOrCancelledGoesOnAndIsWatchedThroughATunnel) {
  constexpr int kSpp = 512;
  const Arguments job = render("night.exr", {"--checkpoint-interval", "0.05", "--denoise"}, kSpp);
  std::string command = PENUMBRA_BINARY_DIR "/penumbra";
  for (const std::string& word : job) command += " " + word;
  write_text(folder_ / "night.sbatch",
             "#!/bin/sh\n#SBATCH --ntasks=3 --open-mode=append --output=night.out --requeue\nexec " +
                 command +
                 " --listen 0.0.0.0:0 --keys farm --launch 'srun -n 3 --no-kill --kill-on-bad-exit=0'\n");
  Arguments estimate = job;
  estimate.insert(estimate.end(), {"--estimate", "--json"});
  const ProgramResult estimated = run_penumbra(folder_.path(), estimate);
  ASSERT_EQ(estimated.exit_code, 0) << estimated.err;

  for (const std::string& way : {"--signal=KILL --batch ", ""}) {
    const std::size_t before = output().size();
    const std::string id = submit("night.sbatch");
    ASSERT_FALSE(id.empty());
    ASSERT_TRUE(eventually([&] { return !port_in(output().substr(before)).empty(); }, 20s)) << output();
    EXPECT_EQ(cluster_.ask("squeue --me -h -o %B"), "n1\n") << "where the tunnel leads to";
    EXPECT_TRUE(is_watched(port_in(output().substr(before))));
    ASSERT_TRUE(eventually([&] { return std::filesystem::exists(folder_ / "night.exr.checkpoint"); }, 10s));
    cluster_.ask("scancel " + way + id);
    ASSERT_TRUE(ends(id));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "night.exr.checkpoint")) << "it ended in mid-render";
    EXPECT_TRUE(eventually([&] { return tasks_running() == 0; }, 10s)) << "its workers ended with it";
  }
  ASSERT_TRUE(ends(submit("night.sbatch")));
  EXPECT_THAT(output(), AllOf(HasSubstr("going on with night.exr.checkpoint"), Not(HasSubstr("cannot"))));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "night.exr.checkpoint")) << output();
  expect_same_as_here("night.exr", kSpp, {"--denoise"});
  EXPECT_TRUE(file_contents(folder_ / "here-denoised.exr") == file_contents(folder_ / "night-denoised.exr"));
  const auto planned = nlohmann::json::parse(estimated.out)["plan"];
  EXPECT_EQ(statistics("here.json")["units"]["done"], planned["units"]);
  EXPECT_LE(file_contents(folder_ / "night.exr").size(), planned["image_bytes"].get<std::uint64_t>() + 20000)
      << "its pixels and a header";
}

TEST_F(Overnight, TasksOfAnArrayJoinWithKeys) {
  Program program(folder_.path(),
                  render("array.exr", {"--listen", "localhost:0", "--keys", "farm", "--workers", "1"}));
  ASSERT_TRUE(eventually([&] { return !port_in(said()).empty(); }, 10s)) << said();
  write_text(
      folder_ / "worker.sbatch",
      "#!/bin/sh\n#SBATCH --array=1-2 --cpus-per-task=1 --requeue --open-mode=append --output=night.out\n"
      "export PENUMBRA_KEYS=" +
          (folder_ / "farm/worker").string() +
          "\nexport PENUMBRA_CACHE=" + (folder_ / "array-cache").string() +
          "\nexec " PENUMBRA_BINARY_DIR
          "/penumbra-worker --threads auto --cache-size 20G --connect localhost:" +
          port_in(said()) + "\n");
  ASSERT_FALSE(submit("worker.sbatch").empty());
  EXPECT_TRUE(eventually([&] { return joined() == 2; }, 10s)) << said() << output();
  const ProgramResult result = program.wait();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, Not(HasSubstr("warning")));
  EXPECT_EQ(statistics("array.json")["workers"].size(), 3u);
  expect_same_as_here("array.exr");
}

TEST_F(Overnight, ALauncherOfTheLoginNodeBringsWorkersWithKeys) {
  EXPECT_EQ(cluster_.ask("sinfo -hN -o %N | sort -u | paste -sd,"), "n1,n2,n3\n") << "for the keys";
  const ProgramResult result = run_penumbra(
      folder_.path(), render("there.exr", {"--listen", "localhost:0", "--keys", "farm", "--launch",
                                           "srun -n 3 --no-kill --kill-on-bad-exit=0"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, Not(HasSubstr("warning")));
  EXPECT_EQ(statistics("there.json")["workers"].size(), 3u);
  expect_same_as_here("there.exr");
}

}  // namespace
}  // namespace penumbra
