// Tests each rule of the plan about the units of one job.
#include "tests/scheduler/plan/plan_fixture.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;

TEST_F(PlanTest, AWorkerGetsOneUnitInHandAndOneOnTheWay) {
  start(4, 1);
  join(1);
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(0, 0)), Pair(1, unit(0, 1))));
  EXPECT_EQ(plan_->in_hand(1), unit(0, 0));
  EXPECT_EQ(plan_->in_hand(2), std::nullopt);
  done(1, unit(0, 0));
  EXPECT_THAT(merged(), ElementsAre(unit(0, 0)));
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(0, 2))));
}

TEST_F(PlanTest, UnitsAreIssuedPassByPass) {
  start(3, 2);
  join(1);
  std::vector<UnitId> order;
  while (!plan_->finished()) {
    order.push_back(held_[1].front());
    work(1);
  }
  EXPECT_THAT(order, ElementsAre(unit(0, 0), unit(0, 1), unit(0, 2), unit(1, 0), unit(1, 1), unit(1, 2)));
  EXPECT_EQ(plan_->counts(kJob).done, 6u);
  EXPECT_EQ(plan_->counts(kJob).requeued, 0u);
  EXPECT_EQ(plan_->counts(kJob).duplicated, 0u);
}

TEST_F(PlanTest, NothingToDoIsFinished) {
  start(0, 5);
  add(2, {{3, 0}});
  EXPECT_TRUE(plan_->finished());
  join(1);
  EXPECT_THAT(assigned(), IsEmpty());
}

TEST_F(PlanTest, ALostWorkersUnitsAreIssuedBeforeNewOnes) {
  start(9, 1);
  join(1);
  join(2);
  EXPECT_THAT(assigned(), ElementsAre(Pair(2, unit(0, 2)), Pair(2, unit(0, 3))));
  lose(1);
  EXPECT_EQ(plan_->counts(kJob).requeued, 2u);
  join(3);
  EXPECT_THAT(held_[3], ElementsAre(unit(0, 0))) << "the unit in hand is blamed and travels alone";
  done(2, unit(0, 2));
  EXPECT_THAT(assigned(), ElementsAre(Pair(2, unit(0, 1))));
}

TEST_F(PlanTest, ABlamedUnitTravelsAlone) {
  start(9, 1);
  join(1);
  lose(1);
  join(2);
  EXPECT_THAT(held_[2], ElementsAre(unit(0, 0)));
  done(2, unit(0, 0));
  EXPECT_THAT(held_[2], ElementsAre(unit(0, 1), unit(0, 2))) << "these were not blamed";
}

TEST_F(PlanTest, AWorkerEmptiesItsHandsForABlamedUnit) {
  start(9, 1);
  join(1);
  join(2);
  lose(1);  // (0, 0) is blamed
  done(2, unit(0, 2));
  EXPECT_THAT(assigned(), IsEmpty());
  done(2, unit(0, 3));
  EXPECT_THAT(assigned(), ElementsAre(Pair(2, unit(0, 0))));
}

TEST_F(PlanTest, NoJobIsPreparedAfterABlamedUnit) {
  const auto told_to_prepare = [this] { return all<Prepare, JobId>([](const Prepare& p) { return p.job; }); };
  start(1, 1);
  add(2, {{1, 1}});
  join(1);
  lose(1);
  prepares_at_once_ = false;
  join(2);
  EXPECT_THAT(told_to_prepare(), ElementsAre(kJob));
  tell(WorkerPrepared{2, kJob});
  EXPECT_THAT(held_[2], ElementsAre(unit(0, 0)));
  EXPECT_THAT(told_to_prepare(), IsEmpty()) << "if the worker dies, of the unit";
  done(2, unit(0, 0));
  EXPECT_THAT(told_to_prepare(), ElementsAre(2));
}

TEST_F(PlanTest, WorkersThatLeaveGiveBackTheirUnitAndBlameItForNothing) {
  start(1, 1);
  for (WorkerId worker = 1; worker <= 9; ++worker) {
    join(worker);
    ASSERT_THAT(held_[worker], ElementsAre(unit(0, 0))) << "at once, each time";
    held_.erase(worker);
    tell(WorkerLost{worker, true});
    EXPECT_TRUE(plan_->set_aside(kJob).empty());
  }
  join(10);
  work(10);
  EXPECT_TRUE(plan_->finished(kJob));
}

