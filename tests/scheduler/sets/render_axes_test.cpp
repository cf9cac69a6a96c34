// Tests output names with fields, ranges of values, and combinations of them.
#include "scheduler/sets/render_axes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Optional;
using ::testing::SizeIs;

TEST(FillIn, PutsInValuesAndWidensNumbers) {
  const NameFields fields{{"scene", "room"}, {"seed", "7"}, {"integrator.max_depth", "-2"}};
  const std::pair<const char*, const char*> cases[] = {{"", ""},
                                                       {"plain.exr", "plain.exr"},
                                                       {"{scene}-{seed:03}.exr", "room-007.exr"},
                                                       {"{seed}{seed:3}", "7  7"},
                                                       {"{seed:1}", "7"},
                                                       {"{integrator.max_depth:04}", "-002"},
                                                       {"{scene}{scene}", "roomroom"}};
  for (const auto& [text, filled] : cases) {
    const auto result = fill_in(text, fields);
    ASSERT_TRUE(result) << text << ": " << result.error().message;
    EXPECT_EQ(*result, filled);
  }
}

TEST(FillIn, SaysWhatIsWrong) {
  const NameFields fields{{"scene", "room"}, {"seed", "7"}};
  const std::pair<const char*, const char*> cases[] = {
      {"{scen}", "'{scen}' is no field of a name here; these are: {scene}, {seed}"},
      {"a{scene", "a '{' without its '}'"},
      {"{scene:03}", "{scene:03} is for a whole number, not 'room'"},
      {"{seed:x}", "the width of {seed:x} is none"},
      {"{seed:0}", "the width of {seed:0} is none"},
      {"{seed:-3}", "the width of {seed:-3} is none"},
      {"{seed:99999999999999999999}", "the width of"},
      {"{}", "'{}' is no field"}};
  for (const auto& [text, error] : cases) {
    const auto result = fill_in(text, fields);
    ASSERT_FALSE(result) << text;
    EXPECT_THAT(result.error().message, HasSubstr(error));
  }
}

TEST(FillIn, FieldsAreFoundByTheirWholeName) {
  EXPECT_TRUE(has_field("a.{frame:04}.xml", "frame"));
  EXPECT_TRUE(has_field("{x}{frame}", "frame"));
  EXPECT_FALSE(has_field("{frames}", "frame"));
  EXPECT_FALSE(has_field("frame", "frame"));
  EXPECT_FALSE(has_field("{frame", "frame"));
}

TEST(RangeOf, CountsBothEnds) {
  EXPECT_THAT(range_of("3..5"), Optional(ElementsAre("3", "4", "5")));
  EXPECT_THAT(range_of("4..4"), Optional(ElementsAre("4")));
  EXPECT_THAT(range_of("1..10x4"), Optional(ElementsAre("1", "5", "9")));
  EXPECT_THAT(range_of("0..9223372036854775807x9223372036854775806"),
              Optional(ElementsAre("0", "9223372036854775806")));
  EXPECT_THAT(range_of("0..999999"), Optional(SizeIs(1'000'000)));
  for (const char* none : {"", "3", "..", "3..", "..3", "5..3", "-1..3", "1..5x0", "1..5x-1", "1..5x",
                           "1...5", "1..5y2", "a..b", "0..1000000", "0..99999999999999999999"})
    EXPECT_EQ(range_of(none), std::nullopt) << none;
}

TEST(AllChoices, TheLastAxisChangesFastest) {
  std::vector<RenderAxis> axes;
  set_axis(axes, {AxisKind::kScene, "scene", {"a", "b"}});
  set_axis(axes, {AxisKind::kOption, "seed", {"1", "2", "3"}});
  set_axis(axes, {AxisKind::kDefine, "seed", {"x"}});  // a variable of that name is another thing
  EXPECT_EQ(count_combinations(axes, 6), 6);
  EXPECT_EQ(count_combinations(axes, 5), 0);
  EXPECT_THAT(all_choices(axes), ElementsAre(ElementsAre("a", "1", "x"), ElementsAre("a", "2", "x"),
                                             ElementsAre("a", "3", "x"), ElementsAre("b", "1", "x"),
                                             ElementsAre("b", "2", "x"), ElementsAre("b", "3", "x")));
  set_axis(axes, {AxisKind::kOption, "seed", {"9"}});
  EXPECT_THAT(all_choices(axes), ElementsAre(ElementsAre("a", "9", "x"), ElementsAre("b", "9", "x")));
}

TEST(AllChoices, HugeProductsAreCountedWithoutOverflow) {
  std::vector<RenderAxis> axes;
  for (const char* name : {"a", "b", "c", "d"})
    axes.push_back({AxisKind::kOption, name, std::vector<std::string>(100'000, "0")});
  EXPECT_EQ(count_combinations(axes, 1'000'000), 0);
}

}  // namespace
}  // namespace penumbra
