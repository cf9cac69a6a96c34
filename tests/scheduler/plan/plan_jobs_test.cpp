// Tests each rule of the plan about several jobs and their phases.
#include "tests/scheduler/plan/plan_fixture.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

class PlanJobsTest : public PlanTest {
 protected:
  void prepared(WorkerId worker, JobId job) { tell(WorkerPrepared{worker, job}); }
  std::vector<std::pair<WorkerId, JobId>> to_prepare() const {
    return all<Prepare, std::pair<WorkerId, JobId>>(
        [](const Prepare& p) { return std::pair(p.worker, p.job); });
  }
  std::vector<std::pair<WorkerId, JobId>> to_forget() const {
    return all<Forget, std::pair<WorkerId, JobId>>(
        [](const Forget& f) { return std::pair(f.worker, f.job); });
  }
  std::vector<std::pair<JobId, std::uint32_t>> phases_done() const {
    return all<PhaseDone, std::pair<JobId, std::uint32_t>>(
        [](const PhaseDone& p) { return std::pair(p.job, p.phase); });
  }
  std::vector<JobId> nobody_can() const {
    return all<NoCapableWorker, JobId>([](const NoCapableWorker& n) { return n.job; });
  }
};

TEST_F(PlanJobsTest, JobsFollowEachOther) {
  start(1, 2);
  add(2, {{2, 1}});
  join(1);
  std::vector<UnitId> order;
  while (!plan_->finished()) {
    order.push_back(held_[1].front());
    work(1);
  }
  EXPECT_THAT(order, ElementsAre(unit(0, 0, 1), unit(1, 0, 1), unit(0, 0, 2), unit(0, 1, 2)));
}

TEST_F(PlanJobsTest, AWorkerGetsNothingBeforeItIsPrepared) {
  prepares_at_once_ = false;
  start(4, 1);
  join(1);
  EXPECT_THAT(to_prepare(), ElementsAre(Pair(1, kJob)));
  EXPECT_THAT(assigned(), IsEmpty());
  for (int i = 0; i < 300; ++i) {
    tell(Alive{1});
    wait(1);
  }
  EXPECT_THAT(dismissed(), IsEmpty()) << "it compiles";
  prepared(1, 2);
  EXPECT_THAT(assigned(), IsEmpty()) << "it was not asked for that";
  prepared(1, kJob);
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(0, 0)), Pair(1, unit(0, 1))));
}

TEST_F(PlanJobsTest, AWorkerPreparesTheNextJobBehindWhatItHolds) {
  prepares_at_once_ = false;
  start(3, 1);
  add(2, {{5, 1}});
  join(1);
  prepared(1, kJob);
  EXPECT_THAT(held_[1], ElementsAre(unit(0, 0), unit(0, 1)));
  done(1, unit(0, 0));
  EXPECT_THAT(to_prepare(), IsEmpty()) << "there is work that it knows";
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(0, 2))));
  done(1, unit(0, 1));
  EXPECT_THAT(to_prepare(), ElementsAre(Pair(1, 2)));
  EXPECT_THAT(assigned(), IsEmpty());
  done(1, unit(0, 2));
  EXPECT_THAT(assigned(), IsEmpty());
  prepared(1, 2);
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(0, 0, 2)), Pair(1, unit(0, 1, 2))));
}

TEST_F(PlanJobsTest, AnIdleWorkerPreparesInAdvance) {
  prepares_at_once_ = false;
  start(1, 1);
  join(1);
  prepared(1, kJob);
  add(2, {{4, 0}});
  EXPECT_THAT(to_prepare(), IsEmpty()) << "it is busy";
  join(2);
  EXPECT_THAT(to_prepare(), ElementsAre(Pair(2, kJob))) << "to take over if need be";
  prepared(2, kJob);
  EXPECT_THAT(to_prepare(), ElementsAre(Pair(2, 2)));
  prepared(2, 2);
  add(3, {{4, 0}});
  EXPECT_THAT(to_prepare(), IsEmpty()) << "its memory is for " << kJobsPerWorker;
  tell(MorePasses{2, 1});
  EXPECT_THAT(assigned(), ElementsAre(Pair(2, unit(0, 0, 2)), Pair(2, unit(0, 1, 2))));
}