TEST_F(PlanTest, WorkersThatLeaveWhileTheyPrepareSayNothingAboutTheJob) {
  start(1, 1);
  prepares_at_once_ = false;
  for (WorkerId worker = 1; worker <= 9; ++worker) {
    join(worker);
    tell(WorkerLost{worker, true});
    const auto hopeless = all<NoCapableWorker, JobId>([](const NoCapableWorker& order) { return order.job; });
    EXPECT_TRUE(hopeless.empty());
  }
}

TEST_F(PlanTest, AUnitThatKillsThreeWorkersIsSetAsideAndTheRestCompletes) {
  start(3, 1);
  for (WorkerId worker = 1; worker <= 3; ++worker) {
    EXPECT_THAT(set_aside(), IsEmpty());
    join(worker);
    ASSERT_EQ(held_[worker].front(), unit(0, 0));
    lose(worker);
  }
  EXPECT_THAT(set_aside(), ElementsAre(unit(0, 0)));
  const auto faults =
      all<SetAside, std::vector<std::pair<WorkerId, Fault>>>([](const SetAside& s) { return s.faults; });
  EXPECT_THAT(faults.at(0), ElementsAre(Pair(1, Fault::kDied), Pair(2, Fault::kDied), Pair(3, Fault::kDied)));
  join(4);
  work(4);
  work(4);
  EXPECT_TRUE(plan_->finished());
  EXPECT_EQ(plan_->counts(kJob).done, 2u);
  EXPECT_THAT(plan_->set_aside(kJob), ElementsAre(unit(0, 0)));
}

// A worker that dies at its second unit may take the first one's result with it, again and again. The blame
// must end up with the right unit.
TEST_F(PlanTest, TheBlameFindsTheGuiltyUnitThoughTheWrongOneIsInHand) {
  start(4, 1);
  const UnitId deadly = unit(0, 1);
  WorkerId worker = 0;
  int deaths = 0;
  while (!plan_->finished() && deaths < 20) {
    join(++worker);
    while (held_.contains(worker) && !held_[worker].empty()) {
      if (held_[worker].size() > 1 && held_[worker][1] == deadly) {
        ++deaths;  // the result of the first was not sent yet
        lose(worker);
      } else if (held_[worker].front() == deadly) {
        ++deaths;
        lose(worker);
      } else {
        work(worker);
      }
    }
  }
  EXPECT_TRUE(plan_->finished());
  EXPECT_THAT(plan_->set_aside(kJob), ElementsAre(deadly));
  EXPECT_LE(deaths, 5);
}

TEST_F(PlanTest, AFailedUnitGoesToAnotherWorkerFirst) {
  start(6, 1);
  join(1);
  join(2);
  fails(1, unit(0, 0));
  EXPECT_THAT(set_aside(), IsEmpty());
  fails(1, unit(0, 1));
  work(2);
  EXPECT_THAT(held_[2], SizeIs(1)) << "it empties its hands";
  work(2);
  EXPECT_THAT(held_[2], ElementsAre(unit(0, 0)));
}

TEST_F(PlanTest, ALonelyWorkerTriesAFailedUnitAgain) {
  start(1, 1);
  join(1);
  fails(1, unit(0, 0));
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(0, 0))));
  done(1, unit(0, 0));
  EXPECT_TRUE(plan_->finished());
  EXPECT_THAT(plan_->set_aside(kJob), IsEmpty());
}

TEST_F(PlanTest, AWorkerThatFailsThreeUnitsInARowIsDismissed) {
  start(20, 1);
  join(1);
  join(2);
  fails(1, held_[1].front());
  fails(1, held_[1].front());
  EXPECT_THAT(dismissed(), IsEmpty());
  fails(1, held_[1].front());
  EXPECT_THAT(dismissed(), ElementsAre(Pair(1, Fault::kFailed)));
  held_.erase(1);
  while (!plan_->finished()) work(2);
  EXPECT_THAT(plan_->set_aside(kJob), IsEmpty()) << "the units were not to blame";
}

TEST_F(PlanTest, ASuccessForgivesEarlierFailures) {
  start(20, 1);
  join(1);
  for (int i = 0; i < 4; ++i) {
    fails(1, held_[1].front());
    EXPECT_THAT(dismissed(), IsEmpty());
    while (!held_[1].empty() && held_[1].size() < 2) work(1);
  }
}

