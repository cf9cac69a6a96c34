// The table of the stress test in a browser.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scheduler/stress/small_table.h"
#include "tests/support/readable_page.h"

namespace penumbra::stress {
namespace {

std::string page() {
  Table t = small_table();
  for (Case& c : t.cases) c.stiff += " " + std::string(90, 'x');  // no spaces to break the line at
  t.results[1].truth = {1.0 / 3, 1e-300 / 3, -2e20 / 3};
  return table_html(t.results, t.context);
}

TEST(StressPage, IsReadableOnPhonesAndLaptopsInLightAndDark) {
  if (!find_browser()) GTEST_SKIP() << kNoBrowser;
  expect_readable(page(), 0);
}

TEST(StressPage, FilterKeepsRowsWithAllWords) {
  if (!find_browser()) GTEST_SKIP() << kNoBrowser;
  const auto seen = view_page(page(), {.script = R"js((() => {
    const input = document.querySelector(".filter input"), answers = [];
    for (const text of ["", "ONE/", "rounding third", "closed form", "no such words"]) {
      input.value = text;
      input.dispatchEvent(new Event("input"));
      const visible = [...document.querySelectorAll("section.group tbody tr")].filter(row => row.getClientRects().length);
      answers.push([visible.length, document.querySelector(".filter output").textContent,
                    [...document.querySelectorAll("section.group h2")].filter(h => h.getClientRects().length).length]);
    }
    return answers;
  })())js"});
  ASSERT_TRUE(seen) << seen.error().message;
  EXPECT_EQ((*seen)["script"],
            nlohmann::json::parse(R"([[3, "3 cases", 2], [2, "2 cases", 1], [1, "1 case", 1],
                                                        [1, "1 case", 1], [0, "0 cases", 0]])"));
}

}  // namespace
}  // namespace penumbra::stress