TEST_F(PlanJobsTest, ThirdJobsTakeThePlaceOfTheLast) {
  start(1, 0);
  add(2, {{1, 0}});
  join(1);  // knows both
  add(3, {{1, 1}});
  EXPECT_THAT(to_forget(), ElementsAre(Pair(1, 2)));
  EXPECT_THAT(to_prepare(), ElementsAre(Pair(1, 3)));
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(0, 0, 3))));
}

TEST_F(PlanJobsTest, AHigherPriorityGoesFirst) {
  start(9, 1);
  join(1);
  add(2, {{1, 1}}, 5);
  EXPECT_THAT(assigned(), IsEmpty()) << "its hands are full";
  done(1, unit(0, 0));
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(0, 0, 2))));
  add(3, {{3, 1}}, -1);
  tell(PriorityChanged{3, 1});
  done(1, unit(0, 1));
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(0, 0, 3))));
  tell(PriorityChanged{3, -1});
  done(1, unit(0, 0, 2));
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(0, 2)))) << "back to what came first";
}

TEST_F(PlanJobsTest, OfARemovedJobNothingIsLeft) {
  start(4, 1);
  add(2, {{2, 1}});
  join(1);
  tell(JobRemoved{kJob});
  EXPECT_THAT(to_forget(), ElementsAre(Pair(1, kJob)));
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(0, 0, 2)), Pair(1, unit(0, 1, 2))));
  EXPECT_EQ(plan_->units_left(), 2u);
  held_[1] = {unit(0, 0, 2), unit(0, 1, 2)};
  work(1);
  work(1);
  EXPECT_TRUE(plan_->finished());
}

TEST_F(PlanJobsTest, AJobThatIsRemovedWhileItIsPreparedIsForgotten) {
  prepares_at_once_ = false;
  start(4, 1);
  join(1);
  tell(JobRemoved{kJob});
  EXPECT_THAT(to_forget(), ElementsAre(Pair(1, kJob)));
  prepared(1, kJob);  // it was on its way
  EXPECT_THAT(last_, IsEmpty());
  add(2, {{1, 1}});
  EXPECT_THAT(to_prepare(), ElementsAre(Pair(1, 2)));
}

TEST_F(PlanJobsTest, ARestartedJobBeginsAnewInTheHandsOfThoseWhoKnowIt) {
  start(3, 2);
  join(1);
  work(1);
  tell(JobRestarted{kJob});
  EXPECT_EQ(plan_->units_left(), 6u);
  EXPECT_EQ(plan_->counts(kJob).done, 0u);
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(0, 0)), Pair(1, unit(0, 1))));
}

TEST_F(PlanJobsTest, PhasesHaveABarrierBetweenThem) {
  plan_.emplace(LeaseRule{.silence = kNever});
  add(kJob, {{2, 1}, {1, 2}});
  join(1);
  join(2);
  work(1);
  EXPECT_THAT(phases_done(), IsEmpty());
  work(1);
  EXPECT_THAT(phases_done(), ElementsAre(Pair(kJob, 0u)));
  EXPECT_THAT(assigned(), IsEmpty()) << "what the phase made is not there yet";
  EXPECT_FALSE(plan_->finished(kJob));
  tell(PhaseOpened{kJob, 1});
  ASSERT_FALSE(assigned().empty());
  EXPECT_EQ(assigned().front().second, unit(0, 0, kJob, 1));
}

TEST_F(PlanJobsTest, AnEmptyPhaseIsDoneAtOnce) {
  plan_.emplace();
  add(kJob, {{0, 1}, {1, 1}});
  EXPECT_THAT(phases_done(), ElementsAre(Pair(kJob, 0u)));
}