TEST_F(PlanTest, ACorruptResultIsRedoneElsewhereAndItsWorkerDismissed) {
  start(4, 1);
  join(1);
  tell(ResultCorrupt{1, unit(0, 0)});
  EXPECT_THAT(dismissed(), ElementsAre(Pair(1, Fault::kCorrupt)));
  EXPECT_EQ(plan_->units_left(), 4u);
  lose(1);  // what follows when its stream ends
  join(2);
  while (!plan_->finished()) work(2);
  EXPECT_EQ(plan_->counts(kJob).done, 4u);
}

TEST_F(PlanTest, AnUnsolicitedResultIsNotTaken) {
  start(4, 1);
  join(1);
  done(1, unit(0, 3));
  EXPECT_THAT(merged(), IsEmpty());
  EXPECT_THAT(discarded(), ElementsAre(unit(0, 3)));
  EXPECT_THAT(dismissed(), ElementsAre(Pair(1, Fault::kCorrupt)));
}

TEST_F(PlanTest, ResultsOfUnknownWorkersAreDiscarded) {
  start(4, 1);
  done(9, unit(0, 0));
  EXPECT_THAT(merged(), IsEmpty());
  EXPECT_THAT(discarded(), ElementsAre(unit(0, 0)));
}

// --- Leases

const LeaseRule kLeases{.initial = 60, .minimum = 10, .factor = 20, .growth = 2, .silence = kNever};
const LeaseRule kWithBeats{
    .initial = 60, .minimum = 10, .factor = 20, .growth = 2, .silence = 8, .patience = 5};

TEST_F(PlanTest, ANewWorkerHasTheInitialLease) {
  start(9, 1, kLeases);
  join(1);
  wait(59.9);
  EXPECT_EQ(plan_->counts(kJob).requeued, 0u);
  wait(0.1);
  EXPECT_EQ(plan_->counts(kJob).requeued, 2u);
}

TEST_F(PlanTest, TheLeaseFollowsTheSlowestUnit) {
  start(9, 1, kLeases);
  join(1);
  now_ += 3;
  done(1, held_[1].front());
  work(1);
  wait(59.9);  // 20 x 3 s
  EXPECT_EQ(plan_->counts(kJob).requeued, 0u);
  wait(0.2);
  EXPECT_EQ(plan_->counts(kJob).requeued, 2u);
}

TEST_F(PlanTest, TheLeaseHasAMinimum) {
  start(9, 1, kLeases);
  join(1);
  now_ += 0.01;
  done(1, held_[1].front());
  wait(9.9);
  EXPECT_EQ(plan_->counts(kJob).requeued, 0u);
  wait(0.2);
  EXPECT_EQ(plan_->counts(kJob).requeued, 2u);
}

TEST_F(PlanTest, ALeaseBeginsWhenTheUnitIsInHand) {
  start(9, 1, kLeases);
  join(1);
  now_ += 50;
  done(1, unit(0, 0));
  now_ += 50;  // (0, 1) was sent 100 s ago, but begun 50 s ago
  tell(Tick{});
  EXPECT_EQ(plan_->counts(kJob).requeued, 0u);
}

TEST_F(PlanTest, AHungWorkersUnitsGoToOthersAndItGetsNoMore) {
  start(9, 1, kLeases);
  join(1);
  join(2);
  work(2);
  wait(61);
  EXPECT_EQ(plan_->counts(kJob).requeued, 2u + 2u) << "worker 2 hangs as well";
  join(3);
  EXPECT_THAT(assigned(), SizeIs(1));
  EXPECT_EQ(assigned()[0].first, 3u);
}

TEST_F(PlanTest, ALateResultOfAnOpenUnitCounts) {
  start(2, 1, kLeases);
  join(1);
  wait(61);
  done(1, unit(0, 0));
  EXPECT_THAT(merged(), ElementsAre(unit(0, 0)));
  work(1);
  EXPECT_THAT(merged(), ElementsAre(unit(0, 1)));
  EXPECT_TRUE(plan_->finished());
}

TEST_F(PlanTest, AWorkerThatComesBackGetsWorkAgain) {
  start(9, 1, kLeases);
  join(1);
  wait(61);
  done(1, unit(0, 0));
  EXPECT_THAT(held_[1], ElementsAre(unit(0, 1), unit(0, 2)));
  wait(61);
  EXPECT_THAT(dismissed(), IsEmpty()) << "its time runs anew";
}

