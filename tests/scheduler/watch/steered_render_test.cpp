// Interactive renders: watchers request cameras and sample counts. Connections are real, workers are fakes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

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
using testing::SizeIs;

class SteeredRenderTest : public WatchedRunTest {
 protected:
  /// Control without a client that skips what is outdated.
  grpc::Status control(const wire::ControlRequest& request, wire::ControlReply& reply) {
    if (stub_ == nullptr) stub_ = wire::Farm::NewStub(open_channel(address()));
    grpc::ClientContext context;
    return stub_->Control(&context, request, &reply);
  }
  std::uint32_t change_view(float shift) {
    wire::ControlRequest request;
    encode(view_at(shift), *request.mutable_change_view());
    wire::ControlReply reply;
    EXPECT_TRUE(control(request, reply).ok());
    return reply.view();
  }
  void want_samples(std::uint32_t view, std::uint32_t spp) {
    wire::ControlRequest request;
    request.mutable_want_samples()->set_view(view);
    request.mutable_want_samples()->set_spp(spp);
    wire::ControlReply reply;
    EXPECT_TRUE(control(request, reply).ok());
  }
  static void expect_film(const RenderOutcome& outcome, std::uint32_t spp, float shift) {
    EXPECT_EQ(outcome.film.hash(), expected_film(spp, 1, shift).hash());
  }

  std::unique_ptr<wire::Farm::Stub> stub_;
};

TEST_F(SteeredRenderTest, NothingIsRenderedUntilSamplesAreWanted) {
  Onlooker onlooker(address());
  BackgroundRun run(interactive_job());
  ASSERT_TRUE(onlooker.sees_workers(2));
  ASSERT_TRUE(onlooker.job);
  EXPECT_TRUE(onlooker.job->interactive);
  ASSERT_NE(onlooker.scene, nullptr);
  EXPECT_EQ(onlooker.scene->header.film.width, 200);
  // Some ticks of the scheduler.
  EXPECT_FALSE(onlooker.sees([&] { return !onlooker.tiles.empty(); }, 300ms));
  EXPECT_EQ(onlooker.progress.samples_wanted, 0u);
  EXPECT_TRUE(onlooker.progress.finished);
  EXPECT_FALSE(onlooker.progress.ended);
  EXPECT_EQ(run.stop().units_done, 0u);
}

TEST_F(SteeredRenderTest, SamplesOneByOneGiveTheFilmOfABatch) {
  Onlooker onlooker(address());
  BackgroundRun run(interactive_job());
  ASSERT_TRUE(onlooker.sees_connection());
  constexpr std::uint32_t kSamples = 5;
  for (std::uint32_t spp = 1; spp <= kSamples; ++spp) {
    onlooker.client.want_samples(spp);
    ASSERT_TRUE(onlooker.sees_samples(spp)) << spp;
    onlooker.expect_tiles_of(expected_film(spp, 1));
  }
  const RenderOutcome outcome = run.stop();
  expect_film(outcome, kSamples, 0);
  EXPECT_EQ(outcome.units_done, kSamples * kTiles) << "and no unit more";
  LocalRender batch = batch_job();
  batch.spp = kSamples;
  batch.request.plan.samples_per_pass = 1;
  EXPECT_EQ(BackgroundRun(batch).wait().film.hash(), outcome.film.hash());
}

TEST_F(SteeredRenderTest, NoTileOfAnOlderViewIsTakenAfterAChange) {
  Onlooker onlooker(address());
  BackgroundRun run(interactive_job());
  ASSERT_TRUE(onlooker.sees_connection());
  for (int i = 1; i <= 12; ++i) {
    // Halfway through a view, with tiles in every part of the way. The onlooker checks each.
    onlooker.client.want_samples(kSpp);
    ASSERT_TRUE(onlooker.sees([&] { return onlooker.tiles.size() > 5; }));
    onlooker.change_view(10.0f * float(i));
  }
  onlooker.client.want_samples(3);
  ASSERT_TRUE(onlooker.sees_samples(3));
  expect_film(run.stop(), 3, 120);
}

