// Tests `penumbra stress` as users run it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

ProgramResult run(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "stress");
  return run_penumbra(folder.path(), arguments);
}

TEST(StressCommand, HelpNamesTheOptions) {
  const TemporaryFolder folder;
  const ProgramResult help = run(folder, {"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* option : {"--case", "--list", "--backend", "--json", "--html", "--threads", "Examples"})
    EXPECT_THAT(help.out, HasSubstr(option));
  EXPECT_THAT(run_penumbra(folder.path(), {"--help"}).out, HasSubstr("stress"));
}

TEST(StressCommand, BadUsageIsCode2) {
  const TemporaryFolder folder;
  write_text(folder / "file", "");
  const std::vector<std::pair<std::vector<std::string>, std::string>> mistakes = {
      {{"--jsn", "a"}, "unexpected argument '--jsn'; did you mean '--json'?"},
      {{"--backend", "cuda"}, "cuda"},
      {{"--case", "polygon/no-such"}, "no case matches 'polygon/no-such'"},
      {{"--threads", "0"}, "--threads"},
      {{"--case", "mis/", "--backend", "native", "--json", "file/a.json"}, "file"},
  };
  for (const auto& [arguments, message] : mistakes) {
    const ProgramResult result = run(folder, arguments);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_THAT(result.out, IsEmpty());
  }
  EXPECT_THAT(folder.names(), testing::ElementsAre("file"));
}

TEST(StressCommand, ListRunsNothing) {
  const TemporaryFolder folder;
  const ProgramResult list = run(folder, {"--list", "--case", "media/"});
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_THAT(list.out, AllOf(HasSubstr("media/optical-depth-1e8"), Not(HasSubstr("mis/"))));
}

TEST(StressCommand, ChosenCasesIntoFiles) {
  const TemporaryFolder folder;
  const ProgramResult result = run(folder, {"--backend", "native", "--case", "mis/balance-max", "--case",
                                            "merge/1-then-*", "--json", "a.json", "--html", "a.html"});
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_THAT(result.out, HasSubstr("3 passed, 0 failed"));
  std::ifstream json_file(folder.path() / "a.json");
  const auto json = nlohmann::json::parse(json_file);
  std::vector<std::string> names;
  for (const auto& c : json["cases"]) names.push_back(c["name"]);
  EXPECT_THAT(names, ElementsAre("mis/balance-max", "merge/1-then-1e8-mean", "merge/1-then-1e8-m2"));
  std::ifstream html_file(folder.path() / "a.html");
  std::stringstream html;
  html << html_file.rdbuf();
  EXPECT_THAT(html.str(), HasSubstr("merge/1-then-1e8-m2"));
}

TEST(StressCommand, ADeviceThatIsNotThereIsSkippedAndNothingTestedIsNotDone) {
  const TemporaryFolder folder;
  const ProgramResult both = run(folder, {"--opencl-device", "no-such-device", "--case", "mis/balance-max"});
  EXPECT_EQ(both.exit_code, 0) << "native passes";
  EXPECT_THAT(both.out, HasSubstr("opencl: skipped"));
  const ProgramResult alone =
      run(folder, {"--backend", "opencl", "--opencl-device", "no-such-device", "--case", "mis/balance-max"});
  EXPECT_EQ(alone.exit_code, 1);
}

}  // namespace
}  // namespace penumbra
