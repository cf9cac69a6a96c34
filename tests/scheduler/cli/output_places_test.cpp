// Where the programs write: folders that do not exist or vanish, links, devices, pipes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "scheduler/image/image.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class OutputPlaces : public ::testing::Test {
 protected:
  void SetUp() override {
    write_small_scene(folder_ / "s.xml");
    std::filesystem::create_directory(folder_ / "tmp");
  }
  ProgramResult shell(const std::string& line) const {
    return run_shell(folder_.path(), "export TMPDIR=$PWD/tmp\n" + line);
  }
  /// Files kept in TMPDIR.
  std::vector<std::filesystem::path> rescued() const {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "tmp"))
      if (entry.is_regular_file()) files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
  }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder_ / name); }
  TemporaryFolder folder_;
};

TEST_F(OutputPlaces, MissingFoldersAreMade) {
  const ProgramResult render = shell("penumbra render s.xml -q -o a/b/c.exr --report d/r.json");
  EXPECT_EQ(render.exit_code, 0) << render.err;
  EXPECT_TRUE(exists("a/b/c.exr") && exists("a/b/c.png") && exists("d/r.json"));
  const ProgramResult compare =
      shell("penumbra compare a/b/c.exr a/b/c.exr --json e/c.json --heatmap f/map.png");
  EXPECT_EQ(compare.exit_code, 0) << compare.err;
  EXPECT_TRUE(exists("e/c.json") && exists("f/map.png"));
  const ProgramResult stress =
      shell("penumbra stress --backend native --case polygon/ --json g/s.json --html h/s.html");
  EXPECT_EQ(stress.exit_code, 0) << stress.err;
  EXPECT_TRUE(exists("g/s.json") && exists("h/s.html"));
}

TEST_F(OutputPlaces, BadInputLeavesNoFolders) {
  const auto before = folder_.names();
  for (const char* line :
       {"penumbra render missing.xml -o new/a.exr", "penumbra render s.xml --crop 0,0,99,99 -o new/a.exr",
        "penumbra render s.xml --backend opencl --device nothing -o new/a.exr",
        "penumbra compare s.xml s.xml --json new/c.json", "penumbra report missing.xml --no-plots -o new",
        "penumbra stress --case nothing --json new/s.json",
        "penumbra stress --backend native --json new/s.json --html new/s.json"}) {
    const ProgramResult result = shell(line);
    EXPECT_EQ(result.exit_code, 2) << line << "\n" << result.err;
    EXPECT_EQ(folder_.names(), before) << line;
  }
}

TEST_F(OutputPlaces, DevicesPipesAndLinksStayWhatTheyAre) {
  // Devices are reached by links of our own: if this code is broken and runs as root, it damages only these
  // links.
  std::filesystem::create_symlink("/proc/self/fd/1", folder_ / "out");
  const ProgramResult report = shell("penumbra render s.xml -q --report out");
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_TRUE(nlohmann::json::parse(report.out)["complete"]);
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "out"));

  std::filesystem::create_symlink("/dev/null", folder_ / "null");
  EXPECT_EQ(shell("penumbra render s.xml -q --report null").exit_code, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "null"));

  const ProgramResult pipe =
      shell("mkfifo pipe; cat pipe >got & penumbra render s.xml -q --report pipe && wait && test -p pipe");
  EXPECT_EQ(pipe.exit_code, 0) << pipe.err;
  EXPECT_TRUE(nlohmann::json::parse(file_contents(folder_ / "got"))["complete"]);

  std::filesystem::create_directory(folder_ / "real");
  std::filesystem::create_symlink("real/image.exr", folder_ / "s.link.exr");
  EXPECT_EQ(shell("penumbra render s.xml -q --no-report -o s.link.exr").exit_code, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "s.link.exr"));
  EXPECT_TRUE(read_image(folder_ / "real/image.exr"));
}

TEST_F(OutputPlaces, AWindowChecksItsFilesBeforeItsDisplay) {
  if (!has_window()) GTEST_SKIP() << "built without the window";
  const std::string view = "unset DISPLAY WAYLAND_DISPLAY; penumbra view ";
  const ProgramResult missing = shell(view + "nothere.xml");
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err, AllOf(HasSubstr("there is no file 'nothere.xml'"), Not(HasSubstr("DISPLAY"))));
  write_text(folder_ / "steps.png", "quit\n");
  const ProgramResult script = shell(view + "s.xml --script steps.png --screenshot ./steps.png");
  EXPECT_EQ(script.exit_code, 2);
  EXPECT_THAT(script.err, HasSubstr("is an input of this command"));
}

TEST_F(OutputPlaces, InputsAreNotOverwritten) {
  ASSERT_EQ(shell("penumbra render s.xml -q && cp s.exr other.exr && ln s.exr hard.exr").exit_code, 0);
  const std::string image = file_contents(folder_ / "s.exr");
  for (const char* line : {"penumbra compare s.exr other.exr --heatmap hard.exr",
                           "penumbra compare other.exr s.exr --json s.exr",
                           "penumbra compare other.exr other.exr --variance s.exr --json ./s.exr"}) {
    const ProgramResult result = shell(line);
    EXPECT_EQ(result.exit_code, 2) << line;
    EXPECT_THAT(result.err, HasSubstr("is an input of this command")) << line;
  }
  EXPECT_EQ(file_contents(folder_ / "s.exr"), image);
}

TEST_F(OutputPlaces, AFolderThatVanishesCostsNothing) {
  Program render(folder_.path(), "/bin/bash",
                 {"-c", "export TMPDIR=$PWD/tmp; exec " PENUMBRA_BINARY_DIR
                        "/penumbra render s.xml -o out/a.exr --spp 1000000000 --pass 64 --time-budget 2"});
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!exists("out") && std::chrono::steady_clock::now() < patience)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::filesystem::remove_all(folder_ / "out");
  const ProgramResult result = render.wait();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("cannot write out/a.exr: the folder out does not exist"),
                                HasSubstr("written instead: " + (folder_ / "tmp").string())));
  const auto files = rescued();
  ASSERT_EQ(files.size(), 3u) << result.err;
  EXPECT_EQ(files[0].filename(), "a.exr");
  EXPECT_TRUE(read_image(files[0]));
  const auto statistics = nlohmann::json::parse(file_contents(files[1]));
  EXPECT_EQ(statistics["complete"], false) << "there was no time for all samples";
  EXPECT_EQ(statistics["ended_by"], "time_budget");
  EXPECT_FALSE(exists("out"));
}

TEST_F(OutputPlaces, AFullDiskCostsNothing) {
  std::filesystem::create_symlink("/dev/full", folder_ / "a.exr");
  const ProgramResult result = shell("penumbra render s.xml -o a.exr");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("cannot write"));
  EXPECT_THAT(result.err, HasSubstr("No space left on device; written instead: "));
  ASSERT_EQ(rescued().size(), 1u);
  EXPECT_TRUE(read_image(rescued().front()));
  EXPECT_TRUE(exists("a.png") && exists("a.json"));

  // A file that grows too large does not end the program.
  const ProgramResult limited = shell("ulimit -f 4; penumbra render s.xml -o b.exr");
  EXPECT_EQ(limited.exit_code, 1) << limited.signal;
  EXPECT_THAT(limited.err, AllOf(HasSubstr("File too large"), HasSubstr("lost, as there is no room")));
  EXPECT_FALSE(exists("b.exr"));
}

}  // namespace
}  // namespace penumbra
