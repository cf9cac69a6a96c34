// Tests the table of results as text, JSON and HTML.
#include "scheduler/stress/table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace penumbra::stress {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct Table {
  std::vector<Case> cases;
  std::vector<CaseResult> results;
  TableContext context;
};

Outcome outcome(const char* backend, Verdict verdict, double value, double error, const char* note = "") {
  return {backend, verdict, {value}, error, note, .5};
}

Table small_table() {
  Table t;
  t.cases.push_back({"one/right",
                     "x < y",
                     "a quantity",
                     KernelMeasurement{0, {1, 2}, {}},
                     {{}, "sum"},
                     absolute(.5, "rounding")});
  t.cases.push_back(
      {"one/wrong", "hard", "another", HostMeasurement{}, {{}, "closed form"}, absolute(.5, "rounding")});
  t.cases.push_back(
      {"two/skipped", "far", "a third", KernelMeasurement{}, {{}, "sum"}, absolute(.5, "rounding")});
  t.results.resize(3);
  for (std::size_t i = 0; i < 3; ++i) t.results[i].tested = &t.cases[i];
  t.results[0].verdict = Verdict::kPass;
  t.results[0].truth = {1.25};
  t.results[0].allowed = .5;
  t.results[0].outcomes = {outcome("native", Verdict::kPass, 1.5, .25),
                           outcome("opencl", Verdict::kPass, 1.5, .25)};
  t.results[1].verdict = Verdict::kFail;
  t.results[1].truth = {3};
  t.results[1].same_bits = false;
  t.results[1].outcomes = {outcome("native", Verdict::kPass, 3, 0),
                           outcome("opencl", Verdict::kFail, std::numeric_limits<double>::quiet_NaN(),
                                   std::numeric_limits<double>::quiet_NaN(), "not a finite number")};
  t.results[2].verdict = Verdict::kSkipped;
  t.results[2].outcomes = {outcome("opencl", Verdict::kSkipped, 0, 0, "no OpenCL device")};
  t.context.backends = {"native", "opencl: a device"};
  return t;
}

TEST(Table, CountsEachVerdict) {
  const Table t = small_table();
  const Counts counts = count(t.results);
  EXPECT_EQ(counts.passed, 1);
  EXPECT_EQ(counts.failed, 1);
  EXPECT_EQ(counts.skipped, 1);
}

TEST(Table, IsDoneOnlyWhenSomethingPassedAndNothingFailed) {
  EXPECT_TRUE(all_pass({.passed = 3}));
  EXPECT_TRUE(all_pass({.passed = 3, .skipped = 1}));
  EXPECT_TRUE(all_pass({})) << "nothing was there to fail";
  EXPECT_FALSE(all_pass({.passed = 3, .failed = 1}));
  EXPECT_FALSE(all_pass({.skipped = 3})) << "nothing was tested";
}

TEST(Table, JsonReadBack) {
  const Table t = small_table();
  const auto json = nlohmann::json::parse(table_json(t.results, t.context).dump());
  EXPECT_EQ(json["passed"], 1);
  EXPECT_EQ(json["failed"], 1);
  ASSERT_EQ(json["cases"].size(), 3u);
  const auto& right = json["cases"][0];
  EXPECT_EQ(right["name"], "one/right");
  EXPECT_EQ(right["group"], "one");
  EXPECT_EQ(right["verdict"], "pass");
  EXPECT_EQ(right["truth"], nlohmann::json({1.25}));
  EXPECT_EQ(right["truth_by"], "sum");
  EXPECT_EQ(right["inputs"], nlohmann::json({1.0, 2.0}));
  EXPECT_EQ(right["allowed_error"], .5);
  EXPECT_EQ(right["allowed_because"], "rounding");
  EXPECT_EQ(right["outcomes"][1]["result"], nlohmann::json({1.5}));
  EXPECT_EQ(json["cases"][1]["outcomes"][1]["result"], nlohmann::json({"nan"})) << "JSON has no NaN";
  EXPECT_EQ(json["cases"][2]["verdict"], "skipped");
}

TEST(Table, TextHasALineForWhatIsEqualAndOneEachForWhatIsNot) {
  const Table t = small_table();
  const std::string text = table_text(t.results, t.context);
  EXPECT_THAT(text, HasSubstr("opencl: a device"));
  EXPECT_THAT(text, AllOf(HasSubstr("one/right"), HasSubstr("1.25"), HasSubstr("rounding")));
  EXPECT_THAT(text, AllOf(HasSubstr("FAIL"), HasSubstr("on opencl"), HasSubstr("not a finite number")));
  EXPECT_THAT(text, HasSubstr("two/skipped"));
  EXPECT_THAT(text, HasSubstr("no OpenCL device"));
  EXPECT_THAT(text, HasSubstr("1 passed, 1 failed, 1 skipped"));
}

TEST(Table, HtmlIsOnePageAndEscapesText) {
  const Table t = small_table();
  const std::string html = table_html(t.results, t.context);
  EXPECT_THAT(html, AllOf(HasSubstr("<!doctype html>"), HasSubstr("</html>"), HasSubstr("<style>")));
  EXPECT_THAT(html, AllOf(HasSubstr("x &lt; y"), Not(HasSubstr("x < y"))));
  EXPECT_THAT(html, Not(HasSubstr("src="))) << "nothing to load";
  EXPECT_THAT(html, Not(HasSubstr("href=")));
  for (const Case& c : t.cases) EXPECT_THAT(html, HasSubstr(c.name));
}

TEST(Table, NumbersKeepTheirDigits) {
  EXPECT_EQ(numbers_text({}, 15), "-");
  EXPECT_EQ(numbers_text({.1}, 17), "0.10000000000000001");
  EXPECT_EQ(numbers_text({1, -2.5}, 6), "(1, -2.5)");
}

}  // namespace
}  // namespace penumbra::stress