TEST_F(PlanJobsTest, AJobStartsAgainIfAnEarlierPhaseCannotBeTrusted) {
  plan_.emplace(LeaseRule{.silence = kNever});
  add(kJob, {{1, 1}, {1, 1}});
  join(1);
  done(1, unit(0, 0));
  tell(PhaseOpened{kJob, 1});
  now_ += kFirstStragglerAge;
  join(2);  // takes a copy
  ASSERT_EQ(held_[2].at(0), unit(0, 0, kJob, 1));
  done(1, unit(0, 0, kJob, 1), 7);
  done(2, unit(0, 0, kJob, 1), 8);
  EXPECT_THAT((all<RestartJob, JobId>([](const RestartJob& s) { return s.job; })), ElementsAre(kJob));
  EXPECT_THAT(tiles_to_redo(), IsEmpty());
  EXPECT_EQ(plan_->units_left(), 2u);
  join(3);
  EXPECT_THAT(assigned(), ElementsAre(Pair(3, unit(0, 0))));
}

TEST_F(PlanJobsTest, AWorkerThatNeverEndsPreparingIsDismissed) {
  prepares_at_once_ = false;
  start(4, 1);
  join(1);
  for (int i = 0; i < 312; ++i) {
    EXPECT_THAT(dismissed(), IsEmpty()) << i;
    tell(Alive{1});
    wait(1);
    if (!dismissed().empty()) break;
  }
  EXPECT_THAT(dismissed(), ElementsAre(Pair(1, Fault::kUnprepared)));
}

TEST_F(PlanJobsTest, AWorkerThatIsSilentWhilePreparingIsDismissed) {
  prepares_at_once_ = false;
  start(2, 1);
  add(2, {{2, 1}});
  join(1);
  prepared(1, kJob);
  done(1, unit(0, 0));  // the next job is prepared behind the unit in hand
  ASSERT_THAT(to_prepare(), ElementsAre(Pair(1, 2)));
  wait(100);
  EXPECT_THAT(dismissed(), IsEmpty()) << "the unit in hand has its own lease";
  done(1, unit(0, 1));
  wait(1);
  wait(39);
  EXPECT_THAT(dismissed(), IsEmpty());
  wait(1);
  EXPECT_THAT(dismissed(), ElementsAre(Pair(1, Fault::kUnprepared)));
}

TEST_F(PlanJobsTest, AJobThatDoesNotFitBesideAnotherIsTriedAlone) {
  prepares_at_once_ = false;
  start(2, 1);
  add(2, {{1, 1}});
  join(1);
  prepared(1, kJob);
  done(1, unit(0, 0));
  ASSERT_THAT(to_prepare(), ElementsAre(Pair(1, 2)));
  tell(WorkerUnfit{1, 2});
  EXPECT_THAT(nobody_can(), IsEmpty());
  EXPECT_THAT(to_prepare(), IsEmpty()) << "a unit of the other is in hand";
  done(1, unit(0, 1));
  EXPECT_THAT(to_forget(), ElementsAre(Pair(1, kJob)));
  EXPECT_THAT(to_prepare(), ElementsAre(Pair(1, 2)));
  tell(WorkerUnfit{1, 2});
  EXPECT_THAT(nobody_can(), ElementsAre(2)) << "not even so";
}

TEST_F(PlanJobsTest, AJobWhoseLastCapableWorkerLeavesIsSaid) {
  prepares_at_once_ = false;
  start(4, 1);
  join(1);
  tell(WorkerUnfit{1, kJob});
  EXPECT_THAT(nobody_can(), ElementsAre(kJob));
  join(2);
  prepared(2, kJob);
  lose(2);
  EXPECT_THAT(nobody_can(), ElementsAre(kJob));
}