TEST_F(PlanTest, APauseOfAWorkerDoesNotStretchTheLeases) {
  start(9, 1, kLeases);
  join(1);
  wait(61);
  done(1, unit(0, 0));
  ASSERT_EQ(plan_->counts(kJob).requeued, 2u);
  wait(10.1);  // and not 20 x 61 s
  EXPECT_EQ(plan_->counts(kJob).requeued, 3u) << "(0, 2) comes to (0, 1), which no worker has taken over";
}

TEST_F(PlanTest, ALateResultOfAUnitThatIsDoneIsCompared) {
  start(3, 1, kLeases);
  join(1);
  wait(61);
  join(2);
  while (!plan_->finished()) work(2);
  done(1, unit(0, 0));
  EXPECT_THAT(discarded(), ElementsAre(unit(0, 0)));
  EXPECT_THAT(dismissed(), IsEmpty());
  done(1, unit(0, 1), 8);
  EXPECT_THAT(dismissed(), SizeIs(2));
}

TEST_F(PlanTest, AWorkerThatStaysSilentIsDismissed) {
  start(9, 1, kLeases);
  join(1);
  wait(60);
  wait(59);
  EXPECT_THAT(dismissed(), IsEmpty());
  wait(1);
  EXPECT_THAT(dismissed(), ElementsAre(Pair(1, Fault::kHung)));
}

TEST_F(PlanTest, AWorkerThatIsNotHeardOfIsGivenUpSoon) {
  start(9, 1, kWithBeats);
  join(1);
  wait(7.9);
  EXPECT_EQ(plan_->counts(kJob).requeued, 0u);
  wait(0.1);
  EXPECT_EQ(plan_->counts(kJob).requeued, 2u) << "long before its first lease ends";
  wait(7.9);
  EXPECT_THAT(dismissed(), IsEmpty());
  wait(0.1);
  EXPECT_THAT(dismissed(), ElementsAre(Pair(1, Fault::kHung)));
}

TEST_F(PlanTest, AWorkerThatOnlySaysThatItIsAliveHasItsLeaseAndNoMore) {
  start(9, 1, kWithBeats);
  join(1);
  for (int i = 0; i < 59; ++i) {
    wait(1);
    tell(Alive{1});
  }
  EXPECT_EQ(plan_->counts(kJob).requeued, 0u);
  wait(1);
  EXPECT_EQ(plan_->counts(kJob).requeued, 2u);
  for (int i = 0; i < 59; ++i) {
    wait(1);
    tell(Alive{1});
  }
  EXPECT_THAT(dismissed(), IsEmpty());
  wait(1);
  EXPECT_THAT(dismissed(), ElementsAre(Pair(1, Fault::kHung)));
}

TEST_F(PlanTest, AUnitThatGetsOnMayTakeAnyTime) {
  start(9, 1, kWithBeats);
  join(1);
  for (int i = 0; i < 1000; ++i) {
    wait(7);
    tell(Progressed{1});
    ASSERT_EQ(plan_->counts(kJob).requeued, 0u);
  }
  work(1);
  EXPECT_THAT(merged(), ElementsAre(unit(0, 0)));
}

TEST_F(PlanTest, TheLeaseFollowsTheLongestPartOfAUnit) {
  start(9, 1, kWithBeats);
  join(1);
  for (const Seconds part : {1.0, 3.0, 2.0}) {
    wait(part);
    tell(Progressed{1});
  }
  work(1);
  for (int i = 0; i < 59; ++i) {  // 20 x 3 s, and not 20 times the unit's 7 s
    wait(1);
    tell(Alive{1});
  }
  EXPECT_EQ(plan_->counts(kJob).requeued, 0u);
  wait(1);
  EXPECT_EQ(plan_->counts(kJob).requeued, 2u);
}

TEST_F(PlanTest, AStoppedWorkerThatGoesOnIsTakenBack) {
  start(9, 1, kWithBeats);
  join(1);
  wait(8);
  ASSERT_EQ(plan_->counts(kJob).requeued, 2u);
  tell(Alive{1});
  wait(7.9);
  tell(Alive{1});
  wait(7.9);
  EXPECT_THAT(dismissed(), IsEmpty());
  work(1);
  EXPECT_THAT(merged(), ElementsAre(unit(0, 0)));
}

TEST_F(PlanTest, AnIdleWorkerNeedNotBeHeardOf) {
  start(1, 1, kWithBeats);
  join(1);
  work(1);
  wait(100);
  tell(MorePasses{kJob, 2});
  ASSERT_THAT(held_[1], ElementsAre(unit(1, 0)));
  wait(7.9);
  EXPECT_EQ(plan_->counts(kJob).requeued, 0u);
}

