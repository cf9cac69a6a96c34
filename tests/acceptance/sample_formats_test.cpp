// scenes/formats/: one scene in every format. The commands of its README are run; all formats give the same
// image.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::UnorderedElementsAre;

const std::string kFolder = "scenes/formats/";

/// The commands of the README, which each render one file.
std::vector<std::string> commands() {
  std::vector<std::string> found;
  std::istringstream readme(file_contents(source_path(kFolder + "README.md")));
  for (std::string line; std::getline(readme, line);)
    if (line.starts_with("    penumbra render ")) found.push_back(line.substr(4, line.find("  ", 4) - 4));
  return found;
}

/// The name of the file that the command renders.
std::string file_of(const std::string& command) {
  const std::size_t begin = command.find(kFolder) + kFolder.size();
  return command.substr(begin, command.find(' ', begin) - begin);
}

class SampleFormats : public testing::Test {
 protected:
  SampleFormats() { std::filesystem::create_directory_symlink(source_path("scenes"), folder_ / "scenes"); }
  void expect_works(const std::string& command) {
    const ProgramResult result = run_shell(folder_.path(), command);
    EXPECT_EQ(result.exit_code, 0) << command << '\n' << result.out << result.err;
  }
  TemporaryFolder folder_;
};

TEST_F(SampleFormats, EachIsReadWithoutAWarning) {
  std::vector<std::string> endings;
  for (const std::string& command : commands()) {
    const std::string file = kFolder + file_of(command);
    endings.push_back(std::filesystem::path(file).filename().string());
    expect_works("penumbra info --strict " + file);
    EXPECT_LE(std::filesystem::file_size(source_path(file)), 4096u) << file;
  }
  EXPECT_THAT(endings,
              UnorderedElementsAre("mitsuba.xml", "nori.xml", "pbrt.pbrt", "tinyrender.toml", "gltf.gltf"));
}

/// With another seed each, at a smaller size. glTF has no filter, and its materials are
/// `metalrough`.
TEST_F(SampleFormats, AllShowTheSameImage) {
  int seed = 1;
  const auto render = [&](const std::string& command, const std::string& out) {
    expect_works(command +
                 " --set film.width=64 --set film.height=64 --set film.rfilter=box --sampler independent" +
                 " --set sampler.sample_count=128 --seed " + std::to_string(seed++) + " -o " + out);
  };
  render("penumbra render scenes/formats/mitsuba.xml", "diffuse.exr");
  render("penumbra render scenes/formats/mitsuba.xml -D material=metalrough", "metalrough.exr");
  for (const std::string& command : commands()) {
    const std::string file = file_of(command), out = file + ".exr";
    render(command.substr(0, command.find(" --spp")), out);
    expect_works("penumbra compare --z-test " + out +
                 (file == "gltf.gltf" ? " metalrough.exr" : " diffuse.exr"));
  }
}

/// As they stand, with the size and samples that they say.
TEST_F(SampleFormats, CommandsOfTheReadmeGiveImagesOfOneSize) {
  for (const std::string& command : commands()) {
    expect_works(command);
    const std::string image = file_of(command).substr(0, file_of(command).find('.')) + ".exr";
    const ProgramResult facts =
        run_shell(folder_.path(), "penumbra compare --json " + image + " mitsuba.exr");
    EXPECT_THAT(facts.out, testing::HasSubstr("\"width\": 256,\n  \"height\": 256")) << command << facts.err;
  }
}

/// Meshes and glTF are those of the script.
TEST_F(SampleFormats, TheScriptWritesTheFiles) {
  if (run_shell(folder_.path(), "python3 --version").exit_code != 0) GTEST_SKIP() << "no python3";
  expect_works("python3 scenes/formats/formats.py again");
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "again")) {
    if (!entry.is_regular_file()) continue;
    const std::string name = std::filesystem::relative(entry.path(), folder_ / "again").string();
    EXPECT_EQ(file_contents(entry.path()), file_contents(source_path(kFolder + name))) << name;
    ++files;
  }
  EXPECT_EQ(files, 7);
}

}  // namespace
}  // namespace penumbra
