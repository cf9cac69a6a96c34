// Help, version, and errors of invalid command lines.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "worker/device.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Not;

ProgramResult run(const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  ProgramResult result = run_penumbra(folder.path(), arguments);
  EXPECT_THAT(folder.names(), IsEmpty()) << "files were written";
  return result;
}

TEST(Usage, VersionAndHelpSucceed) {
  const ProgramResult version = run({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out, MatchesRegex("penumbra [0-9]+\\.[0-9]+\\.[0-9]+\n(.|\n)*"));
  for (const std::string& line : std::vector<std::string>{
           "\ncommit: ", "\ncompiler: ", "\ninstruction sets: " + isa_list(built_isas()) + "; this machine: ",
           "\nbackends: ", "\nlibraries:        Embree 3.", "OpenImageIO 2.", "gRPC 1."})
    EXPECT_THAT(version.out, HasSubstr(line));
  const ProgramResult help = run({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.err, IsEmpty());
  for (const char* command : {"render", "info", "compare", "worker", "Examples"}) {
    EXPECT_THAT(help.out, HasSubstr(command));
  }
}

TEST(Usage, EveryProgramNamesItselfInAUsageError) {
  const std::pair<std::vector<std::string>, const char*> mistakes[] = {
      {{"render", "--sp", "4"}, "penumbra render: error: unexpected argument '--sp'; did you mean '--spp'?"},
      {{"worker", "--thread", "4"},
       "penumbra-worker: error: unexpected argument '--thread'; did you mean '--threads'?"},
      {{"view", "--scrip", "a"},
       "penumbra-view: error: unexpected argument '--scrip'; did you mean '--script'?"},
      {{"stress", "--cas", "a"},
       "penumbra stress: error: unexpected argument '--cas'; did you mean '--case'?"}};
  for (const auto& [arguments, message] : mistakes) {
    const ProgramResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
}

TEST(Usage, EveryCommandHasHelpWithExamples) {
  for (const char* command : {"render", "preview", "info", "compare"}) {
    const ProgramResult help = run({command, "--help"});
    EXPECT_EQ(help.exit_code, 0) << command;
    EXPECT_THAT(help.out, HasSubstr(std::string("penumbra ") + command));
    if (std::string(command) != "preview") EXPECT_THAT(help.out, HasSubstr("Examples"));
  }
}

TEST(Usage, HelpNamesTheOptionsThatThereAreAndNoOthers) {
  const std::string help = run({"render", "--help"}).out;
  for (const char* option : {"--out",           "--integrator",
                             "--spp",           "--seed",
                             "--backend",       "--workers",
                             "--threads",       "--tile",
                             "--pass",          "--time-budget",
                             "--stop-after",    "--crop",
                             "--pixel",         "--report",
                             "--no-report",     "-D",
                             "--set",           "--lenient",
                             "--dialect",       "--sampler",
                             "--intersector",   "--isa",
                             "--opencl-device", "--device",
                             "--no-features",   "--quiet",
                             "--listen",        "--tev",
                             "--resume",        "--checkpoint-interval",
                             "--target-error",  "--adaptive",
                             "--launch",        "--estimate"}) {
    EXPECT_THAT(help, HasSubstr(option));
  }
  for (const char* option : {"--connect", "--cache"}) {
    EXPECT_THAT(help, Not(HasSubstr(option)));
  }
}

TEST(Usage, MistakesAreCode2AndSayWhereHelpIs) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> mistakes = {
      {{}, "subcommand is required"},
      {{"rendre", "a.xml"}, "unexpected argument 'rendre'; did you mean 'render'?"},
      {{"--sppp"}, "unexpected argument '--sppp'"},
      {{"render"}, "SCENE is required"},
      {{"render", "a.xml", "--sedd", "3"}, "unexpected argument '--sedd'; did you mean '--seed'?"},
      {{"render", "a.xml", "--spp", "0"}, "--spp"},
      {{"render", "a.xml", "--spp"}, "--spp"},
      {{"render", "a.xml", "--crop", "5,5,1,1"}, "'5,5,1,1' is not x0,y0,x1,y1"},
      {{"render", "a.xml", "--pixel", "5"}, "'5' is not x,y"},
      {{"render", "a.xml", "-D", "albedo"}, "'albedo' is not of the form name=value"},
      {{"render", "a.xml", "--backend", "cuda"}, "cuda"},
      {{"info"}, "SCENE is required"},
      {{"compare", "a.exr"}, "B is required"},
      {{"compare", "a.exr", "b.exr", "--tolerance", "-1"}, "--tolerance"},
      {{"compare", "a.exr", "b.exr", "--tolerance", "nan"}, "'nan' is not a finite number"},
      {{"compare", "a.exr", "b.exr", "--epsilon", "nan"}, "'nan' is not a finite number"},
      {{"compare", "a.exr", "b.exr", "--fail-above", "relmse=nan"}, "'nan' is not a number"},
      {{"render", "a.xml", "--time-budget", "nan"}, "'nan' is not a finite number"},
      {{"render", "a.xml", "--time-budget", "inf"}, "'inf' is not a finite number"},
      {{"render", "a.xml", "--time-budget", "0"}, "0 is not above 0"},
      {{"render", "a.xml", "--time-budget", "-1"}, "-1 is not above 0"},
      {{"render", "a.xml", "--spp", "4294967295"}, "range from 1 to 2147483648"},
      {{"report", "a.xml", "-o", "x", "--epsilon", "nan"}, "'nan' is not a finite number"},
  };
  for (const auto& [arguments, message] : mistakes) {
    const ProgramResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, AllOf(HasSubstr(message), HasSubstr("--help")));
    EXPECT_THAT(result.out, IsEmpty());
  }
}

TEST(Usage, PreviewHasNoOptionsThatAWindowDecidesOn) {
  const std::string help = run({"preview", "--help"}).out;
  for (const char* option : {"--listen", "--tev", "--workers", "--spp", "--set"})
    EXPECT_THAT(help, HasSubstr(option));
  for (const char* option : {"--out", "--crop", "--pass", "--time-budget", "--report"})
    EXPECT_THAT(help, Not(HasSubstr(option)));
}

TEST(Usage, WorkerCommandStartsTheWorkerProgram) {
  const ProgramResult help = run({"worker", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("--connect"));
}

}  // namespace
}  // namespace penumbra
