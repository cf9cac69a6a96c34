// The manual has a page for each program and command, and groff and mandoc read the pages without warnings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string command_page(const TemporaryFolder& folder, const std::string& command) {
  std::vector<std::string> arguments{"man"};
  if (!command.empty()) arguments.push_back(command);
  const ProgramResult page = run_penumbra(folder.path(), arguments);
  EXPECT_EQ(page.exit_code, 0) << command << page.err;
  return page.out;
}

/// Of `penumbra`, and the names of all its commands.
std::vector<std::string> all_commands(const TemporaryFolder& folder) {
  std::vector<std::string> commands{""};
  std::istringstream lines(run_penumbra(folder.path(), {"complete", ""}).out);
  for (std::string line; std::getline(lines, line);) commands.push_back(line.substr(0, line.find('\t')));
  if (!has_window()) std::erase(commands, "view");
  return commands;
}

TEST(Manual, HasAPageOfEveryCommandInTheBuild) {
  const TemporaryFolder folder;
  const std::vector<std::string> commands = all_commands(folder);
  ASSERT_GT(commands.size(), 10u);
  for (const std::string& command : commands) {
    const std::string name = command.empty() ? "penumbra" : "penumbra-" + command;
    const std::string page = command_page(folder, command);
    EXPECT_EQ(page, file_contents(PENUMBRA_BINARY_DIR "/share/man/man1/" + name + ".1")) << name;
    EXPECT_THAT(page, AllOf(HasSubstr(".SH NAME\n"), HasSubstr(".SH SYNOPSIS\n"))) << name;
  }
}

TEST(Manual, SaysWhatTheHelpSays) {
  const TemporaryFolder folder;
  const std::string page = command_page(folder, "render");
  EXPECT_THAT(page,
              AllOf(HasSubstr("\\fB\\-\\-integrator\\fR \\fINAME\\fR\n"),
                    HasSubstr("\\fB\\-o\\fR, \\fB\\-\\-out\\fR"), HasSubstr("Values: auto, portable, embree"),
                    HasSubstr("Default: native."), HasSubstr(".SH EXAMPLES\n")));
  EXPECT_EQ(run_penumbra(folder.path(), {"man", "nothing"}).exit_code, 2);
}

TEST(Manual, IsTakenWithoutComplaint) {
  const TemporaryFolder folder;
  const auto has = [&](const std::string& tool) {
    return run_shell(folder.path(), "command -v " + tool).exit_code == 0;
  };
  if (!has("groff") && !has("mandoc")) GTEST_SKIP() << "there is neither groff nor mandoc";
  const std::string pages = " " PENUMBRA_BINARY_DIR "/share/man/man1/*.1";
  if (has("groff")) {
    const ProgramResult read = run_shell(folder.path(), "groff -man -Tutf8 -Kutf8 -ww -z" + pages);
    EXPECT_EQ(read.exit_code, 0);
    EXPECT_THAT(read.err, IsEmpty());
  }
  if (has("mandoc")) {
    // Pages have no date, so that equal programs have equal pages.
    const ProgramResult read =
        run_shell(folder.path(), "mandoc -Tlint -W warning" + pages + " | grep -v 'missing date'");
    EXPECT_THAT(read.out, IsEmpty());
  }
}

}  // namespace
}  // namespace penumbra