TEST_F(PlanJobsTest, AJobThatWorkersDieOfPreparingIsSaid) {
  prepares_at_once_ = false;
  start(4, 1);
  for (WorkerId worker = 1; worker <= 3; ++worker) {
    join(worker);
    EXPECT_THAT(nobody_can(), IsEmpty());
    lose(worker);
  }
  EXPECT_THAT(nobody_can(), ElementsAre(kJob));
}

TEST_F(PlanJobsTest, DeathsOfPreparingARemovedJobAreNotTheNextOnes) {
  prepares_at_once_ = false;
  start(4, 1);
  for (WorkerId worker = 1; worker <= 6; ++worker) join(worker);
  for (WorkerId worker = 1; worker <= 3; ++worker) lose(worker);
  ASSERT_THAT(nobody_can(), ElementsAre(kJob));
  add(2, {{1, 1}});
  tell(JobRemoved{kJob});
  EXPECT_THAT(to_prepare(), IsEmpty()) << "they are still busy with the other";
  for (WorkerId worker = 4; worker <= 6; ++worker) {
    lose(worker);
    EXPECT_THAT(nobody_can(), IsEmpty());
  }
  join(7);
  ASSERT_THAT(to_prepare(), ElementsAre(Pair(7, 2)));
  prepared(7, 2);
  EXPECT_THAT(assigned(), ElementsAre(Pair(7, unit(0, 0, 2))));
}

TEST_F(PlanJobsTest, AWorkerThatPreparesARemovedJobGetsWorkWhenItHasSaidThatItIsDone) {
  prepares_at_once_ = false;
  start(4, 1);
  add(2, {{1, 1}});
  join(1);
  tell(JobRemoved{kJob});
  EXPECT_THAT(to_forget(), ElementsAre(Pair(1, kJob)));
  EXPECT_THAT(to_prepare(), IsEmpty());
  prepared(1, kJob);
  EXPECT_THAT(to_prepare(), ElementsAre(Pair(1, 2)));
  EXPECT_THAT(assigned(), IsEmpty());
}

TEST_F(PlanJobsTest, AJobThatNobodyCanDoIsSaidAndTheOthersGoOn) {
  prepares_at_once_ = false;
  start(1, 1);
  add(2, {{1, 1}});
  join(1);
  join(2);
  tell(WorkerUnfit{1, kJob});
  EXPECT_THAT(nobody_can(), IsEmpty()) << "the other worker may";
  EXPECT_THAT(to_prepare(), ElementsAre(Pair(1, 2)));
  tell(WorkerUnfit{2, kJob});
  EXPECT_THAT(nobody_can(), ElementsAre(kJob));
  tell(JobRemoved{kJob});
  prepared(1, 2);
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(0, 0, 2))));
}

// --- Jobs that kill whoever renders them

TEST_F(PlanJobsTest, AJobThatKillsEveryWorkerAtItsUnitsIsTold) {
  start(9, 5);
  for (WorkerId id = 1; id < 7; ++id) {
    join(id);
    lose(id);
    EXPECT_THAT(nobody_can(), IsEmpty()) << id;
  }
  join(7);
  lose(7);
  EXPECT_THAT(nobody_can(), ElementsAre(kJob));
}

TEST_F(PlanJobsTest, DeathsBetweenFinishedUnitsAreNoReasonToGiveUp) {
  start(9, 5);
  for (WorkerId id = 1; id < 30; ++id) {
    join(id);
    if (id % 4 == 0) work(id);
    lose(id);
    EXPECT_THAT(nobody_can(), IsEmpty()) << id;
  }
}

TEST_F(PlanJobsTest, WhileOthersRenderItAJobIsNotToBlameForThoseThatDieOfPreparingIt) {
  start(9, 5);
  join(1);
  for (WorkerId id = 2; id < 9; ++id) {
    prepares_at_once_ = false;
    join(id);
    lose(id);
    EXPECT_THAT(nobody_can(), IsEmpty()) << id;
  }
}

}  // namespace
}  // namespace penumbra