TEST_F(SteeredRenderTest, AClientKnowsItsOwnViewFromOthers) {
  Onlooker steering(address()), other(address());
  BackgroundRun run(interactive_job());
  ASSERT_TRUE(steering.sees([&] { return steering.view.has_value(); }));
  ASSERT_TRUE(other.sees([&] { return other.view.has_value(); }));
  EXPECT_FALSE(steering.client.is_own(*steering.view)) << "the scene's";
  steering.change_view(10);
  for (Onlooker* onlooker : {&steering, &other})
    ASSERT_TRUE(onlooker->sees([&] { return onlooker->view->number == 1; }));
  EXPECT_TRUE(steering.client.is_own(*steering.view));
  EXPECT_FALSE(other.client.is_own(*other.view));
  // The same camera again is another view all the same: samples begin anew.
  other.change_view(10);
  ASSERT_TRUE(steering.sees([&] { return steering.view->number == 2; }));
  EXPECT_FALSE(steering.client.is_own(*steering.view));
}

TEST_F(SteeredRenderTest, LateResultsOfSlowWorkersForOldViewsAreIgnored) {
  FakeBehaviour{.delay_ms = 150}.to_environment();
  LocalRender job = interactive_job();
  job.request.plan.tile = 64;
  Onlooker onlooker(address());
  BackgroundRun run(job);
  ASSERT_TRUE(onlooker.sees_workers(2));
  onlooker.client.want_samples(4);
  ASSERT_TRUE(onlooker.sees([&] { return !onlooker.tiles.empty(); })) << "workers have units in hand";
  onlooker.change_view(10);
  onlooker.client.want_samples(2);
  ASSERT_TRUE(onlooker.sees([&] { return onlooker.progress.finished && onlooker.progress.spp_done == 2; }));
  const RenderOutcome outcome = run.stop();
  expect_film(outcome, 2, 10);
  EXPECT_THAT(outcome.problems, IsEmpty());
  EXPECT_THAT(outcome.workers, SizeIs(2)) << "no worker was dismissed for its old units";
}

TEST_F(SteeredRenderTest, ManyViewsInARowEndInTheLast) {
  for (const int delay : {0, 20}) {
    SCOPED_TRACE(delay);
    FakeBehaviour{.delay_ms = delay}.to_environment();
    LocalRender job = interactive_job();
    job.request.plan.tile = 64;
    Onlooker onlooker(address());
    BackgroundRun run(job);
    ASSERT_TRUE(onlooker.sees_workers(2));
    std::uint32_t last = 0;
    for (int i = 1; i <= 50; ++i) {
      const std::uint32_t number = change_view(10.0f * float(i));
      EXPECT_EQ(number, last + 1);
      last = number;
      want_samples(number, 3);
      onlooker.look();
      std::this_thread::sleep_for(std::chrono::milliseconds(i % 7));
    }
    ASSERT_TRUE(onlooker.sees([&] {
      return onlooker.view && onlooker.view->number == last && onlooker.progress.finished &&
             onlooker.progress.spp_done == 3;
    }));
    EXPECT_EQ(onlooker.view->view.camera.origin.x, 500);
    const RenderOutcome outcome = run.stop();
    expect_film(outcome, 3, 500);
    EXPECT_THAT(outcome.problems, IsEmpty());
    EXPECT_THAT(outcome.workers, SizeIs(2));
    stub_.reset();
  }
}

TEST_F(SteeredRenderTest, TheClientSkipsViewsThatAreOutdatedBeforeTheyAreSent) {
  Onlooker onlooker(address());
  BackgroundRun run(interactive_job());
  ASSERT_TRUE(onlooker.sees_workers(2));
  for (int i = 1; i <= 200; ++i) onlooker.change_view(10.0f * float(i));
  onlooker.client.want_samples(2);
  ASSERT_TRUE(onlooker.sees_samples(2));
  EXPECT_LT(onlooker.view->number, 200u);
  EXPECT_EQ(onlooker.view->view.camera.origin.x, 2000);
  expect_film(run.stop(), 2, 2000);
}

TEST_F(SteeredRenderTest, TwoCanSteerOneRender) {
  Onlooker a(address()), b(address());
  BackgroundRun run(interactive_job());
  ASSERT_TRUE(a.sees_connection());
  ASSERT_TRUE(b.sees_connection());
  a.change_view(10);
  ASSERT_TRUE(b.sees([&] { return b.view && b.view->view.camera.origin.x == 10; }));
  b.client.want_samples(1);
  ASSERT_TRUE(a.sees_samples(1));
  ASSERT_TRUE(b.sees_samples(1));
  a.client.want_samples(2);
  ASSERT_TRUE(b.sees_samples(2));
  a.awaited_shift.reset();
  b.change_view(20);
  ASSERT_TRUE(a.sees([&] { return a.view && a.view->view.camera.origin.x == 20; }));
  a.client.want_samples(3);
  ASSERT_TRUE(a.sees_samples(3));
  ASSERT_TRUE(b.sees_samples(3));
  a.expect_tiles_of(expected_film(3, 1, 20));
  b.expect_tiles_of(expected_film(3, 1, 20));
  expect_film(run.stop(), 3, 20);
}

