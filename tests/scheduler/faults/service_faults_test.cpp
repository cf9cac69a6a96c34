// A service is killed at random times while groups with dependencies are submitted, rendered and fetched.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <future>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/fault_schedules.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using Arguments = std::vector<std::string>;

constexpr int kKills = 5;  // of each schedule

// Two frames, of which each comes after the preview.
constexpr const char* kJobs = R"([defaults]
pass = 32
tile = 8
[[render]]
scene = "s.xml"
spp = 12000
seed = [1, 2]
out = "shots/{seed:04}/beauty.exr"
after = "preview"
[[render]]
name = "preview"
scene = "s.xml"
spp = 3000
out = "preview.exr"
)";
const std::map<std::string, Arguments> kImages = {
    {"preview.exr", {"--spp", "3000"}},
    {"shots/0001/beauty.exr", {"--spp", "12000", "--seed", "1"}},
    {"shots/0002/beauty.exr", {"--spp", "12000", "--seed", "2"}},
};

class ServiceFaults : public ::testing::Test {
 protected:
  void SetUp() override {
    write_small_scene(folder_ / "s.xml");
    write_text(folder_ / "jobs.toml", kJobs);
    for (const auto& [image, options] : kImages) {
      Arguments arguments{"render", "s.xml", "-q", "--pass", "32", "--tile", "8", "-o", "expected/" + image};
      arguments.insert(arguments.end(), options.begin(), options.end());
      ASSERT_EQ(run_penumbra(folder_.path(), arguments).exit_code, 0);
    }
  }
  void serve() {
    service_ = std::make_unique<Program>(
        folder_.path(),
        Arguments{"serve", "--listen", address_, "--spool", "spool", "--workers", "2", "--threads", "1",
                  "--checkpoint-interval", "0.02", "--on-done", "echo {kind} {job} {state} >>ends.txt"});
  }
  ProgramResult run(Arguments arguments) const {
    arguments.insert(arguments.end(), {"--to", address_});
    return run_penumbra(folder_.path(), arguments);
  }
  /// When each job that is done ended; empty while there is no service.
  [[nodiscard]] std::map<int, double> done_jobs() const {
    std::map<int, double> done;
    const auto status = nlohmann::json::parse(run({"status", "--json"}).out, nullptr, false);
    if (status.is_object())
      for (const auto& job : status["jobs"])
        if (job["state"] == "done") done[job["job"]] = job["ended"];
    return done;
  }
  /// Kills the service some times and starts it again. What was done stays done.
  void disturb(std::mt19937& random) {
    std::map<int, double> done;
    for (int kill = 0; kill < kKills; ++kill) {
      std::this_thread::sleep_for(std::chrono::milliseconds(random() % 900));
      for (const auto& [job, ended] : done_jobs()) {
        const auto [known, is_new] = done.emplace(job, ended);
        EXPECT_EQ(known->second, ended) << "job " << job << " was rendered again";
      }
      service_->send(SIGKILL);
      service_->wait();
      ++kills_;
      serve();
    }
  }

  const TemporaryFolder folder_;
  const std::string address_ = "unix:" + (folder_ / "socket").string();
  std::unique_ptr<Program> service_;
  int kills_ = 0;
};

TEST_F(ServiceFaults, NothingIsLostNorRenderedAgainWheneverItIsKilled) {
  for (const unsigned seed : fault_seeds(2)) {
    SCOPED_TRACE(testing::Message() << "PENUMBRA_FAULT_SEED=" << seed);
    std::mt19937 random(seed);
    serve();
    // Submitting may be cut off; what it has said by then is there to stay.
    std::string group;
    while (group.empty()) {
      const ProgramResult submitted = run({"submit", "jobs.toml", "-q"});
      if (submitted.exit_code == 0) group = submitted.out.substr(0, submitted.out.find('\n'));
    }
    const std::string out = "out" + std::to_string(seed);
    auto fetched = std::async(std::launch::async, [&] { return run({"fetch", group, "--wait", "-o", out}); });
    disturb(random);
    // A fetch that is cut off while it downloads says so; the next one gets everything.
    if (fetched.get().exit_code != 0) {
      const ProgramResult again = run({"fetch", group, "--wait", "-o", out});
      ASSERT_EQ(again.exit_code, 0) << again.err;
    }
    for (const auto& [image, options] : kImages)
      EXPECT_TRUE(file_contents(folder_ / out / image) == file_contents(folder_ / "expected" / image))
          << image;
    const std::string end = "group " + group + " done\n";
    for (int i = 0; i < 1000 && file_contents(folder_ / "ends.txt").find(end) == std::string::npos; ++i)
      std::this_thread::sleep_for(10ms);
    EXPECT_NE(file_contents(folder_ / "ends.txt").find(end), std::string::npos);
    service_->send(SIGTERM);
    EXPECT_EQ(service_->wait().exit_code, 0);
  }
  RecordProperty("kills", kills_);
}

}  // namespace
}  // namespace penumbra