TEST_F(PlanTest, WhatIsWaitedForIsToldOnce) {
  start(9, 1, kWithBeats);
  join(1);
  const auto overdue = [this] {
    return all<UnitOverdue, UnitOverdue>([](const UnitOverdue& o) { return o; });
  };
  wait(4.9);
  EXPECT_THAT(overdue(), IsEmpty());
  wait(0.1);
  ASSERT_THAT(overdue(), SizeIs(1));
  EXPECT_EQ(overdue()[0].worker, 1u);
  EXPECT_EQ(overdue()[0].unit, unit(0, 0));
  EXPECT_TRUE(overdue()[0].is_silent);
  EXPECT_NEAR(overdue()[0].since, 5, 1e-9);
  EXPECT_NEAR(overdue()[0].until_hung, 3, 1e-9);
  wait(1);
  EXPECT_THAT(overdue(), IsEmpty()) << "said already";
  tell(Progressed{1});
  for (int i = 0; i < 11; ++i) {
    wait(1);
    EXPECT_THAT(overdue(), IsEmpty()) << "twice the six seconds of the longest part so far";
    tell(Alive{1});
  }
  wait(1);
  ASSERT_THAT(overdue(), SizeIs(1));
  EXPECT_FALSE(overdue()[0].is_silent);
}

TEST_F(PlanTest, AUnitThatHangsThreeWorkersIsSetAsideAfterEverLongerLeases) {
  start(1, 1, kLeases);
  for (const WorkerId worker : {1, 2, 3}) {
    join(worker);
    ASSERT_THAT(held_[worker], ElementsAre(unit(0, 0)));
    const Seconds lease = 60 * (1 << (worker - 1));
    wait(lease - 0.1);
    EXPECT_EQ(plan_->counts(kJob).requeued, worker - 1);
    wait(0.1);
    if (worker < 3) {
      EXPECT_EQ(plan_->counts(kJob).requeued, worker);
      wait(lease);
      EXPECT_THAT(dismissed(), ElementsAre(Pair(worker, Fault::kHung)));
    }
  }
  EXPECT_THAT(set_aside(), ElementsAre(unit(0, 0)));
  EXPECT_TRUE(plan_->finished());
}

TEST_F(PlanTest, AHungWorkerThatDiesIsNotBlamedTwice) {
  start(1, 1, kLeases);
  join(1);
  wait(61);
  lose(1);
  join(2);
  wait(121);
  lose(2);
  EXPECT_THAT(plan_->set_aside(kJob), IsEmpty());
  join(3);
  work(3);
  EXPECT_TRUE(plan_->finished());
}

// --- Stragglers and duplicates

TEST_F(PlanTest, AUnitThatWaitsAtABusyWorkerIsCopiedToAnIdleOneAtOnce) {
  start(2, 1);
  join(1);
  EXPECT_THAT(held_[1], SizeIs(2));
  join(2);
  EXPECT_THAT(assigned(), ElementsAre(Pair(2, unit(0, 1))));
  EXPECT_EQ(plan_->counts(kJob).duplicated, 1u);
}

TEST_F(PlanTest, AUnitInHandIsCopiedOnceItTakesLongerThanTheMean) {
  start(3, 1);
  join(1);
  work(1);  // takes 1 s
  work(1);
  EXPECT_THAT(held_[1], ElementsAre(unit(0, 2)));
  join(2);
  EXPECT_THAT(held_[2], IsEmpty());
  wait(0.9);
  EXPECT_THAT(held_[2], IsEmpty());
  wait(0.2);
  EXPECT_THAT(held_[2], ElementsAre(unit(0, 2)));
}

TEST_F(PlanTest, NothingIsCopiedWhileThereIsOtherWork) {
  start(100, 1);
  join(1);
  join(2);
  for (int i = 0; i < 40; ++i) work(2);
  EXPECT_EQ(plan_->counts(kJob).duplicated, 0u);
}

TEST_F(PlanTest, AUnitHasTwoCopiesAtMost) {
  start(1, 1);
  for (const WorkerId worker : {1, 2, 3, 4}) join(worker);
  for (int i = 0; i < 5; ++i) wait(1);
  EXPECT_EQ(plan_->counts(kJob).duplicated, 1u);
}

