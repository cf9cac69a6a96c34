// The programs while standard output or standard error is full, closed, or no longer read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string_view>

#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class StandardStreams : public ::testing::Test {
 protected:
  void SetUp() override { write_small_scene(folder_ / "s.xml"); }
  ProgramResult shell(const std::string& line) const { return run_shell(folder_.path(), line); }
  /// Whatever a render said, or could not: it has written its files, and has not said that it failed.
  void expect_rendered(const std::string& line) const {
    const ProgramResult result = shell(line);
    EXPECT_EQ(result.exit_code, 0) << line << "\n" << result.err;
    EXPECT_THAT(folder_.names(), ElementsAre("s.exr", "s.json", "s.png", "s.xml")) << line;
    for (const char* name : {"s.exr", "s.png", "s.json"}) std::filesystem::remove(folder_ / name);
  }
  TemporaryFolder folder_;
};

TEST_F(StandardStreams, ARenderLosesNothingWhereItCannotSpeak) {
  expect_rendered("penumbra render s.xml 2>/dev/full");
  expect_rendered("penumbra render s.xml >/dev/full");
  expect_rendered("penumbra render s.xml 2>&-");
  expect_rendered("penumbra render s.xml >&- 2>&- <&-");
  expect_rendered("set -o pipefail; penumbra render s.xml 2>&1 | true");
}

TEST_F(StandardStreams, ErrorsThatCannotBeSaidAreExitCodesAllTheSame) {
  for (const char* where : {"2>/dev/full", "2>&-"}) {
    for (const char* command : {"info missing.xml", "compare a.exr b.exr", "render missing.xml", "nothing",
                                "stress --case nothing", "worker --nothing", "view --width 1"}) {
      if (std::string_view(command).starts_with("view") && !has_window()) continue;
      const std::string line = fmt::format("penumbra {} {}", command, where);
      EXPECT_EQ(shell(line).exit_code, 2) << line;
    }
  }
}

TEST_F(StandardStreams, AnAnswerThatCannotBeWrittenIsAFailure) {
  ASSERT_EQ(shell("penumbra render s.xml -q").exit_code, 0);
  for (const char* command :
       {"info s.xml", "info s.xml --json", "compare s.exr s.exr", "compare s.exr s.exr --json",
        "render s.xml --pixel 3,4", "stress --list", "worker --list-devices", "--help", "render --help",
        "worker --help", "stress --help", "view --help", "--version"}) {
    if (std::string_view(command).starts_with("view") && !has_window()) continue;
    const ProgramResult good = shell(fmt::format("penumbra {}", command));
    EXPECT_EQ(good.exit_code, 0) << command << good.err;
    const ProgramResult full = shell(fmt::format("penumbra {} >/dev/full", command));
    EXPECT_EQ(full.exit_code, 1) << command;
    EXPECT_THAT(full.err, HasSubstr("error: cannot write to standard output: No space left on device"))
        << command;
    const ProgramResult closed = shell(fmt::format("penumbra {} >&-", command));
    EXPECT_EQ(closed.exit_code, 1) << command;
    EXPECT_THAT(closed.err, HasSubstr("cannot write to standard output: it is closed")) << command;
  }
}

TEST_F(StandardStreams, AReaderThatWentAwayIsNotWorthAWord) {
  const ProgramResult result = shell(
      "(sleep 1; penumbra info s.xml; echo $? >code) 2>said | true; sleep 0.1; while [ ! -s code ]; do "
      "sleep 0.1; done");
  EXPECT_EQ(file_contents(folder_ / "code"), "1\n");
  EXPECT_EQ(file_contents(folder_ / "said"), "");
}

TEST_F(StandardStreams, NamesDoNotReachTheTerminalAsCommands) {
  const ProgramResult error = shell("penumbra info $'no\\e[2Jthing\\x9b.xml'");
  EXPECT_EQ(error.exit_code, 2);
  EXPECT_THAT(error.err, HasSubstr("no\\u001b[2Jthing\\x9b.xml"));
  EXPECT_THAT(shell("penumbra $'\\e[2J'").err, HasSubstr("'\\u001b[2J'"));
  std::filesystem::copy_file(folder_ / "s.xml", folder_ / "a\x1b\x7f.xml");
  const ProgramResult info = shell("penumbra info $'a\\e\\x7f.xml'");
  EXPECT_THAT(info.out, HasSubstr("a\\u001b\\u007f.xml, read"));
  const ProgramResult json = shell("penumbra info --json $'a\\e\\x7f.xml'");
  EXPECT_EQ(nlohmann::json::parse(json.out)["scene"], "a\x1b\x7f.xml");
}

TEST_F(StandardStreams, WhatGrpcHasToSayIsKeptUnlessItIsWanted) {
  const std::string command = "penumbra render s.xml --quiet";
  EXPECT_THAT(shell(command).err, IsEmpty());
  const ProgramResult wanted = shell("GRPC_VERBOSITY=debug " + command);
  EXPECT_EQ(wanted.exit_code, 0);
  EXPECT_THAT(wanted.err, StartsWith("gRPC: "));
}

}  // namespace
}  // namespace penumbra
