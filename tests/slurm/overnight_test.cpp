// The recipes of scheduler/farm/CLUSTER.md, read from there, on a real Slurm: a scheduler in a batch job that
// is killed and submitted again, a window behind a tunnel, and workers of a job array.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "scheduler/watch/watch_client.h"
#include "tests/scheduler/cli/moving_scene.h"
#include "tests/scheduler/faults/tcp_relay.h"
#include "tests/slurm/recipes.h"
#include "tests/slurm/slurm_fixture.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// What recipes say of size and effort, here.
const std::pair<std::string, std::string> kTasks{"srun -n 32 -c 4", "srun -n 3 -c 1"},
    kSamples{"--spp 4096", "--spp 256"};

class Overnight : public Slurm {
 protected:
  void SetUp() override {
    Slurm::SetUp();
    if (IsSkipped()) return;
    setenv("HOME", folder_.path().c_str(), 1);
    setenv("TMPDIR", folder_.path().c_str(), 1);
    setenv("PATH", (PENUMBRA_BINARY_DIR ":" + path_).c_str(), 1);
    std::filesystem::copy_file(source_path("scenes/cornell-small/cornell-small.xml"), folder_ / "scene.xml");
    // Two lines: the keys, and the job, which the tests submit.
    std::string keys = recipe("penumbra keys farm");
    keys.resize(keys.find("sbatch night.sbatch"));
    const ProgramResult made = run_shell(folder_.path(), keys);
    ASSERT_EQ(made.exit_code, 0) << made.out << made.err;
  }
  void TearDown() override {
    setenv("HOME", home_.c_str(), 1);
    unsetenv("TMPDIR");
    setenv("PATH", path_.c_str(), 1);
    Slurm::TearDown();
  }
  /// The image must have the bytes of what this machine renders by this command.
  void expect_bytes_of(const std::string& command, const std::string& image, const std::string& here) {
    const ProgramResult rendered = run_shell(folder_.path(), command);
    ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
    EXPECT_TRUE(file_contents(folder_ / here) == file_contents(folder_ / image)) << image;
  }

  /// Submits the script.
  std::string submit(const std::string& script) const {
    const std::string job =
        cluster_.ask("sbatch --parsable -D " + folder_.path().string() + " " + (folder_ / script).string());
    return job.substr(0, job.find('\n'));
  }
  [[nodiscard]] std::string output() const { return file_contents(folder_ / "night.log"); }
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

  const std::string home_ = std::getenv("HOME") != nullptr ? std::getenv("HOME") : "",
                    path_ = std::getenv("PATH");
};

/// The port at which the scheduler says that it listens.
std::string port_in(const std::string& text) {
  const std::regex wanted("--connect \\S+:([0-9]+)");
  std::smatch found;
  return std::regex_search(text, found, wanted) ? found[1].str() : "";
}

TEST_F(Overnight, ABatchJobThatIsKilledOrCancelledGoesOnAndIsWatchedThroughATunnel) {
  const std::string script = adapted(recipe("#SBATCH --ntasks=32"),
                                     {{"--ntasks=32 --cpus-per-task=4", "--ntasks=3 --cpus-per-task=1"},
                                      {"film.width=1920", "film.width=128"},
                                      {"film.height=1080", "film.height=128"},
                                      {"--spp 4096", "--spp 4096"},
                                      {"--pass 64", "--pass 16 --tile 32 --checkpoint-interval 0.05"},
                                      {"0.0.0.0:7000", "0.0.0.0:0"},
                                      kTasks});
  write_text(folder_ / "night.sbatch", script);
  constexpr const char* kRender =
      "penumbra render scene.xml --set film.width=128 --set film.height=128 --spp 4096 --pass 16 --tile 32 "
      "--denoise ";
  const ProgramResult estimated = run_shell(folder_.path(), std::string(kRender) + "--estimate --json");
  ASSERT_EQ(estimated.exit_code, 0) << estimated.err;

  for (const std::string& way : {"--signal=KILL --batch ", ""}) {
    const std::size_t before = output().size();
    const std::string id = submit("night.sbatch");
    ASSERT_FALSE(id.empty());
    ASSERT_TRUE(eventually([&] { return !port_in(output().substr(before)).empty(); }, 20s)) << output();
    EXPECT_EQ(cluster_.ask("squeue --me -h -o %B"), "n1\n") << "where the tunnel leads to";
    EXPECT_TRUE(is_watched(port_in(output().substr(before))));
    ASSERT_TRUE(
        eventually([&] { return std::filesystem::exists(folder_ / "out/night.exr.checkpoint"); }, 20s));
    cluster_.ask("scancel " + way + id);
    ASSERT_TRUE(ends(id));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out/night.exr.checkpoint")) << "it ended in mid-render";
    EXPECT_TRUE(eventually([&] { return tasks_running() == 0; }, 10s)) << "its workers ended with it";
  }
  ASSERT_TRUE(ends(submit("night.sbatch")));
  EXPECT_THAT(output(), AllOf(HasSubstr("going on with out/night.exr.checkpoint"), Not(HasSubstr("cannot"))));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/night.exr.checkpoint")) << output();
  expect_bytes_of(std::string(kRender) + "-q -o here.exr", "out/night.exr", "here.exr");
  EXPECT_TRUE(file_contents(folder_ / "here-denoised.exr") ==
              file_contents(folder_ / "out/night-denoised.exr"));
  const auto planned = nlohmann::json::parse(estimated.out)["plan"];
  EXPECT_EQ(statistics("here.json")["units"]["done"], planned["units"]);
  EXPECT_LE(file_contents(folder_ / "out/night.exr").size(),
            planned["image_bytes"].get<std::uint64_t>() + 20000)
      << "its pixels and a header";
}

