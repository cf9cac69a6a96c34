// Watched renders. Worker processes and connections are real; only the device is a fake.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <list>

#include "penumbra.grpc.pb.h"
#include "tests/scheduler/watch/watched_run.h"
#include "tests/support/fake_processes.h"
#include "worker/protocol/client.h"
#include "worker/protocol/wire.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

class WatchedRenderTest : public WatchedRunTest {};

TEST_F(WatchedRenderTest, EveryWatcherEndsWithTheFilm) {
  FakeBehaviour{.delay_ms = 2}.to_environment();
  std::list<Onlooker> onlookers;
  for (int i = 0; i < 3; ++i) onlookers.emplace_back(address());
  // The render waits for the three, so that it is not over before they are there.
  std::promise<void> all_there;
  std::future<void> there = all_there.get_future();
  BackgroundRun run(batch_job(), [&](const RenderProgress&) {
    if (there.valid()) there.get();
  });
  for (Onlooker& onlooker : onlookers) EXPECT_TRUE(onlooker.sees_connection());
  all_there.set_value();
  for (Onlooker& onlooker : onlookers) EXPECT_TRUE(onlooker.sees_end());
  const RenderOutcome outcome = run.wait();
  EXPECT_TRUE(outcome.complete);
  EXPECT_EQ(outcome.film.hash(), expected_film(kSpp, 4).hash());
  for (Onlooker& onlooker : onlookers) {
    onlooker.expect_tiles_of(outcome.film);
    EXPECT_EQ(onlooker.connections, 1);
    EXPECT_EQ(onlooker.losses, 0);
    EXPECT_THAT(onlooker.refused, IsEmpty());
    ASSERT_TRUE(onlooker.job);
    EXPECT_EQ(onlooker.job->title, "a.xml");
    EXPECT_EQ(onlooker.job->film_width, 200);
    EXPECT_EQ(onlooker.job->x, kX);
    EXPECT_EQ(onlooker.job->width, kWidth);
    EXPECT_FALSE(onlooker.job->interactive);
    EXPECT_EQ(onlooker.scene, nullptr) << "it would be of no use";
    EXPECT_TRUE(onlooker.progress.ended);
    EXPECT_TRUE(onlooker.progress.finished);
    EXPECT_EQ(onlooker.progress.samples_done, std::uint64_t(kWidth) * kHeight * kSpp);
    EXPECT_EQ(onlooker.progress.spp_done, kSpp);
    EXPECT_EQ(onlooker.progress.spp_wanted, kSpp);
    EXPECT_EQ(onlooker.progress.relative_error, outcome.film.relative_error());
  }
}

TEST_F(WatchedRenderTest, WhoComesLateEndsWithTheFilmToo) {
  FakeBehaviour{.delay_ms = 2}.to_environment();
  std::optional<Onlooker> late;
  BackgroundRun run(batch_job(), [&](const RenderProgress& progress) {
    if (late || progress.samples_done == 0) return;
    late.emplace(address());
    while (late->connections == 0) late->look();
  });
  const RenderOutcome outcome = run.wait();
  ASSERT_TRUE(late);
  EXPECT_TRUE(late->sees_end());
  late->expect_tiles_of(outcome.film);
}

TEST_F(WatchedRenderTest, AWatcherThatNeverReadsDelaysAndChangesNothing) {
  FakeBehaviour{.delay_ms = 4}.to_environment();
  LocalRender job = batch_job();
  job.request.plan.tile = 64;  // more than a stream's window in every pass
  job.spp = 200;
  const RenderOutcome unwatched = BackgroundRun(job).wait();
  const auto channel = open_channel(address());
  const auto stub = wire::Farm::NewStub(channel);
  wire::WatchRequest request;
  request.set_protocol_version(kProtocolVersion);
  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientReader<wire::WatchEvent>> never_read;
  std::optional<Onlooker> reads;
  BackgroundRun run(job, [&](const RenderProgress&) {
    if (never_read != nullptr) return;
    EXPECT_TRUE(channel->WaitForConnected(std::chrono::system_clock::now() + kLong));
    never_read = stub->Watch(&context, request);
    reads.emplace(address());
    while (reads->connections == 0) reads->look();
  });
  const RenderOutcome watched = run.wait();
  EXPECT_TRUE(watched.complete);
  EXPECT_EQ(watched.film.hash(), unwatched.film.hash());
  // Twice the time and some: a machine with other work, but no wait for a watcher.
  EXPECT_LT(watched.seconds_to_last_tile, 2 * unwatched.seconds_to_last_tile + 2);
  EXPECT_LT(watched.seconds, 2 * unwatched.seconds + 3) << "it is given up soon at the end";
  ASSERT_TRUE(reads);
  reads->look();
  EXPECT_TRUE(reads->sees_end()) << "the other one sees all";
  context.TryCancel();
}