TEST_F(PlanTest, ABlamedUnitIsNotCopied) {
  start(1, 1);
  join(1);
  fails(1, unit(0, 0));
  ASSERT_THAT(held_[1], ElementsAre(unit(0, 0)));
  join(2);
  wait(5);
  EXPECT_THAT(held_[2], IsEmpty()) << "it might kill two workers at a time";
}

TEST_F(PlanTest, TheFirstResultWinsAndAnEqualSecondIsDiscarded) {
  start(2, 1);
  join(1);
  join(2);
  done(2, unit(0, 1));
  EXPECT_THAT(merged(), ElementsAre(unit(0, 1)));
  done(1, unit(0, 0));
  EXPECT_TRUE(plan_->finished());
  done(1, unit(0, 1));
  EXPECT_THAT(merged(), IsEmpty());
  EXPECT_THAT(discarded(), ElementsAre(unit(0, 1)));
  EXPECT_THAT(dismissed(), IsEmpty());
  EXPECT_EQ(plan_->counts(kJob).done, 2u);
}

TEST_F(PlanTest, AnUnequalSecondResultDismissesBothAndAllTheirWorkIsRedone) {
  start(4, 1);
  join(1);
  join(2);
  join(3);
  done(1, unit(0, 0));
  done(2, unit(0, 2));
  done(2, unit(0, 3));  // idle now: gets copies
  const UnitId copy = held_[2].empty() ? held_[3].front() : held_[2].front();
  const WorkerId copier = held_[2].empty() ? 3 : 2;
  ASSERT_EQ(copy, unit(0, 1));
  done(1, unit(0, 1), 7);
  done(copier, copy, 8);
  EXPECT_THAT(discarded(), ElementsAre(copy));
  EXPECT_THAT(dismissed(), ElementsAre(Pair(1, Fault::kDisputed), Pair(copier, Fault::kDisputed)));
  const std::set<std::uint32_t> redone = [this] {
    const auto tiles = tiles_to_redo();
    return std::set(tiles.begin(), tiles.end());
  }();
  EXPECT_TRUE(redone.contains(0) && redone.contains(1));
  EXPECT_EQ(redone.contains(2), copier == 2);
  EXPECT_FALSE(plan_->finished());
  held_.clear();
  join(4);
  while (!plan_->finished()) work(4);
  EXPECT_EQ(plan_->counts(kJob).done, 4u);
}

TEST_F(PlanTest, WorkOfALostWorkerIsRedoneTooWhenItTurnsOutWrong) {
  start(2, 2);
  join(1);
  join(2);
  done(1, unit(0, 0));
  done(1, unit(0, 1));
  // The rest: pass 1 is split between the two; 1 dies after a unit of which 2 has a copy.
  ASSERT_THAT(held_[2], ElementsAre(unit(1, 0), unit(1, 1)));
  ASSERT_THAT(held_[1], ElementsAre(unit(1, 1)));
  done(1, unit(1, 1), 7);
  lose(1);
  done(2, unit(1, 0));
  done(2, unit(1, 1), 8);
  EXPECT_THAT(dismissed(), ElementsAre(Pair(2, Fault::kDisputed))) << "the other one is gone already";
  EXPECT_THAT(tiles_to_redo(), ElementsAre(0, 1));
  EXPECT_EQ(plan_->units_left(), 4u);
}

TEST_F(PlanTest, EndlessDisagreementIsGivenUp) {
  start(1, 1);
  WorkerId worker = 0;
  for (int dispute = 1; dispute <= kDisputesToGiveUp; ++dispute) {
    const WorkerId a = ++worker, b = ++worker;
    join(a);
    join(b);
    wait(1.5);
    ASSERT_THAT(held_[a], SizeIs(1));
    ASSERT_THAT(held_[b], SizeIs(1));
    done(a, unit(0, 0), a);
    done(b, unit(0, 0), b);
    EXPECT_THAT(dismissed(), SizeIs(2));
    EXPECT_EQ(plan_->gave_up(), dispute == kDisputesToGiveUp);
  }
  EXPECT_TRUE(std::holds_alternative<GiveUp>(last_.back()));
  join(++worker);
  EXPECT_THAT(assigned(), IsEmpty());
}

// --- Time budget

TEST_F(PlanTest, NoFurtherUnitsEndsWithWhatIsOut) {
  start(3, 5);
  join(1);
  work(1);
  work(1);  // (0, 2) and (1, 0) are out
  tell(NoFurtherUnits{kJob});
  EXPECT_EQ(plan_->passes(kJob), 2u);
  EXPECT_EQ(plan_->passes(kJob, 0), 2u);
  EXPECT_EQ(plan_->passes(kJob, 1), 1u);
  EXPECT_EQ(plan_->units_left(), 2u);
  while (!plan_->finished()) work(1);
  EXPECT_EQ(plan_->counts(kJob).done, 4u);
}

