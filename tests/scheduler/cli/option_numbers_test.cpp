// Tests every option that takes a number: text that is not a number and values outside the limits are usage
// errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <tuple>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::option_numbers_test {
namespace {

using ::testing::HasSubstr;

using Arguments = std::vector<std::string>;

/// What each command needs besides. None of it is there, so that nothing happens if a number is taken.
const std::map<std::string, Arguments> kCommands = {
    {"render", {"none.xml"}},
    {"preview", {"none.xml"}},
    {"info", {"none.xml"}},
    {"advise", {"none.xml"}},
    {"keys", {"none/none"}},
    {"settings", {}},
    {"plugins", {}},
    {"convert", {"none.xml", "none/none.xml"}},
    {"denoise", {"none.exr"}},
    {"merge", {"none.exr", "none.exr", "-o", "none/none.exr"}},
    {"compare", {"none.exr", "none.exr"}},
    {"report", {"none.xml", "-o", "none"}},
    {"serve", {"--listen", "unix:none/none", "--spool", "none/none"}},
    {"submit", {"none.xml", "--to", "unix:none"}},
    {"sbatch", {"none.xml", "--folder", "none/none"}},
    {"status", {"--to", "unix:none"}},
    {"cancel", {"1", "--to", "unix:none"}},
    {"prioritize", {"1", "1", "--to", "unix:none"}},
    {"retry", {"1", "--to", "unix:none"}},
    {"fetch", {"1", "--to", "unix:none"}},
    {"worker", {"--connect", "unix:none", "--retry-for=0"}},
    {"view", {"none.xml"}},
    {"stress", {"--list"}},
};
/// What options take, as the help calls it.
const std::set<std::string> kNumbers = {"N",     "S",    "SECONDS", "P",  "E",       "SHARE", "INT",
                                        "STOPS", "DAYS", "SIZE",    "EV", "PERCENT", "TIME",  "RATE"};
const std::set<std::string> kTexts = {
    "NAME",   "NAMES", "KEY", "FILE", "FOLDER", "ADDRESS", "HOST", "COMMAND", "PROGRAM", "TEXT",  "X",
    "METRIC", "MAP",   "LOW", "KIND", "PLACE",  "DIR",     "A",    "LIST",    "MODE",    "ORDER", "STYLE"};
const std::set<std::string> kMayBeNegative = {"--exposure", "--priority", "PRIORITY", "--frame-offset"};

const std::set<std::string> kMayBeInfinite = {"--retry-for"};

struct Numbered {
  std::string command, option, limits;
};

std::vector<Numbered> numbers_of(const std::string& command) {
  const TemporaryFolder folder;
  const ProgramResult help = run_penumbra(folder.path(), {command, "--help"});
  EXPECT_EQ(help.exit_code, 0) << command;
  // "  -o, --option TYPE  what it is, in one or more lines [LOW to HIGH] …"
  static const std::regex option("^  (?:-\\w, )?(--[a-z][a-z-]*)(?:, --[a-z-]+)* ([A-Z]+)(?![A-Za-z])");
  static const std::regex limits("\\[(-?[0-9]+ to -?[0-9]+|-?[0-9]+ or more)\\]");
  std::vector<Numbered> numbers;
  std::istringstream lines(help.out);
  bool is_number = false;
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    if (line.starts_with("  -")) is_number = false;
    if (std::regex_search(line, found, option)) {
      EXPECT_TRUE(kNumbers.contains(found[2]) || kTexts.contains(found[2]))
          << line << ": what kind of value is that?";
      is_number = kNumbers.contains(found[2]);
      if (is_number) numbers.push_back({command, found[1], ""});
    }
    if (is_number && std::regex_search(line, found, limits)) numbers.back().limits = found[1];
  }
  return numbers;
}

/// A command, and whether every one of its options gets every bad value.
class OptionNumbers : public ::testing::TestWithParam<std::tuple<std::string, bool>> {};

TEST_P(OptionNumbers, AreFiniteAndWithinTheirLimits) {
  const TemporaryFolder folder;
  const auto& [name, whole] = GetParam();
  // One reader takes the text of all options: the ways of writing no number are for the first. Whether a
  // value is finite and within limits is for each option to say.
  bool all_values = true;
  for (const auto& [command, option, limits] : numbers_of(name)) {
    const bool may_be_negative = kMayBeNegative.contains(option) || limits.starts_with("-");
    Arguments bad = {"nan", "inf", "5x", may_be_negative ? "-inf" : "-1"};
    if (all_values) bad.insert(bad.end(), {"1e999", "", "word"});
    if (all_values && !may_be_negative) bad.insert(bad.end(), {"-inf", "-1e-300"});
    all_values = whole;
    if (kMayBeInfinite.contains(option))
      std::erase_if(bad, [](const auto& v) { return v == "inf" || v == "1e999"; });
    static const std::regex range("(-?[0-9]+) to (-?[0-9]+)");
    std::smatch found;
    if (std::regex_search(limits, found, range)) {
      bad.push_back(std::to_string(std::stoll(found[1]) - 1));
      bad.push_back(found[2].str() + "0");
    }
    for (const std::string& value : bad) {
      Arguments arguments = kCommands.at(command);
      arguments.insert(arguments.begin(), command);
      std::erase_if(arguments, [&](const std::string& word) { return word.starts_with(option + "="); });
      arguments.push_back(option + "=" + value);
      const ProgramResult result = run_penumbra(folder.path(), arguments);
      EXPECT_EQ(result.exit_code, 2) << command << " " << option << "=" << value;
      EXPECT_THAT(result.err, HasSubstr(option)) << command << " " << option << "=" << value;
    }
  }
}

std::vector<std::string> names() {
  std::vector<std::string> names;
  for (const auto& [name, arguments] : kCommands) names.push_back(name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(Commands, OptionNumbers,
                         ::testing::Combine(::testing::ValuesIn(names()), ::testing::Values(false)),
                         [](const auto& tested) { return std::get<0>(tested.param); });
INSTANTIATE_TEST_SUITE_P(EveryValue, OptionNumbers,
                         ::testing::Combine(::testing::ValuesIn(names()), ::testing::Values(true)),
                         [](const auto& tested) { return std::get<0>(tested.param); });

TEST(OptionNumbersOf, KnowEveryCommand) {
  const TemporaryFolder folder;
  std::istringstream lines(run_penumbra(folder.path(), {"complete", ""}).out);
  for (std::string line; std::getline(lines, line);) {
    const std::string command = line.substr(0, line.find_first_of(" \t"));
    if (command.empty() || command.starts_with("-")) continue;
    if (command == "man" || command == "complete" || command == "completion") continue;
    EXPECT_TRUE(kCommands.contains(command)) << command;
  }
}

}  // namespace
}  // namespace penumbra::option_numbers_test
