// Tests units that a second worker renders again for verification.
#include "tests/scheduler/plan/plan_fixture.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;
using testing::UnorderedElementsAre;

class PlanVerifyTest : public PlanTest {
 protected:
  void start(std::uint32_t tiles, std::uint32_t passes, double share) {
    plan_.emplace(LeaseRule{.silence = kNever});
    tell(JobAdded{.job = kJob, .phases = {{tiles, passes}}, .verify = share});
  }
  void finish(WorkerId worker) {
    while (!held_[worker].empty()) work(worker);
  }
};

TEST_F(PlanVerifyTest, AnotherWorkerDoesItBeforeAnythingNew) {
  start(8, 1, 1);
  join(1);
  join(2);
  const UnitId first = held_[1].front();
  work(1);
  EXPECT_THAT(merged(), ElementsAre(first)) << "it need not wait";
  EXPECT_THAT(assigned(), ElementsAre(Pair(1, testing::_)));
  work(2);
  EXPECT_THAT(assigned(), ElementsAre(Pair(2, first)));
  work(2);  // its other unit
  work(2);
  EXPECT_THAT(merged(), IsEmpty());
  EXPECT_THAT(discarded(), ElementsAre(first));
  EXPECT_EQ(plan_->counts(kJob).verified, 1u);
}

TEST_F(PlanVerifyTest, TheJobIsNotFinishedBefore) {
  start(1, 1, 1);
  join(1);
  work(1);
  EXPECT_FALSE(plan_->finished(kJob));
  EXPECT_FALSE(plan_->finished());
  join(2);
  EXPECT_THAT(assigned(), ElementsAre(Pair(2, unit(0, 0))));
  work(2);
  EXPECT_TRUE(plan_->finished());
  EXPECT_EQ(plan_->counts(kJob).verified, 1u);
  EXPECT_EQ(plan_->counts(kJob).done, 1u);
}

TEST_F(PlanVerifyTest, ALieIsFoundAndTheTileDoneAgain) {
  start(4, 1, 1);
  join(1);
  join(2);
  ASSERT_THAT(held_[1], ElementsAre(unit(0, 0), unit(0, 1)));
  done(1, unit(0, 0), 666);
  done(2, unit(0, 2));
  done(2, unit(0, 3));
  ASSERT_THAT(held_[2], ElementsAre(unit(0, 0)));
  done(2, unit(0, 0));
  EXPECT_THAT(dismissed(), ElementsAre(Pair(1, Fault::kDisputed), Pair(2, Fault::kDisputed)));
  EXPECT_THAT(tiles_to_redo(), ElementsAre(0, 2, 3));
  join(3);
  join(4);
  while (!plan_->finished()) {
    ASSERT_FALSE(held_[3].empty() && held_[4].empty());
    work(held_[3].empty() ? 4 : 3);
  }
  EXPECT_EQ(plan_->counts(kJob).verified, 4u);
  EXPECT_EQ(plan_->counts(kJob).done, 4u);
}

TEST_F(PlanVerifyTest, WhoIsAloneCannotVerifyAndTheJobEndsAllTheSame) {
  start(3, 1, 1);
  join(1);
  finish(1);
  EXPECT_FALSE(plan_->finished());
  wait(1);
  wait(kTimeToFindASecond - 1);
  EXPECT_FALSE(plan_->finished());
  wait(1);
  EXPECT_TRUE(plan_->finished());
  EXPECT_EQ(plan_->counts(kJob).not_verified, 3u);
  EXPECT_EQ(plan_->counts(kJob).verified, 0u);
}

TEST_F(PlanVerifyTest, WhoIsBusyWithAnotherJobVerifiesLater) {
  start(1, 1, 1);
  join(1);
  work(1);
  tell(JobAdded{.job = 2, .priority = 1, .phases = {{8, 8}}, .verify = 0});
  join(2);
  for (int i = 0; i < 30; ++i) {
    work(1);
    work(2);
    tell(Tick{});
  }
  EXPECT_EQ(plan_->counts(kJob).not_verified, 0u);
  while (!plan_->finished()) work(held_[2].empty() ? 1 : 2);
  EXPECT_EQ(plan_->counts(kJob).verified, 1u);
}

TEST_F(PlanVerifyTest, AUnitThatCannotBeDoneTwiceIsLeftSoAfterThreeFaults) {
  start(1, 1, 1);
  join(1);
  work(1);
  for (WorkerId worker = 2; worker <= 4; ++worker) {
    EXPECT_FALSE(plan_->finished());
    join(worker);
    EXPECT_THAT(assigned(), ElementsAre(Pair(worker, unit(0, 0))));
    lose(worker);
  }
  EXPECT_THAT(set_aside(), IsEmpty()) << "its result is there";
  EXPECT_TRUE(plan_->finished());
  EXPECT_EQ(plan_->counts(kJob).not_verified, 1u);
}

TEST_F(PlanVerifyTest, ACopyOfAStragglerIsAsGood) {
  start(1, 1, 1);
  join(1);
  join(2);
  wait(kFirstStragglerAge);
  ASSERT_THAT(held_[2], ElementsAre(unit(0, 0)));
  work(2);
  EXPECT_FALSE(plan_->finished());
  EXPECT_THAT(assigned(), IsEmpty()) << "the first one has it in hand";
  work(1);
  EXPECT_TRUE(plan_->finished());
  EXPECT_EQ(plan_->counts(kJob).verified, 1u);
}

TEST_F(PlanVerifyTest, TheShareIsThatOfTheUnitsAndAlwaysTheSame) {
  std::set<UnitId> chosen[2];
  for (auto& units : chosen) {
    held_.clear();
    start(500, 8, 0.1);
    join(1);
    join(2);
    while (!plan_->finished())
      for (const WorkerId worker : {1u, 2u}) {
        if (held_[worker].empty()) continue;
        work(worker);
        for (const UnitId& twice : discarded()) units.insert(twice);
      }
    EXPECT_EQ(plan_->counts(kJob).verified, units.size());
  }
  EXPECT_EQ(chosen[0], chosen[1]);
  // Of 4000 units 400 are expected, with a standard deviation of sqrt(4000 0.1 0.9) = 19; 4 of those.
  EXPECT_NEAR(double(chosen[0].size()), 400, 76);
}

TEST_F(PlanVerifyTest, AJobThatIsRemovedOrBeginsAnewHasNothingToBeVerified) {
  start(4, 1, 1);
  join(1);
  work(1);
  work(1);
  tell(JobRestarted{kJob});
  held_[1] = {unit(0, 0), unit(0, 1)};
  EXPECT_EQ(plan_->counts(kJob).not_verified, 0u);
  join(2);
  EXPECT_THAT(assigned(), UnorderedElementsAre(Pair(2, unit(0, 2)), Pair(2, unit(0, 3))));
  tell(JobRemoved{kJob});
  EXPECT_TRUE(plan_->finished());
}

}  // namespace
}  // namespace penumbra