TEST_F(WatchedRenderTest, ALostWorkerIsTold) {
  FakeBehaviour{.delay_ms = 10}.to_environment();
  Onlooker onlooker(address());
  BackgroundRun run(batch_job());
  ASSERT_TRUE(
      onlooker.sees([&] { return onlooker.progress.workers.size() == 2 && !onlooker.tiles.empty(); }));
  const std::vector<pid_t> workers = children_of(getpid());
  ASSERT_FALSE(workers.empty());
  kill(workers[0], SIGKILL);
  EXPECT_TRUE(onlooker.sees_end());
  EXPECT_THAT(onlooker.said, Contains(HasSubstr(fmt::format("{} was lost", workers[0]))));
  onlooker.expect_tiles_of(run.wait().film);
}

TEST_F(WatchedRenderTest, ARenderThatIsNotInteractiveRefusesControlInWords) {
  FakeBehaviour{.delay_ms = 10}.to_environment();
  Onlooker onlooker(address());
  BackgroundRun run(batch_job());
  ASSERT_TRUE(onlooker.sees([&] { return onlooker.view.has_value(); }));
  const auto stub = wire::Farm::NewStub(open_channel(address()));
  for (const bool view : {true, false}) {
    wire::ControlRequest request;
    if (view) encode(view_at(1), *request.mutable_change_view());
    if (!view) request.mutable_want_samples()->set_spp(5);
    grpc::ClientContext context;
    wire::ControlReply reply;
    const grpc::Status status = stub->Control(&context, request, &reply);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
    EXPECT_THAT(status.error_message(), HasSubstr("it can be watched only"));
  }
  onlooker.client.change_view(view_at(3));
  EXPECT_TRUE(onlooker.sees([&] { return !onlooker.said.empty(); }));
  EXPECT_THAT(onlooker.said, Contains(HasSubstr("the scheduler refused: this render goes its own way")));
  EXPECT_TRUE(onlooker.sees_end());
  onlooker.expect_tiles_of(run.wait().film);  // nothing has changed
}

TEST_F(WatchedRenderTest, AKilledSchedulerIsLostAndTheNextOneAtItsPlaceIsFound) {
  FakeBehaviour{.delay_ms = 20}.to_environment();
  const std::string listen = address();
  const auto start = [&] {
    const pid_t scheduler = fork();
    if (scheduler == 0) {
      execl(PENUMBRA_BINARY_DIR "/fake_scheduler", "fake_scheduler", PENUMBRA_BINARY_DIR "/fake_worker",
            listen.c_str(), nullptr);
      _exit(127);
    }
    return scheduler;
  };
  const auto end = [](pid_t scheduler) {
    kill(scheduler, SIGKILL);
    waitpid(scheduler, nullptr, 0);
  };
  Onlooker onlooker(listen);
  const pid_t first = start();
  EXPECT_TRUE(onlooker.sees([&] { return onlooker.connections == 1 && !onlooker.tiles.empty(); }));
  end(first);
  EXPECT_TRUE(onlooker.sees([&] { return onlooker.losses > 0; }));
  EXPECT_FALSE(onlooker.ended);
  const pid_t second = start();
  EXPECT_TRUE(onlooker.sees([&] { return onlooker.connections == 2 && !onlooker.tiles.empty(); }));
  end(second);
  EXPECT_TRUE(onlooker.sees([&] { return onlooker.losses > 1; }));
}

}  // namespace
}  // namespace penumbra
