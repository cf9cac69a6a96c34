// Workers that the render did not start: what they are allowed to do.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <mutex>
#include <regex>

#include "penumbra.grpc.pb.h"
#include "scheduler/farm/worker_processes.h"
#include "tests/scheduler/watch/watched_run.h"
#include "tests/support/fake_processes.h"
#include "tests/support/temporary_folder.h"
#include "worker/protocol/client.h"
#include "worker/protocol/wire.h"
#include "worker/worker_client.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// Whether it is a worker of this very process.
bool is_own(const WorkerShare& share) { return share.name.ends_with(fmt::format(":{}", getpid())); }

class ForeignWorkerTest : public WatchedRunTest {
 protected:
  /// A render that lasts some seconds where each unit takes its own workers so long.
  LocalRender slow_job(const std::string& listen, int unit_ms = 40) {
    FakeBehaviour{.delay_ms = unit_ms}.to_environment();
    LocalRender job = batch_job();
    job.listen = listen;
    job.tells_how_to_watch = true;
    return job;
  }
  std::function<void(const RenderProgress&)> listener() {
    return [this](const RenderProgress& progress) {
      const std::lock_guard lock(mutex_);
      notices_.insert(notices_.end(), progress.notices.begin(), progress.notices.end());
    };
  }
  std::vector<std::string> notices() {
    const std::lock_guard lock(mutex_);
    return notices_;
  }
  /// Token and address that were told for this program.
  std::pair<std::string, std::string> told_for(const std::string& program) {
    const std::regex wanted("PENUMBRA_TOKEN=(\\S+) " + program + " --connect (\\S+)");
    std::smatch found;
    std::string notice;
    EXPECT_TRUE(eventually(
        [&] {
          return std::ranges::any_of(notices(), [&](const std::string& text) {
            notice = text;
            return std::regex_search(notice, found, wanted);
          });
        },
        kLong));
    return {found[1], found[2]};
  }
  static WorkerClientOptions helper(const std::pair<std::string, std::string>& token_and_address) {
    WorkerClientOptions options;
    options.token = token_and_address.first;
    options.address = token_and_address.second;
    options.isas = {Isa::kSse2, Isa::kAvx2, Isa::kAvx512};
    options.make_device = [](const DeviceScene& scene, const DeviceOptions& device) {
      return make_fake_device(scene, device, {});
    };
    return options;
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> notices_;
};

TEST_F(ForeignWorkerTest, WithItsTokenItHelpsAndIsAnnounced) {
  // Alone, its own workers would take so long that the helper comes in time however busy the machine is.
  BackgroundRun run(slow_job("127.0.0.1:0", 1000), listener());
  // A very busy worker may not read the final message in time; then the connection breaks.
  if (const Expected<void> helped = run_worker(helper(told_for("penumbra-worker"))); !helped) {
    EXPECT_THAT(helped.error().message, HasSubstr("the scheduler broke the connection"));
  }
  const RenderOutcome outcome = run.wait();
  EXPECT_TRUE(outcome.complete);
  EXPECT_THAT(outcome.problems, IsEmpty());
  // The helper is a thread of this process; of the two processes one may start too late for so short a
  // render.
  ASSERT_GE(outcome.workers.size(), 2u);
  ASSERT_LE(outcome.workers.size(), 3u);
  const auto helper_share = std::ranges::find_if(outcome.workers, is_own);
  ASSERT_NE(helper_share, outcome.workers.end());
  EXPECT_GT(helper_share->units, 0u);
  EXPECT_THAT(notices(), Contains(HasSubstr("a worker that this render did not start has joined it: " +
                                            helper_share->name + ", from 127.0.0.1:")));
  EXPECT_EQ(std::ranges::count_if(notices(), [](const auto& text) { return text.contains("has joined"); }), 1)
      << "its own are nothing to tell of";
  EXPECT_EQ(outcome.film.hash(), expected_film(kSpp, 4).hash());
}

TEST_F(ForeignWorkerTest, TheTokenForWatchingIsNoWorkers) {
  BackgroundRun run(slow_job("127.0.0.1:0"), listener());
  const Expected<void> helped = run_worker(helper(told_for("penumbra-view")));
  ASSERT_FALSE(helped);
  EXPECT_THAT(helped.error().message, HasSubstr("this token is for watching"));
  EXPECT_TRUE(std::ranges::none_of(run.stop().workers, is_own));
}

TEST_F(ForeignWorkerTest, WhoClaimsToBeAnotherProcessDoesNotGetItKilled) {
  BackgroundRun run(slow_job(address()), listener());
  Onlooker onlooker(address());
  ASSERT_TRUE(onlooker.sees_workers(2));
  std::vector<pid_t> workers = children_of(getpid());
  ASSERT_THAT(workers, SizeIs(2));
  {
    const auto stub = wire::Farm::NewStub(open_channel(address()));
    grpc::ClientContext context;
    const auto stream = stub->Work(&context);
    wire::WorkerMessage hello;
    hello.mutable_hello()->set_protocol_version(kProtocolVersion);
    hello.mutable_hello()->set_host("elsewhere");
    hello.mutable_hello()->set_pid(workers[0]);
    for (const wire::Isa isa : {wire::ISA_SSE2, wire::ISA_AVX2, wire::ISA_AVX512})
      hello.mutable_hello()->add_isas(isa);
    ASSERT_TRUE(stream->Write(hello));
    wire::SchedulerMessage job;
    ASSERT_TRUE(stream->Read(&job));
    EXPECT_TRUE(job.has_job());
    context.TryCancel();
    stream->Finish();
  }
  // A process whose stream has ended is given two seconds to end, too.
  const RenderOutcome outcome = run.wait();
  EXPECT_GT(outcome.seconds, 3);
  EXPECT_TRUE(outcome.complete);
  const std::string lost = fmt::format("worker elsewhere:{} was lost", workers[0]);
  EXPECT_THAT(outcome.problems, ElementsAre(HasSubstr(lost)));
  EXPECT_THAT(notices(), Contains(HasSubstr(lost)));
  EXPECT_THAT(notices(), Contains(HasSubstr("did not start has joined it: elsewhere:" +
                                            std::to_string(workers[0]) + ", over the Unix socket")));
}

TEST_F(ForeignWorkerTest, AProcessIsKnownByItsKeyWhichIsGoodOnce) {
  const std::string script = directory_ + "/worker", key_file = directory_ + "/key";
  std::ofstream(script) << "#!/bin/sh\nprintf %s \"$PENUMBRA_WORKER_KEY\" > " << key_file << ".new\nmv "
                        << key_file << ".new " << key_file << "\nexec sleep 1000\n";
  ASSERT_EQ(chmod(script.c_str(), 0700), 0);
  WorkerProcesses processes({.program = script, .arguments = {}, .environment = {}}, 1);
  processes.start_missing(0);
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(key_file); }, kLong));
  const std::string key = file_contents(key_file);
  EXPECT_THAT(key, SizeIs(32));
  EXPECT_EQ(processes.claim(""), 0);
  EXPECT_EQ(processes.claim(key + "0"), 0);
  const std::vector<pid_t> children = children_of(getpid());
  ASSERT_THAT(children, SizeIs(1));
  EXPECT_EQ(processes.claim(key), children[0]);
  EXPECT_EQ(processes.claim(key), 0);
}

}  // namespace
}  // namespace penumbra
