// Submitters of jobs of equal priority have equal shares of the workers' time.
#include "tests/scheduler/plan/plan_fixture.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::Pair;

class PlanSharesTest : public PlanTest {
 protected:
  void SetUp() override { plan_.emplace(LeaseRule{.silence = kNever}); }
  void add_of(const char* submitter, JobId job, int priority = 0) {
    tell(JobAdded{job, priority, {{1000, 1000}}, 0, submitter});
  }
  /// Works for so long and returns how long each job had the workers. A unit of job j takes `seconds_of[j]`.
  std::map<JobId, Seconds> work_for(Seconds seconds, const std::map<JobId, Seconds>& seconds_of) {
    std::map<JobId, Seconds> had;
    for (const Seconds end = now_ + seconds; now_ < end;) {
      auto next = std::ranges::min_element(
          held_, {}, [&](const auto& worker) { return ends_at(worker.first, seconds_of); });
      const auto [worker, units] = *next;
      const UnitId unit = units.front();
      now_ = std::max(now_, ends_at(worker, seconds_of));
      had[unit.job] += seconds_of.at(unit.job);
      begun_[worker] = now_;
      done(worker, unit);
    }
    return had;
  }
  Seconds ends_at(WorkerId worker, const std::map<JobId, Seconds>& seconds_of) {
    return begun_.try_emplace(worker, now_).first->second + seconds_of.at(held_.at(worker).front().job);
  }

  std::map<WorkerId, Seconds> begun_;
};

TEST_F(PlanSharesTest, AreEqualThoughUnitsTakeDifferentTimes) {
  add_of("ann", 1);
  add_of("bob", 2);
  add_of("bob", 3);
  for (WorkerId worker = 1; worker <= 3; ++worker) join(worker);
  auto had = work_for(3000, {{1, 12}, {2, 1}, {3, 1}});
  // Of 9000 s; a worker's units in hand may be of either.
  EXPECT_NEAR(had[1], 4500, 200);
  EXPECT_NEAR(had[2], 4500, 200);
  EXPECT_EQ(had[3], 0);  // bob's older job goes first
}

TEST_F(PlanSharesTest, WhoComesLaterHasNoClaimOnTheTimeBefore) {
  add_of("ann", 1);
  join(1);
  work_for(1000, {{1, 1}});
  add_of("bob", 2);
  const auto had = work_for(100, {{1, 1}, {2, 1}});
  EXPECT_NEAR(had.at(1), 50, 3);
  EXPECT_NEAR(had.at(2), 50, 3);
}

TEST_F(PlanSharesTest, PriorityCountsMore) {
  add_of("ann", 1);
  add_of("bob", 2, 1);
  join(1);
  const auto had = work_for(100, {{1, 1}, {2, 1}});
  EXPECT_THAT(had, ElementsAre(Pair(2, testing::Ge(99))));
}

// Preparing takes time, so a worker that is prepared for two submitters' jobs does not change to a third's
// for each unit.
TEST_F(PlanSharesTest, AThirdSubmitterDoesNotMakeWorkersPrepareAllTheTime) {
  for (JobId job = 1; job <= 3; ++job) add_of(std::to_string(job).c_str(), job);
  join(1);
  int prepared = 0;
  std::map<JobId, Seconds> had;
  for (int i = 0; i < 3000; ++i) {
    for (const auto& [job, seconds] : work_for(1, {{1, 1}, {2, 1}, {3, 1}})) had[job] += seconds;
    prepared += int(all<Prepare, JobId>([](const Prepare& p) { return p.job; }).size());
  }
  for (JobId job = 1; job <= 3; ++job) EXPECT_NEAR(had[job], 1000, 2 * kLargestLag) << job;
  EXPECT_LE(prepared, 3000 / int(kLargestLag) + 5);
}

}  // namespace
}  // namespace penumbra
