// Tests which results pass and which fail.
#include "scheduler/stress/verdict.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace penumbra::stress {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Outcome judged(const Numbers& value, const Quads& truth, const Allowed& allowed,
               const std::string& note = "") {
  Outcome outcome;
  outcome.value = value;
  outcome.note = note;
  judge(truth, allowed, outcome);
  return outcome;
}

TEST(Verdict, PassesWithinTheAllowedError) {
  EXPECT_EQ(judged({1.25}, {1}, absolute(.25, "")).verdict, Verdict::kPass);
  EXPECT_EQ(judged({1.25}, {1}, absolute(.25, "")).error, .25);
  EXPECT_EQ(judged({102}, {100}, relative(.02, "")).verdict, Verdict::kPass);
  EXPECT_EQ(judged({-102}, {-100}, relative(.02, "")).verdict, Verdict::kPass);
  EXPECT_EQ(judged({0}, {0}, absolute(0, "")).verdict, Verdict::kPass);
}

TEST(Verdict, AWrongResultFails) {
  EXPECT_EQ(judged({1.26}, {1}, absolute(.25, "")).verdict, Verdict::kFail);
  EXPECT_EQ(judged({-1}, {1}, absolute(.25, "")).verdict, Verdict::kFail);
  EXPECT_EQ(judged({102.1}, {100}, relative(.02, "")).verdict, Verdict::kFail);
  EXPECT_EQ(judged({std::nextafter(0., 1.)}, {0}, absolute(0, "")).verdict, Verdict::kFail);
  EXPECT_FALSE(judged({1.26}, {1}, absolute(.25, "")).note.empty());
}

TEST(Verdict, WhatIsNoNumberFails) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    EXPECT_EQ(judged({bad}, {1}, absolute(1e300, "")).verdict, Verdict::kFail) << bad;
    EXPECT_EQ(judged({1}, {Quad(bad)}, absolute(1e300, "")).verdict, Verdict::kFail) << bad;
    EXPECT_EQ(judged({1}, {1}, absolute(bad, "")).verdict, Verdict::kFail) << bad;
    EXPECT_EQ(judged({bad}, {Quad(bad)}, absolute(1, "")).verdict, Verdict::kFail) << bad;
    EXPECT_EQ(judged({1, bad}, {1, 1}, absolute(1, "")).verdict, Verdict::kFail) << bad;
  }
}

TEST(Verdict, ComponentsAreADistance) {
  EXPECT_EQ(judged({3, 4}, {0, 0}, absolute(5, "")).verdict, Verdict::kPass);
  EXPECT_EQ(judged({3, 4}, {0, 0}, absolute(4.99, "")).verdict, Verdict::kFail);
  EXPECT_EQ(judged({1}, {1, 1}, absolute(5, "")).verdict, Verdict::kFail);
  EXPECT_EQ(judged({1, 1}, {1}, absolute(5, "")).verdict, Verdict::kFail);
  EXPECT_EQ(judged({}, {}, absolute(5, "")).verdict, Verdict::kFail);
  EXPECT_EQ(allowed_error({3, 4}, {1, .1, "", {}}), 1.5);
}

TEST(Verdict, ANoteOfWhatWentWrongFailsTheRightNumberToo) {
  const Outcome outcome = judged({1}, {1}, absolute(0, ""), "3 samples are NaN");
  EXPECT_EQ(outcome.verdict, Verdict::kFail);
  EXPECT_EQ(outcome.note, "3 samples are NaN");
}

Outcome with(Verdict verdict, double value = 1) {
  Outcome outcome;
  outcome.verdict = verdict;
  outcome.value = {value};
  return outcome;
}

TEST(Verdict, OneFailingBackendFailsTheCase) {
  EXPECT_EQ(summarize({with(Verdict::kPass), with(Verdict::kPass)}), Verdict::kPass);
  EXPECT_EQ(summarize({with(Verdict::kPass), with(Verdict::kFail)}), Verdict::kFail);
  EXPECT_EQ(summarize({with(Verdict::kPass), with(Verdict::kSkipped)}), Verdict::kPass);
  EXPECT_EQ(summarize({with(Verdict::kSkipped), with(Verdict::kFail)}), Verdict::kFail);
  EXPECT_EQ(summarize({with(Verdict::kSkipped)}), Verdict::kSkipped);
}

TEST(Verdict, BitsAreComparedNotValues) {
  EXPECT_TRUE(have_same_bits({with(Verdict::kPass, 1), with(Verdict::kPass, 1)}));
  EXPECT_FALSE(have_same_bits({with(Verdict::kPass, 1), with(Verdict::kPass, std::nextafter(1., 2.))}));
  EXPECT_FALSE(have_same_bits({with(Verdict::kPass, 0.), with(Verdict::kPass, -0.)}));
  EXPECT_TRUE(have_same_bits({with(Verdict::kFail, kNan), with(Verdict::kFail, kNan)}));
  EXPECT_TRUE(have_same_bits({with(Verdict::kPass, 1), with(Verdict::kSkipped, 2)}));
}

}  // namespace
}  // namespace penumbra::stress
