// Tests the table of results as text, JSON and HTML.
#include "scheduler/stress/table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/scheduler/stress/small_table.h"

namespace penumbra::stress {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

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
  EXPECT_EQ(json["host"], "<host>");
  EXPECT_EQ(json["date"], "2026-01-02T03:04:05Z");
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

TEST(Table, HtmlBeginsWithWhereAndWhenAndWhatFailed) {
  Table t = small_table();
  const std::string html = table_html(t.results, t.context);
  EXPECT_THAT(html, HasSubstr("1 passed, 1 failed, 1 skipped</b> in 0.0 s, on &lt;host&gt;, "
                              "2026-01-02T03:04:05Z, Penumbra 1.2."));
  const std::size_t failed = html.find("Failed: 1");
  EXPECT_LT(failed, html.find("one/wrong"));
  EXPECT_LT(html.find("one/wrong"), html.find("one/right"));
  EXPECT_THAT(html, Not(HasSubstr("No case failed")));
  t.results.erase(t.results.begin() + 1);
  const std::string good = table_html(t.results, t.context);
  EXPECT_THAT(good, AllOf(HasSubstr("No case failed"), Not(HasSubstr("Failed:"))));
}

TEST(Table, HtmlHasABarOfTheLargestErrorOverTheAllowedForEachGroup) {
  Table t = small_table();
  const auto groups = [&] {
    const std::string html = table_html(t.results, t.context);
    const std::size_t begin = html.find("<h2>Groups</h2>");
    return html.substr(begin, html.find("<h2>Cases</h2>") - begin);
  };
  // The error of one/wrong is no number: the bar is full and red.
  EXPECT_THAT(groups(), AllOf(HasSubstr("class=\"over\" style=\"width:100%\""), HasSubstr("–, one/wrong")));
  t.results[1].outcomes[1].error = .6;
  EXPECT_THAT(groups(), HasSubstr("∞, one/wrong")) << "none is allowed";
  t.results[1].allowed = .5;
  EXPECT_THAT(groups(),
              AllOf(HasSubstr("class=\"over\" style=\"width:100%\""), HasSubstr("120 %, one/wrong")));
  t.results.erase(t.results.begin() + 1);
  EXPECT_THAT(groups(), AllOf(HasSubstr("<span style=\"width:50%\""), HasSubstr("50 %, one/right")));
}

TEST(Table, NumbersKeepTheirDigits) {
  EXPECT_EQ(numbers_text({}, 15), "-");
  EXPECT_EQ(numbers_text({.1}, 17), "0.10000000000000001");
  EXPECT_EQ(numbers_text({1, -2.5}, 6), "(1, -2.5)");
}

}  // namespace
}  // namespace penumbra::stress
