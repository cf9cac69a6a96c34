// What `penumbra sbatch` writes, on a real Slurm whose nodes are lost, whose jobs are preempted and requeued,
// and whose scheduler moves to another node.
#include <gmock/gmock.h>

#include <csignal>

#include "tests/slurm/slurm_fixture.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kSpp = 256, kLongSpp = 4 * kSpp;  // long: not done before Slurm has acted on a requeue
// From a change until Slurm has acted on it: it waits for nodes, and for the end of what ran there.
constexpr std::chrono::seconds kPatience{90};

class SbatchJobs : public Slurm {
 protected:
  /// The image of `penumbra sbatch … --submit` is a.exr.
  void submit(const Arguments& more, int spp = kSpp) {
    Arguments words = render(
        "a.exr", {"--cpus", "1", "--folder", "jobs", "--submit", "--checkpoint-interval", "0.05"}, spp);
    words.front() = "sbatch";
    words.insert(words.end(), more.begin(), more.end());
    const ProgramResult submitted = run_penumbra(folder_.path(), words);
    ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
    std::istringstream(file_contents(folder_ / "jobs/jobs")) >> scheduler_ >> workers_;
    ASSERT_FALSE(workers_.empty()) << submitted.out << submitted.err;
  }
  [[nodiscard]] std::string log() const { return file_contents(folder_ / "jobs/scheduler.log"); }
  [[nodiscard]] std::string worker_log(int task) const {
    return file_contents(folder_ / ("jobs/worker-" + std::to_string(task) + ".log"));
  }
  /// The node of a running job, "" while it does not run.
  [[nodiscard]] std::string node_of(const std::string& job) const {
    const std::string node = cluster_.ask("squeue -h -t R -o %N -j " + job);
    return node.substr(0, node.find('\n'));
  }
  [[nodiscard]] static int count(const std::string& text, const std::string& what) {
    int number = 0;
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++number;
    return number;
  }
  bool joins(int times) const {
    return eventually([&] { return count(log(), "has joined it") >= times; }, kPatience);
  }
  bool has_checkpoint() const {
    return eventually([&] { return std::filesystem::exists(folder_ / "a.exr.checkpoint"); }, kPatience);
  }
  /// Slurm lets requeued jobs wait for two minutes; this ends that as soon as they may start.
  bool runs_again(const std::string& job) const {
    return eventually(
        [&] {
          cluster_.ask("scontrol update JobId=" + job + " StartTime=now");
          return !node_of(job).empty();
        },
        kPatience);
  }
  /// All jobs end, the image is that of an undisturbed render, and no task is left for which there is nothing
  /// to do.
  void expect_the_image(int spp = kSpp) {
    const bool ends = eventually(
        [&] {
          for (const std::string& job : {scheduler_, workers_})
            cluster_.ask("scontrol update JobId=" + job + " StartTime=now");
          return cluster_.ask("squeue -h; echo done") == "done\n";
        },
        2 * kPatience);
    ASSERT_TRUE(ends) << cluster_.ask("squeue") << log() << worker_log(1);
    EXPECT_EQ(file_contents(folder_ / "jobs/address"), "ended\n");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.exr.checkpoint")) << log();
    expect_same_as_here("a.exr", spp);
  }

  std::string scheduler_, workers_;  ///< numbers of the jobs
};

/// Stops the scheduler while Slurm takes its time, so that the render does not end meanwhile.
class Standstill {
 public:
  explicit Standstill(const SlurmCluster& cluster) : stopped_(cluster.processes("--address-file")) {
    EXPECT_EQ(stopped_.size(), 1u);
    for (const pid_t pid : stopped_) kill(pid, SIGSTOP);
  }
  ~Standstill() {
    for (const pid_t pid : stopped_) kill(pid, SIGCONT);
  }
  Standstill(const Standstill&) = delete;
  Standstill& operator=(const Standstill&) = delete;

 private:
  std::vector<pid_t> stopped_;
};

TEST_F(SbatchJobs, AreARenderByOneCommand) {
  submit({"--workers", "2"});
  ASSERT_TRUE(joins(2)) << log() << worker_log(1);
  EXPECT_THAT(node_of(scheduler_), testing::StartsWith("n"));
  expect_the_image();
  EXPECT_EQ(statistics("a.json")["workers"].size(), 3u) << "one is beside the scheduler";
  EXPECT_THAT(log(), AllOf(Not(HasSubstr("warning")), Not(HasSubstr("error:"))));
}