TEST_F(PlanTest, AWorkersDeathAfterTheLastUnitChangesNothing) {
  start(3, 5);
  join(1);
  join(2);
  tell(NoFurtherUnits{kJob});
  tell(WorkerLost{1});
  while (!plan_->finished()) work(2);
  EXPECT_EQ(plan_->counts(kJob).done, 4u);  // (0, 0..2) and (1, 0) were out
}

TEST_F(PlanTest, SomeUnitsAtMost) {
  for (const std::uint64_t most : {1u, 3u, 4u, 14u, 15u, 16u, 1000u}) {
    plan_.emplace(LeaseRule{.silence = kNever});
    add(kJob, {{.tiles = 3, .passes = 5, .units_at_most = most}});
    join(1);
    std::vector<UnitId> order;
    while (!plan_->finished()) {
      order.push_back(held_[1].front());
      work(1);
    }
    ASSERT_EQ(order.size(), std::min<std::uint64_t>(most, 15));
    for (std::uint32_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], unit(i / 3, i % 3));
  }
}

TEST_F(PlanTest, NoFurtherUnitsBeforeTheFirstRendersOnePass) {
  start(3, 5);
  tell(NoFurtherUnits{kJob});
  EXPECT_EQ(plan_->passes(kJob), 1u);
  EXPECT_EQ(plan_->units_left(), 3u);
  join(1);
  while (!plan_->finished()) work(1);
  EXPECT_EQ(plan_->counts(kJob).done, 3u);
}

// --- Tiles that have passes already, and tiles with passes of their own

TEST_F(PlanTest, WhatIsMergedAlreadyIsNotIssued) {
  plan_.emplace(LeaseRule{.silence = kNever});
  add(kJob, {{.tiles = 3, .passes = 3, .merged = {1, 3, 0}}});
  EXPECT_EQ(plan_->units_left(), 5u);
  join(1);
  std::vector<UnitId> order;
  while (!plan_->finished()) {
    order.push_back(held_[1].front());
    work(1);
  }
  EXPECT_THAT(order, ElementsAre(unit(0, 2), unit(1, 0), unit(1, 2), unit(2, 0), unit(2, 2)));
  EXPECT_EQ(plan_->counts(kJob).done, 9u);
}

TEST_F(PlanTest, NothingIsLeftOfAJobThatIsMergedWhole) {
  plan_.emplace(LeaseRule{.silence = kNever});
  add(kJob, {{.tiles = 2, .passes = 3, .merged = {3, 5}}});  // more than there are
  EXPECT_TRUE(plan_->finished(kJob));
  tell(JobRestarted{kJob});
  EXPECT_EQ(plan_->units_left(), 6u) << "a job that begins anew has nothing";
}

TEST_F(PlanTest, ADisputedTileIsRedoneFromNothingAlsoWhereItWasMergedBefore) {
  plan_.emplace(LeaseRule{.silence = kNever});
  add(kJob, {{.tiles = 2, .passes = 4, .merged = {2, 4}}});
  join(1);  // (2, 0) and (3, 0)
  join(2);
  wait(10);
  ASSERT_THAT(held_[2], ElementsAre(unit(3, 0))) << "a copy of what waits";
  now_ += 1;
  done(2, unit(3, 0), 8);
  done(1, unit(2, 0));
  done(1, unit(3, 0), 9);
  EXPECT_THAT(tiles_to_redo(), ElementsAre(0));
  EXPECT_EQ(plan_->units_left(), 4u);
  EXPECT_EQ(plan_->counts(kJob).done, 4u);
  join(3);
  while (!plan_->finished()) work(3);
  EXPECT_EQ(plan_->counts(kJob).done, 8u);
}

TEST_F(PlanTest, ATimeBudgetFinishesWhatIsBeforeTheLastUnitOfAnEarlierScheduler) {
  plan_.emplace(LeaseRule{.silence = kNever});
  add(kJob, {{.tiles = 4, .passes = 9, .merged = {1, 1, 3, 1}}});
  tell(NoFurtherUnits{kJob});
  EXPECT_EQ(plan_->passes(kJob), 3u);
  EXPECT_EQ(plan_->units_left(), 2u + 2u + 1u);  // up to (2, 2)
}

