// Selects cases by names, parts of names, and patterns.
#include "scheduler/stress/selection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace penumbra::stress {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Selection, PartsAndPatterns) {
  EXPECT_TRUE(matches("polygon/edge-1e-9", "edge"));
  EXPECT_TRUE(matches("polygon/edge-1e-9", "polygon/edge-1e-9"));
  EXPECT_FALSE(matches("polygon/edge-1e-9", "vertex"));
  EXPECT_TRUE(matches("polygon/edge-1e-9", "polygon/*"));
  EXPECT_TRUE(matches("polygon/edge-1e-9", "*edge*9"));
  EXPECT_TRUE(matches("polygon/edge-1e-9", "polygon/edge-1e-?"));
  EXPECT_FALSE(matches("polygon/edge-1e-9", "edge*")) << "a pattern is for the whole name";
  EXPECT_FALSE(matches("polygon/edge-1e-9", "polygon/edge-1e-9?"));
  EXPECT_TRUE(matches("aXbXc", "a*X*c"));
  EXPECT_TRUE(matches("", "*"));
  EXPECT_FALSE(matches("", "?"));
}

std::vector<Case> named(std::initializer_list<const char*> names) {
  std::vector<Case> cases;
  for (const char* name : names) cases.push_back({name, "", "", HostMeasurement{}, {}, {}});
  return cases;
}
std::vector<std::string> names(const std::vector<Case>& cases) {
  std::vector<std::string> result;
  for (const Case& c : cases) result.push_back(c.name);
  return result;
}

TEST(Selection, KeepsTheOrderAndEachCaseOnce) {
  const auto all = named({"a/1", "b/1", "b/2", "c/1"});
  EXPECT_THAT(names(*select(all, {})), ElementsAre("a/1", "b/1", "b/2", "c/1"));
  EXPECT_THAT(names(*select(all, {"c", "b/*", "b/1"})), ElementsAre("b/1", "b/2", "c/1"));
}

TEST(Selection, APatternThatMatchesNothingIsAnError) {
  const auto chosen = select(named({"polygon/edge", "b/1"}), {"b", "polygon/egde"});
  ASSERT_FALSE(chosen);
  EXPECT_THAT(chosen.error().message,
              HasSubstr("no case matches 'polygon/egde'; did you mean 'polygon/edge'?"));
}

}  // namespace
}  // namespace penumbra::stress