TEST_F(Overnight, TasksOfAnArrayJoinWithKeys) {
  const std::string line = adapted(recipe("--listen HOST:7000"), {kSamples, {"HOST:7000", "localhost:0"}});
  Program program(folder_.path(), "/bin/sh", {"-c", "exec " + line});
  ASSERT_TRUE(eventually([&] { return !port_in(said()).empty(); }, 20s)) << said();
  write_text(folder_ / "worker.sbatch",
             adapted(recipe("#SBATCH --array=1-32 "),
                     {{"--array=1-32 --cpus-per-task=4", "--array=1-2 --cpus-per-task=1"},
                      {"HOST:7000", "localhost:" + port_in(said())}}));
  ASSERT_FALSE(submit("worker.sbatch").empty());
  EXPECT_TRUE(eventually([&] { return joined() == 2; }, 20s)) << said();
  const ProgramResult result = program.wait();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, Not(HasSubstr("warning")));
  EXPECT_EQ(statistics("out/a.json")["workers"].size(), 3u);
  expect_bytes_of("penumbra render scene.xml --spp 256 -q -o here.exr", "out/a.exr", "here.exr");
}

TEST_F(Overnight, FramesOfAShotAreTasksOfAnArray) {
  write_moving_scene(folder_ / "shot.xml");
  write_text(folder_ / "frames.sbatch",
             adapted(recipe("#SBATCH --array=1-250:10"),
                     {{"--array=1-250:10 --cpus-per-task=16", "--array=1-21:10 --cpus-per-task=1"},
                      {"shot.glb", "shot.xml --threads 1"}}));
  ASSERT_TRUE(ends(submit("frames.sbatch")));
  for (int frame = 1; frame <= 30; ++frame)
    EXPECT_TRUE(std::filesystem::exists(folder_ / fmt::format("out/shot.{:04}.exr", frame))) << frame;
  const auto summary = statistics("out/jobs.json");
  EXPECT_EQ(summary["jobs"].size() + summary["earlier"].size(), 30u) << "the tasks keep each other's entries";
  // Submitted again, only what is missing is rendered.
  std::filesystem::remove(folder_ / "out/shot.0013.exr");
  ASSERT_TRUE(ends(submit("frames.sbatch")));
  std::string log;
  for (const std::string& name : folder_.names())
    if (name.starts_with("slurm-")) log += file_contents(folder_ / name);
  EXPECT_THAT(log,
              AllOf(HasSubstr("10 renders: 10 unchanged"), HasSubstr("10 renders: 1 done, 9 unchanged")));
  expect_bytes_of("penumbra render shot.xml --frame 13 -q -o here.exr", "out/shot.0013.exr", "here.exr");
}

TEST_F(Overnight, ALauncherOfTheLoginNodeBringsWorkersWithKeys) {
  const std::string line = adapted(recipe("--listen HOST:0"), {kSamples, kTasks, {"HOST:0", "localhost:0"}});
  const ProgramResult result = run_shell(folder_.path(), line);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, Not(HasSubstr("warning")));
  EXPECT_EQ(statistics("out/a.json")["workers"].size(), 3u);
  expect_bytes_of("penumbra render scene.xml --spp 256 -q -o here.exr", "out/a.exr", "here.exr");
}

TEST_F(Overnight, OneCommandIsEnough) {
  const std::string line =
      adapted(recipe("penumbra sbatch "), {kSamples, {"--workers 32 --cpus 4", "--workers 2 --cpus 1"}});
  const ProgramResult submitted = run_shell(folder_.path(), line);
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  EXPECT_TRUE(eventually([&] { return cluster_.ask("squeue -h; echo done") == "done\n"; }, 90s))
      << cluster_.ask("squeue");
  expect_bytes_of("penumbra render scene.xml --spp 256 -q -o here.exr", "out/a.exr", "here.exr");
}

}  // namespace
}  // namespace penumbra