TEST_F(SteeredRenderTest, SamplesForAnOldViewAreNotRendered) {
  Onlooker onlooker(address());
  BackgroundRun run(interactive_job());
  ASSERT_TRUE(onlooker.sees_workers(2));
  const std::uint32_t old = change_view(10), present = change_view(20);
  want_samples(old, 5);
  want_samples(present + 1, 5);
  EXPECT_FALSE(onlooker.sees([&] { return !onlooker.tiles.empty(); }, 300ms));
  EXPECT_EQ(onlooker.progress.samples_wanted, 0u);
  want_samples(present, 1);
  ASSERT_TRUE(onlooker.sees_samples(1));
  expect_film(run.stop(), 1, 20);
}

TEST_F(SteeredRenderTest, MoreSamplesThanTheJobHasAreCut) {
  Onlooker onlooker(address());
  BackgroundRun run(interactive_job());
  ASSERT_TRUE(onlooker.sees_connection());
  onlooker.client.want_samples(1000000);
  ASSERT_TRUE(onlooker.sees_samples(kSpp));
  ASSERT_TRUE(
      onlooker.sees([&] { return onlooker.progress.finished && onlooker.progress.spp_done == kSpp; }));
  EXPECT_EQ(onlooker.progress.spp_wanted, kSpp);
  EXPECT_EQ(onlooker.progress.samples_wanted, std::uint64_t(kWidth) * kHeight * kSpp);
  expect_film(run.stop(), kSpp, 0);
}

TEST_F(SteeredRenderTest, NonsenseIsRefusedAndChangesNothing) {
  Onlooker onlooker(address());
  BackgroundRun run(interactive_job());
  ASSERT_TRUE(onlooker.sees_connection());
  wire::ControlReply reply;
  EXPECT_EQ(control({}, reply).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  wire::ControlRequest request;
  encode(view_at(std::numeric_limits<float>::infinity()), *request.mutable_change_view());
  const grpc::Status status = control(request, reply);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("a view whose camera.origin is not finite"));
  want_samples(0, 0);
  onlooker.client.want_samples(1);
  ASSERT_TRUE(onlooker.sees_samples(1));
  expect_film(run.stop(), 1, 0);
}

TEST_F(SteeredRenderTest, AKilledWorkerIsReplacedAndTheSamplesComeAllTheSame) {
  FakeBehaviour{.delay_ms = 10}.to_environment();
  Onlooker onlooker(address());
  BackgroundRun run(interactive_job());
  ASSERT_TRUE(onlooker.sees_workers(2));
  onlooker.change_view(10);
  onlooker.client.want_samples(5);
  ASSERT_TRUE(onlooker.sees([&] { return onlooker.tiles.size() > 3; }));
  const std::vector<pid_t> workers = children_of(getpid());
  ASSERT_THAT(workers, SizeIs(2));
  kill(workers[0], SIGKILL);
  ASSERT_TRUE(onlooker.sees_samples(5));
  ASSERT_TRUE(onlooker.sees([&] { return !onlooker.said.empty(); }));
  EXPECT_THAT(onlooker.said, Contains(HasSubstr(fmt::format("{} was lost", workers[0]))));
  ASSERT_TRUE(onlooker.sees_workers(2)) << "another worker takes its place";
  // The new one knows the view, too: it takes part in what follows.
  onlooker.client.want_samples(kSpp);
  ASSERT_TRUE(onlooker.sees_samples(kSpp));
  expect_film(run.stop(), kSpp, 10);
}

TEST_F(SteeredRenderTest, ItEndsByItsStopAlone) {
  Onlooker onlooker(address());
  BackgroundRun run(interactive_job());
  ASSERT_TRUE(onlooker.sees_connection());
  onlooker.client.want_samples(kSpp);
  ASSERT_TRUE(onlooker.sees_samples(kSpp));
  EXPECT_FALSE(onlooker.sees([&] { return onlooker.ended; }, 300ms)) << "all that is wanted is no end";
  run.stop();
  EXPECT_TRUE(onlooker.sees([&] { return onlooker.losses == 1; })) << "another scheduler may follow";
  EXPECT_FALSE(onlooker.ended);
  EXPECT_FALSE(onlooker.progress.ended);
}

}  // namespace
}  // namespace penumbra
