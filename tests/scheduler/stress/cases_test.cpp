// The list of cases is complete and well formed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "scheduler/stress/case.h"
#include "scheduler/stress/quantity_list.h"

namespace penumbra::stress {
namespace {

using ::testing::HasSubstr;

TEST(Cases, AreNamedAndExplained) {
  std::set<std::string> names;
  for (const Case& c : all_cases()) {
    EXPECT_TRUE(names.insert(c.name).second) << c.name << " twice";
    EXPECT_THAT(c.name, HasSubstr("/"));
    EXPECT_EQ(c.name.find(' '), std::string::npos) << c.name;
    EXPECT_FALSE(c.stiff.empty()) << c.name;
    EXPECT_FALSE(c.quantity.empty()) << c.name;
    EXPECT_FALSE(c.truth.how.empty()) << c.name;
    EXPECT_FALSE(c.allowed.why.empty()) << c.name;
    EXPECT_TRUE(c.truth.value) << c.name;
    EXPECT_TRUE(c.allowed.absolute >= 0 && c.allowed.relative >= 0) << c.name;
  }
}

TEST(Cases, GroupsAreTogether) {
  std::set<std::string> seen;
  std::string group;
  for (const Case& c : all_cases()) {
    if (group_of(c) != group) {
      EXPECT_TRUE(seen.insert(group_of(c)).second) << group_of(c) << " is split";
    }
    group = group_of(c);
  }
}

TEST(Cases, InputsFitAndAreNumbers) {
  for (const Case& c : all_cases()) {
    const auto* m = std::get_if<KernelMeasurement>(&c.measurement);
    if (!m) continue;
    EXPECT_LE(m->inputs.size(), std::size_t(QUANTITY_INPUTS)) << c.name;
    for (const double x : m->inputs) EXPECT_TRUE(std::isfinite(x)) << c.name;
  }
}

}  // namespace
}  // namespace penumbra::stress
