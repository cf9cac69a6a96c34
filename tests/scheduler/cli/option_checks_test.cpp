#include "scheduler/render/option_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "scenes/settings.h"
#include "scheduler/report/report_options.h"
#include "scheduler/run/render_options.h"
#include "worker/cli/command_line.h"

namespace penumbra {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

std::string wrong(const OptionCheck& check, std::string text) { return check.wrong(text); }

TEST(OptionChecks, NumbersAreFiniteAndWhole) {
  for (const char* text : {"nan", "inf", "-inf", "1e999", "", "5x", "0x10", "5 5"}) {
    EXPECT_NE(wrong(whole_number(0, 10), text), "") << text;
    EXPECT_NE(wrong(positive_number(), text), "") << text;
    EXPECT_NE(wrong(number_from_zero(), text), "") << text;
    EXPECT_NE(wrong(number_between(-1, 1), text), "") << text;
  }
  EXPECT_NE(wrong(whole_number(0, 10), "1.5"), "");
  EXPECT_THAT(wrong(whole_number(1, 10), "11"), HasSubstr("not in the range from 1 to 10"));
  EXPECT_THAT(wrong(positive_number(), "0"), HasSubstr("not above 0"));
  EXPECT_NE(wrong(positive_number(), "1e-999"), "") << "which is 0";
  EXPECT_NE(wrong(number_from_zero(), "-0.1"), "");
  EXPECT_NE(wrong(number_between(-1, 1), "1.01"), "");
  for (const char* text : {"1", "0", "+1"}) EXPECT_EQ(wrong(number_between(0, 1), text), "") << text;
  EXPECT_EQ(wrong(whole_number(1, 10), "10"), "");
  EXPECT_EQ(wrong(positive_number(), "1e300"), "");
}

TEST(OptionChecks, TimesHaveUnits) {
  for (const auto& [text, seconds] : {std::pair("0s", 0.0), std::pair("90m", 5400.0),
                                      std::pair("12h", 43200.0), std::pair("1.5d", 129600.0)}) {
    std::string value = text;
    EXPECT_EQ(duration().wrong(value), "");
    EXPECT_EQ(std::stod(value), seconds);
  }
  for (const char* text : {"", "7", "d", "-1d", "nand", "infd", "7w", "1e999d"}) {
    std::string value = text;
    EXPECT_THAT(duration().wrong(value), HasSubstr("as in 30s, 90m, 12h or 7d")) << text;
  }
}

TEST(OptionChecks, SecondsMayHaveAUnit) {
  for (const auto& [text, becomes] :
       {std::pair("5s", "5"), std::pair("2m", "120"), std::pair("1.5h", "5400"), std::pair("7", "7"),
        std::pair("0.25", "0.25"), std::pair("-1s", "-1s"), std::pair("many", "many")}) {
    std::string value = text;
    EXPECT_EQ(seconds().wrong(value), "");
    EXPECT_EQ(value, becomes);
  }
}

TEST(OptionChecks, HelpHasTheLimits) {
  EXPECT_EQ(whole_number(1, 10).limits, "1 to 10");
  CommandLine app("");
  RenderOptions options;
  add_render_options(app, options);
  EXPECT_THAT(app.help(), HasSubstr("[1 to " + std::to_string(kMaxTile) + "]"));
  EXPECT_EQ(whole_number(1, kMaxSamplesPerPixel).limits, "1 or more") << "for all that matters";
  EXPECT_THAT(app.help(), HasSubstr("TOML"));
}

struct Command {
  std::vector<std::string> words;
  void (*add)(CommandLine&);
};

/// Whether the command takes these words.
bool takes(const Command& command, const std::vector<std::string>& more) {
  CommandLine app("");
  command.add(app);
  std::vector<std::string> words = command.words;
  words.insert(words.end(), more.begin(), more.end());
  return app.parse(std::move(words)).has_value();
}

TEST(OptionChecks, NoOptionTakesWhatIsNoNumberForOne) {
  static RenderOptions render, preview;
  static ReportOptions report;
  const Command commands[] = {
      {{"a.xml"}, [](CommandLine& app) { add_render_options(app, render); }},
      {{"a.xml"}, [](CommandLine& app) { add_preview_options(app, preview); }},
      {{"a.xml", "-o", "out"}, [](CommandLine& app) { add_report_options(app, report); }}};
  std::vector<std::string> numeric;
  for (const Command& command : commands) {
    CommandLine app("");
    command.add(app);
    for (const Option* option : app.options()) {
      const std::string name = option->name();
      if (option->is_positional() || !takes(command, {name, "5"}) || takes(command, {name, "word"})) continue;
      numeric.push_back(name);
      for (const char* bad : {"nan", "NAN", "inf", "-inf", "infinity", "1e999", "-1e999", "1e30x", ""})
        EXPECT_FALSE(takes(command, {name, bad})) << name << " " << bad;
      EXPECT_EQ(takes(command, {name, "-1"}), name == "--exposure" || name == "--frame-offset") << name;
    }
  }
  for (const char* name :
       {"--spp", "--time-budget", "--stop-after", "--threads", "--epsilon", "--crop-time", "--seeds"})
    EXPECT_THAT(numeric, Contains(name));
}

}  // namespace
}  // namespace penumbra
