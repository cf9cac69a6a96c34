// When workers count as waiting for the scheduler.
#include "scheduler/farm/waiting_share.h"

#include <gmock/gmock.h>

#include <functional>

namespace penumbra::waiting_share_test {
namespace {

using testing::HasSubstr;

/// 100 workers for this time, each busy for a share of it, with units of so many seconds.
std::optional<WaitingShare::Measured> after(Seconds seconds, double busy, Seconds unit,
                                            const std::function<bool(Seconds)>& has_enough = {}) {
  WaitingShare share;
  std::optional<WaitingShare::Measured> measured;
  for (Seconds now = 7; now <= 7 + seconds && !measured; now += 1) {
    const auto results = std::uint64_t(100 * now * busy / unit);
    measured = share.measure(
        now, 100, !has_enough || has_enough(now),
        {.busy = double(results) * unit, .results = results, .bytes = results * 1'000'000, .cpu = 0.5 * now});
  }
  return measured;
}

TEST(WaitingShare, IsWhatIsMissingToTheTimeOfWorkers) {
  const auto measured = after(40, 0.6, 1);
  ASSERT_TRUE(measured);
  EXPECT_NEAR(measured->waiting, 0.4, 0.01);
  EXPECT_NEAR(measured->bytes_per_second, 60e6, 1e6);
  EXPECT_NEAR(measured->cores, 0.5, 0.01);
  EXPECT_NEAR(after(40, 1, 1).value().waiting, 0, 0.01);
}

TEST(WaitingShare, IsNotKnownEarlyNorFromFewUnits) {
  EXPECT_FALSE(after(29, 0.6, 1));
  EXPECT_FALSE(after(60, 1, 20)) << "three results of each say little";
  EXPECT_TRUE(after(250, 1, 20));
}

TEST(WaitingShare, IsOfTimesWithUnitsForAll) {
  EXPECT_FALSE(after(55, 0.1, 0.1, [](Seconds now) { return now != 32; }));
  EXPECT_TRUE(after(65, 0.1, 0.1, [](Seconds now) { return now != 32; }));
}

TEST(WaitingShare, TextsNameWhatHelps) {
  const WaitingShare::Measured measured{.waiting = 0.45, .bytes_per_second = 113e6, .cores = 0.4};
  EXPECT_EQ(waiting_text(measured, 16, 64),
            "workers wait 45% of the time for the scheduler or its network, which takes 113 MB/s of results "
            "with 0.4 cores; --pass 64 needs 4 times less of both, and changes the last bits");
  EXPECT_THAT(waiting_text(measured, 16, 0), HasSubstr("with 0.4 cores"));
  EXPECT_THAT(waiting_text(measured, 16, 16), testing::Not(HasSubstr("--pass")));
}

}  // namespace
}  // namespace penumbra::waiting_share_test