TEST_F(SbatchJobs, GoOnWhenTheSchedulersNodeIsLost) {
  submit({"--workers", "1"});
  ASSERT_TRUE(joins(1) && has_checkpoint()) << log() << worker_log(1);
  const std::string before = node_of(scheduler_);
  cluster_.lose_node(before);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "a.exr.checkpoint")) << "it ended in mid-render";
  ASSERT_TRUE(eventually([&] { return node_of(scheduler_) != before; }, kPatience)) << cluster_.ask("squeue");
  ASSERT_TRUE(runs_again(scheduler_)) << cluster_.ask("squeue") << log();
  EXPECT_NE(node_of(scheduler_), before);
  EXPECT_TRUE(joins(2)) << log() << worker_log(1);
  expect_the_image();
  EXPECT_THAT(log(), HasSubstr("going on with a.exr.checkpoint"));
  EXPECT_THAT(worker_log(1), HasSubstr("waiting for up to "));
}

TEST_F(SbatchJobs, GoOnWhenTheSchedulerIsRequeuedToAnotherNode) {
  submit({"--workers", "1"}, kLongSpp);
  ASSERT_TRUE(joins(1) && has_checkpoint()) << log() << worker_log(1);
  const std::string before = node_of(scheduler_);
  cluster_.ask("scontrol update NodeName=" + before + " State=DRAIN Reason=test");
  cluster_.ask("scontrol requeue " + scheduler_);
  ASSERT_TRUE(eventually([&] { return node_of(scheduler_) != before; }, kPatience));
  EXPECT_FALSE(node_of(workers_).empty()) << "it waits";
  ASSERT_TRUE(runs_again(scheduler_)) << cluster_.ask("squeue") << log();
  EXPECT_NE(node_of(scheduler_), before);
  EXPECT_TRUE(joins(2)) << log() << worker_log(1);
  expect_the_image(kLongSpp);
  EXPECT_THAT(log(), HasSubstr("going on with a.exr.checkpoint"));
}

TEST_F(SbatchJobs, AreDoneWithoutALostWorkerAndItsTaskIsRequeued) {
  submit({"--workers", "2"});
  ASSERT_TRUE(joins(2)) << log() << worker_log(1);
  const std::string task = workers_ + "_2", lost = node_of(task);
  {
    const Standstill standstill(cluster_);
    cluster_.lose_node(lost);
    EXPECT_TRUE(eventually([&] { return cluster_.ask("squeue -h -t PD -o %i -j " + task) == task + "\n"; },
                           kPatience))
        << cluster_.ask("squeue") << cluster_.ask("sinfo");
  }
  expect_the_image();
}

TEST_F(SbatchJobs, ComeBackAfterTheyWerePreempted) {
  submit({"--workers", "2", "--worker-partition", "preempted"});
  ASSERT_TRUE(joins(2)) << log() << worker_log(1);
  const std::string task = workers_ + "_1";
  std::string urgent =
      cluster_.ask("sbatch --parsable -p all -w " + node_of(task) + " -o /dev/null --wrap 'sleep 1000'");
  urgent = urgent.substr(0, urgent.find('\n'));
  ASSERT_TRUE(
      eventually([&] { return log().contains("has left: it was told to end by a signal"); }, kPatience))
      << log() << cluster_.ask("squeue");
  {
    const Standstill standstill(cluster_);
    EXPECT_TRUE(eventually([&] { return !node_of(urgent).empty(); }, kPatience)) << cluster_.ask("squeue");
    EXPECT_EQ(node_of(task), "") << "it gave way";
    cluster_.ask("scancel " + urgent);
    ASSERT_TRUE(runs_again(task)) << cluster_.ask("squeue");
  }
  EXPECT_TRUE(joins(3)) << log() << worker_log(1);
  expect_the_image();
  EXPECT_THAT(log(), Not(HasSubstr("warning")));
}

TEST_F(SbatchJobs, OfWorkersThatFindNoSchedulerEndAfterTheStatedTime) {
  submit({"--workers", "1", "--retry-for", "3"});
  cluster_.ask("scancel " + scheduler_ + " " + workers_);
  ASSERT_TRUE(eventually([&] { return cluster_.ask("squeue -h; echo done") == "done\n"; }, kPatience));
  std::filesystem::remove(folder_ / "jobs/address");
  std::filesystem::remove(folder_ / "jobs/worker-1.log");
  std::string alone = cluster_.ask("sbatch --parsable -D " + (folder_ / "jobs").string() + " " +
                                   (folder_ / "jobs/workers.sbatch").string());
  alone = alone.substr(0, alone.find('\n'));
  const auto state = [&] { return cluster_.ask("scontrol show job " + alone); };
  EXPECT_TRUE(eventually([&] { return state().contains("JobState=FAILED"); }, kPatience)) << state();
  EXPECT_THAT(state(), HasSubstr("ExitCode=1:0"));
  EXPECT_THAT(worker_log(1), AllOf(HasSubstr("waiting for up to 3 s (--retry-for): there is no file"),
                                   HasSubstr("error: there is no file"), HasSubstr("(waited 3 s)")));
}

}  // namespace
}  // namespace penumbra