TEST_F(PlanTest, TilesHavePassesOfTheirOwn) {
  plan_.emplace(LeaseRule{.silence = kNever});
  add(kJob, {{.tiles = 2, .passes = 5, .passes_at_first = 2}});
  join(1);
  for (int i = 0; i < 4; ++i) work(1);
  EXPECT_TRUE(plan_->finished());
  tell(PassesOfTile{kJob, 1, 4});
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(2, 1)), Pair(1, unit(3, 1))));
  tell(PassesOfTile{kJob, 1, 3});
  EXPECT_EQ(plan_->units_left(), 2u) << "never fewer";
  tell(PassesOfTile{kJob, 0, 99});
  EXPECT_EQ(plan_->units_left(), 5u) << "never more than the phase has";
  tell(PassesOfTile{kJob, 7, 3});  // there is none
  tell(PassesOfTile{9, 0, 3});
  work(1);
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(2, 0)))) << "the one that is furthest behind";
  tell(NoFurtherUnits{kJob});
  tell(PassesOfTile{kJob, 1, 5});
  EXPECT_EQ(plan_->units_left(), 2u) << "what is out is finished";
  while (!plan_->finished()) work(1);
}

// --- A render whose samples are wanted bit by bit

TEST_F(PlanTest, MorePassesOfNoneStartTheImage) {
  start(2, 0);
  join(1);
  EXPECT_TRUE(plan_->finished());
  EXPECT_THAT(assigned(), IsEmpty());
  tell(MorePasses{kJob, 1});
  EXPECT_FALSE(plan_->finished());
  EXPECT_EQ(plan_->passes(kJob), 1u);
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(0, 0)), Pair(1, unit(0, 1))));
  work(1);
  work(1);
  EXPECT_TRUE(plan_->finished());
  EXPECT_EQ(plan_->counts(kJob).done, 2u);
}

TEST_F(PlanTest, MorePassesGoOnWhereTheImageWasFinished) {
  start(2, 1);
  join(1);
  work(1);
  work(1);
  ASSERT_TRUE(plan_->finished());
  wait(1000);  // no samples are requested; no lease runs
  EXPECT_THAT(dismissed(), IsEmpty());
  tell(MorePasses{kJob, 3});
  EXPECT_EQ(plan_->units_left(), 4u);
  std::vector<UnitId> order;
  while (!plan_->finished()) {
    order.push_back(held_[1].front());
    work(1);
    ASSERT_EQ(merged().size(), 1u);
  }
  EXPECT_THAT(order, ElementsAre(unit(1, 0), unit(1, 1), unit(2, 0), unit(2, 1)));
  EXPECT_EQ(plan_->counts(kJob).done, 6u);
  EXPECT_EQ(plan_->counts(kJob).requeued, 0u);
}

TEST_F(PlanTest, MorePassesAddToWhatIsUnderWay) {
  start(3, 1);
  join(1);
  work(1);
  tell(MorePasses{kJob, 2});
  EXPECT_EQ(plan_->units_left(), 5u);
  std::set<UnitId> order;
  while (!plan_->finished()) {
    order.insert(held_[1].front());
    work(1);
  }
  EXPECT_THAT(order, ElementsAre(unit(0, 1), unit(0, 2), unit(1, 0), unit(1, 1), unit(1, 2)));
  EXPECT_EQ(plan_->counts(kJob).done, 6u);
}

TEST_F(PlanTest, FewerPassesThanBeforeChangeNothing) {
  start(2, 3);
  for (const std::uint32_t passes : {0u, 1u, 3u}) {
    tell(MorePasses{kJob, passes});
    EXPECT_EQ(plan_->passes(kJob), 3u);
    EXPECT_EQ(plan_->units_left(), 6u);
    EXPECT_THAT(last_, IsEmpty());
  }
}

TEST_F(PlanTest, IdleWorkersTakePartInMorePasses) {
  start(2, 1);
  join(1);
  work(1);
  work(1);
  join(2);
  join(3);
  EXPECT_THAT(assigned(), IsEmpty());
  tell(MorePasses{kJob, 2});
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, unit(1, 0)), Pair(2, unit(1, 1))));
  lose(2);
  EXPECT_THAT(assigned(), ElementsAre(Pair(3, unit(1, 1)))) << "what a lost worker had is done by another";
  work(1);
  work(3);
  EXPECT_TRUE(plan_->finished());
}

}  // namespace
}  // namespace penumbra
