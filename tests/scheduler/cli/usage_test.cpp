// Help, version, and errors of invalid command lines.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

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
  const std::string help = run({"render", "--help-all"}).out;
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

TEST(Usage, TheHelpOfLargeCommandsIsShortUnlessAllIsAskedFor) {
  for (const char* command : {"render", "submit"}) {
    const std::string help = run({command, "--help"}).out, all = run({command, "--help-all"}).out;
    EXPECT_LT(std::ranges::count(help, '\n'), 80) << command;
    EXPECT_LT(3 * std::ranges::count(help, '\n'), 2 * std::ranges::count(all, '\n')) << command;
    for (const char* text : {"--spp", "--out", "--help-all shows all options", "\nExamples:\n"})
      EXPECT_THAT(help, HasSubstr(text)) << command;
    EXPECT_THAT(help, Not(HasSubstr("--intersector")));
    EXPECT_THAT(all, AllOf(HasSubstr("--intersector"), HasSubstr("--spp"), HasSubstr("\nExamples:\n")));
  }
  EXPECT_THAT(run({"man", "render"}).out, HasSubstr("intersector"));
  EXPECT_THAT(run({"complete", "render", "--inters"}).out, HasSubstr("--intersector"));
}

TEST(Usage, WordsStandForFlags) {
  EXPECT_EQ(run({"help"}).out, run({"--help"}).out);
  EXPECT_EQ(run({"help", "info"}).out, run({"info", "--help"}).out);
  EXPECT_EQ(run({"help", "worker"}).out, run({"worker", "--help"}).out);
  EXPECT_EQ(run({"version"}).out, run({"--version"}).out);
  const ProgramResult unknown = run({"help", "rendre"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean 'render'?"));
}

TEST(Usage, NamesOfOtherProgramsAreExplained) {
  const std::pair<std::vector<std::string>, const char*> mistakes[] = {
      {{"scene.xml"}, "'scene.xml'; to render it: penumbra render scene.xml"},
      {{"a b.pbrt", "--spp", "4"}, "penumbra render 'a b.pbrt'"},
      {{"a.exr"}, "to show it: penumbra view a.exr"},
      {{"render", "a.xml", "--samples", "4"}, "'--samples'; say --spp N"},
      {{"render", "a.xml", "--width=640"}, "say --set film.width=VALUE"},
      {{"render", "a.xml", "--max-depth", "3"}, "say --set integrator.max_depth=VALUE"},
      {{"render", "a.xml", "--resolution", "640x480"}, "--set film.width=W --set film.height=H"},
      {{"render", "a.xml", "--size", "640x480"}, "or --scale 50%"},
      {{"info", "a.xml", "--height", "3"}, "say --set film.height=VALUE"},
      {{"render", "a.xml", "--spp", "1-8"}, "takes one number, a list in a job file takes several"},
      {{"render", "a.xml", "--seed", "1..8"}, "takes one number"},
      {{"render", "a.xml", "--denoise", "nfor"}, "'nfor' is taken for a scene here: --denoise=nfor"},
      {{"render", "a.xml", "--denoise=nformer"}, "'nformer' is none of"},
      {{"denoise", "a.exr", "--method=nlmean"},
       "'nlmean' is none of nfor, nlmeans, oidn; did you mean 'nlmeans'?"},
      {{"render", "a.xml", "--integrator", "pathh"}, "did you mean 'path'?"},
      {{"worker", "--connect", "unix:/a", "--threads", "many"}, "'many' is neither a whole number from 1 to"},
      {{"worker", "--connect", "unix:/a", "--cache-size", "much"}, "'much' is no size in bytes, as in 20G"},
      {{"compare", "a.exr", "b.exr", "--flip", "hdri"}, "did you mean 'hdr'?"},
      {{"compare", "a.exr", "b.exr", "--fail-above", "relative_mse=1"}, "there is no metric 'relative_mse'"},
      {{"convert", "missing.xml", "b.xml"}, "there is no file 'missing.xml'"},
  };
  for (const auto& [arguments, message] : mistakes) {
    const ProgramResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
}

TEST(Usage, TheNearestFileIsNamed) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "scenes");
  write_text(folder / "scenes/cornell.xml", "<scene version='3.0.0'/>");
  write_text(folder / "picture.exr", "no image");
  const std::pair<std::vector<std::string>, const char*> mistakes[] = {
      {{"render", "scenes/cornel.xml"},
       "there is no file 'scenes/cornel.xml'; did you mean 'scenes/cornell.xml'?"},
      {{"render", "scene/cornell.xml"}, "did you mean 'scenes/cornell.xml'?"},
      {{"info", "scenes/quite-another.xml"}, "there is no file 'scenes/quite-another.xml'"},
      {{"denoise", "pictures.exr"}, "pictures.exr: no such file; did you mean 'picture.exr'?"}};
  for (const auto& [arguments, message] : mistakes) {
    const ProgramResult result = run_penumbra(folder.path(), arguments);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
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
      {{"render", "a.xml", "--spp"}, "--spp needs a value"},
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
