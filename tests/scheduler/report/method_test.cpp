#include "scheduler/report/method.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string error_of(const auto& expected) { return expected ? "" : expected.error().message; }

TEST(Method, IsItsOwnLabel) {
  const auto method = parse_method("polygon_cv:alpha=auto,vis_samples=4");
  ASSERT_TRUE(method) << error_of(method);
  EXPECT_EQ(method->label, "polygon_cv:alpha=auto,vis_samples=4");
  EXPECT_EQ(method->integrator, "polygon_cv");
  EXPECT_THAT(method->settings, ElementsAre("integrator.alpha=auto", "integrator.vis_samples=4"));
}

TEST(Method, MayHaveALabel) {
  const auto method = parse_method("control variate=path:nee=cv,sampler.type=sobol");
  ASSERT_TRUE(method) << error_of(method);
  EXPECT_EQ(method->label, "control variate");
  EXPECT_EQ(method->integrator, "path");
  EXPECT_THAT(method->settings, ElementsAre("integrator.nee=cv", "sampler.type=sobol"));
  EXPECT_EQ(parse_method("a=direct")->label, "a");
  EXPECT_THAT(parse_method("a=direct")->settings, IsEmpty());
}

TEST(Method, ErrorsSayWhatIsWrong) {
  EXPECT_THAT(error_of(parse_method("pth_mis")), HasSubstr("did you mean 'path_mis'"));
  EXPECT_THAT(error_of(parse_method("path:nee")), HasSubstr("'nee'"));
  EXPECT_THAT(error_of(parse_method("path:")), HasSubstr("key=value"));
  EXPECT_THAT(error_of(parse_method("path:=1")), HasSubstr("key=value"));
  EXPECT_THAT(error_of(parse_method("=path")), HasSubstr("no name"));
  EXPECT_FALSE(parse_method(""));
}

TEST(Budgets, DoubleOrAreListed) {
  EXPECT_THAT(*parse_budgets("1..64"), ElementsAre(1u, 2u, 4u, 8u, 16u, 32u, 64u));
  EXPECT_THAT(*parse_budgets("3..20"), ElementsAre(3u, 6u, 12u));
  EXPECT_THAT(*parse_budgets("5..5"), ElementsAre(5u));
  EXPECT_THAT(*parse_budgets("1500000000..2147483648"), ElementsAre(1500000000u));
  EXPECT_THAT(*parse_budgets("16,1,4"), ElementsAre(1u, 4u, 16u));
}

TEST(Budgets, ErrorsSayWhatIsWrong) {
  for (const char* bad :
       {"", "0", "0..4", "1..", "..4", "a", "1,,2", "-1", "1.5", "1..2..3", "2147483649", "nan"})
    EXPECT_FALSE(parse_budgets(bad)) << bad;
  EXPECT_THAT(error_of(parse_budgets("8..4")), HasSubstr("before it begins"));
  EXPECT_THAT(error_of(parse_budgets("4,4")), HasSubstr("twice"));
}

TEST(Targets, AreOfOneMetricAndPositive) {
  EXPECT_TRUE(parse_target("relmse=1e-3")->relative);
  EXPECT_EQ(parse_target("relmse=1e-3")->error, 1e-3);
  EXPECT_FALSE(parse_target("relmse=1e-3")->blocks);
  EXPECT_TRUE(parse_target("block_relmse=1e-3")->blocks);
  EXPECT_FALSE(parse_target("mse=0.5")->relative);
  for (const char* bad :
       {"", "relmse", "relmse=", "relmse=0", "relmse=-1", "mse=inf", "mse=nan", "flip=1", "mse=1x"})
    EXPECT_FALSE(parse_target(bad)) << bad;
}

}  // namespace
}  // namespace penumbra
