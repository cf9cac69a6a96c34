// Shell completion: the proposals that the programs print, and how shells use them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;
using Words = std::vector<std::string>;

class CompletionOf : public ::testing::Test {
 protected:
  Words lines_of(const ProgramResult& result) {
    EXPECT_EQ(result.exit_code, 0) << result.err;
    Words lines;
    std::istringstream stream(result.out);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
  }
  /// Without help.
  Words complete(Words words) {
    words.insert(words.begin(), "complete");
    Words found = lines_of(run_penumbra(folder_.path(), words));
    for (std::string& line : found) line = line.substr(0, line.find('\t'));
    return found;
  }
  /// What bash puts in for `word`, the end of the line that it would replace.
  Words in_bash(const std::string& line, const std::string& word) {
    write_text(folder_ / "line", line);
    return lines_of(run_shell(folder_.path(),
                              "eval \"$(penumbra completion bash)\"\nCOMP_LINE=$(<line); "
                              "COMP_POINT=${#COMP_LINE}; _penumbra \"${COMP_LINE%% *}\" '" +
                                  word +
                                  "' ''\n"
                                  "if ((${#COMPREPLY[@]})); then printf '%s\\n' \"${COMPREPLY[@]}\"; fi"));
  }

  TemporaryFolder folder_;
};

TEST_F(CompletionOf, Commands) {
  EXPECT_THAT(complete({""}), AllOf(Contains("render"), Contains("info"), Contains("worker"),
                                    Contains("completion"), Not(Contains(StartsWith("-")))));
  EXPECT_THAT(complete({"re"}), UnorderedElementsAre("render", "report", "retry"));
  EXPECT_THAT(complete({"--v"}), ElementsAre("--version"));
  EXPECT_THAT(complete({"man", "rend"}), ElementsAre("render"));
  EXPECT_THAT(complete({"nothing-of-the-kind"}), IsEmpty());
}

TEST_F(CompletionOf, OptionsAndTheirValues) {
  EXPECT_THAT(complete({"render", "--sa"}), ElementsAre("--sampler"));
  EXPECT_THAT(complete({"render", "--sampler", "s"}), UnorderedElementsAre("stratified", "sobol", "scene"));
  EXPECT_THAT(complete({"render", "--sampler=so"}), ElementsAre("--sampler=sobol"));
  EXPECT_THAT(complete({"render", "--seed", ""}), IsEmpty()) << "a number";
  EXPECT_THAT(complete({"render", "--seed", "4", "--qui"}), ElementsAre("--quiet"));
  EXPECT_THAT(complete({"render", "--quiet", "--samp"}), ElementsAre("--sampler")) << "a flag takes no value";
  EXPECT_THAT(complete({"render", "--set", "film.comp"}),
              UnorderedElementsAre("film.component_format=", "film.compression="));
  EXPECT_THAT(complete({"render", "--set", "film.compression=d"}),
              UnorderedElementsAre("film.compression=dwaa", "film.compression=dwab"));
  EXPECT_THAT(complete({"render", "--set", "integrator.hide_emitters=t"}),
              ElementsAre("integrator.hide_emitters=true"));
}

TEST_F(CompletionOf, Files) {
  for (const Words& words : {Words{"render", ""},
                             {"render", "a.xml", "b"},
                             {"render", "-o", ""},
                             {"compare", "a.exr", ""},
                             {"render", "--", "-x"}})
    EXPECT_THAT(complete(words), ElementsAre(":files")) << words.back();
}

TEST_F(CompletionOf, ProgramsOfTheirOwn) {
  EXPECT_THAT(complete({"worker", "--li"}), ElementsAre("--list-devices"));
  EXPECT_THAT(complete({"worker", "--backend", "n"}), ElementsAre("native"));
  EXPECT_THAT(complete({"stress", "--ca"}), ElementsAre("--case"));
  if (has_window())
    EXPECT_THAT(complete({"view", "--scr"}), UnorderedElementsAre("--script", "--screenshot"));
}

TEST_F(CompletionOf, Bash) {
  ASSERT_EQ(run_shell(folder_.path(), "penumbra completion bash > c && bash -n c").exit_code, 0);
  EXPECT_THAT(in_bash("penumbra rend", "rend"), ElementsAre("render"));
  EXPECT_THAT(in_bash("penumbra render --inte", "--inte"),
              UnorderedElementsAre("--integrator", "--intersector"));
  EXPECT_THAT(in_bash("penumbra render --integrator path_m", "path_m"),
              UnorderedElementsAre("path_mats", "path_mis"));
  // bash splits words at =.
  EXPECT_THAT(in_bash("penumbra render --set film.compression=d", "d"), UnorderedElementsAre("dwaa", "dwab"));
  EXPECT_THAT(in_bash("penumbra render --integrator=w", "w"), ElementsAre("whitted"));
  EXPECT_THAT(in_bash("penumbra-worker --backend ", ""), UnorderedElementsAre("native", "opencl", "auto"));
  write_text(folder_ / "my scene.xml", "");
  EXPECT_THAT(in_bash("penumbra render my", "my"), ElementsAre("my scene.xml"));
  // $(...) of a name is not run.
  EXPECT_THAT(in_bash("penumbra render --set $(touch${IFS}bad)", "$(touch${IFS}bad)"), IsEmpty());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "bad"));
}

TEST_F(CompletionOf, ZshAndFishParseTheirs) {
  bool any = false;
  for (const char* shell : {"zsh", "fish"}) {
    if (run_shell(folder_.path(), std::string("command -v ") + shell).exit_code != 0) continue;
    any = true;
    const std::string line = std::string("penumbra completion ") + shell + " > c && " + shell + " -n c";
    EXPECT_EQ(run_shell(folder_.path(), line).exit_code, 0) << shell;
  }
  if (!any) GTEST_SKIP() << "there is neither zsh nor fish";
}

TEST_F(CompletionOf, FishOffersWhatThereIs) {
  if (run_shell(folder_.path(), "command -v fish").exit_code != 0) GTEST_SKIP() << "there is no fish";
  const auto offered = [&](const std::string& line) {
    return lines_of(run_shell(
        folder_.path(),
        "export HOME=$PWD; fish -c 'penumbra completion fish | source; complete -C \"" + line + "\"'"));
  };
  EXPECT_THAT(offered("penumbra ren"), ElementsAre(StartsWith("render\t")));
  EXPECT_THAT(offered("penumbra render --set film.compression=d"),
              UnorderedElementsAre("film.compression=dwaa", "film.compression=dwab"));
}

}  // namespace
}  // namespace penumbra
