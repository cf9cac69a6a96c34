// Every command of the main README works: its blocks are run unchanged, beside scenes/.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;

struct Block {
  std::string heading;
  std::vector<std::string> lines;
};

void PrintTo(const Block& block, std::ostream* out) { *out << block.heading; }

std::string readme() { return file_contents(source_path("README.md")); }

bool is_command(const std::string& line) {
  return line.starts_with("penumbra ") || line.starts_with("bash ") || line.starts_with("export ");
}

/// Indented blocks of commands, with the heading that they stand under.
std::vector<Block> command_blocks() {
  std::vector<Block> blocks;
  std::istringstream text(readme());
  std::string heading;
  bool inside = false;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("#")) heading = line.substr(line.find(' ') + 1);
    const bool indented = line.starts_with("    ");
    if (indented && is_command(line.substr(4))) {
      if (!inside) blocks.push_back({heading, {}});
      blocks.back().lines.push_back(line.substr(4));
    }
    inside = indented;
  }
  return blocks;
}

/// The command without its comment.
std::string without_comment(const std::string& line) {
  std::string command = line.substr(0, line.find(" # "));
  return command.substr(0, command.find_last_not_of(' ') + 1);
}

class ReadmeCommands : public testing::TestWithParam<Block> {
 protected:
  void SetUp() override {
    std::filesystem::create_directory_symlink(source_path("scenes"), folder_ / "scenes");
  }
  TemporaryFolder folder_;
};

TEST_P(ReadmeCommands, AllWork) {
  for (const std::string& line : GetParam().lines) {
    std::string command = without_comment(line);
    if (command.starts_with("bash ")) {
      // They build and test; CI runs them.
      EXPECT_THAT(file_contents(source_path(".ci/run")), HasSubstr(command)) << "not run by CI";
      continue;
    }
    if (command.starts_with("penumbra view ")) {
      // A window stays open until it is closed: a script does that.
      const bool is_shot = command.find(".exr") != std::string::npos;
      write_text(folder_ / "close.txt",
                 is_shot ? "wait frame 0\nquit\n" : "wait analytic\nkey space\nwait samples 1\nquit\n");
      command = "xvfb-run -a " + command + " --hidden --script close.txt";
    }
    const ProgramResult result = run_shell(folder_.path(), command);
    EXPECT_EQ(result.exit_code, 0) << line << "\n" << result.out << result.err;
  }
}

INSTANTIATE_TEST_SUITE_P(Blocks, ReadmeCommands, testing::ValuesIn(command_blocks()), [](const auto& tested) {
  std::string name = tested.param.heading + "_" + std::to_string(tested.index);
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});

}  // namespace
}  // namespace penumbra
