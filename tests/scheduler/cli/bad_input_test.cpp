// Scenes and output paths that `penumbra render` and `penumbra info` refuse before they render anything.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(BadInput, MissingSceneFile) {
  const TemporaryFolder folder;
  for (const char* command : {"render", "info"}) {
    const ProgramResult result = run_penumbra(folder.path(), {command, "nowhere.xml"});
    EXPECT_EQ(result.exit_code, 2) << command;
    EXPECT_THAT(result.err, HasSubstr("nowhere.xml"));
    EXPECT_THAT(result.out, IsEmpty());
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(BadInput, BadSceneIsShownWithItsPlace) {
  const TemporaryFolder folder;
  write_text(folder / "bad.xml",
             "<scene version=\"3.0.0\">\n"
             "  <shape type=\"sphear\"/>\n"
             "</scene>\n");
  const ProgramResult result = run_penumbra(folder.path(), {"render", "bad.xml"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("bad.xml:2:"), HasSubstr(": error: "), HasSubstr("sphere"), HasSubstr("^")));
  EXPECT_THAT(folder.names(), ElementsAre("bad.xml"));
}

TEST(BadInput, OverridesThatDoNotExist) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const ProgramResult setting =
      run_penumbra(folder.path(), {"render", "s.xml", "--set", "integrator.max_dept=3"});
  EXPECT_EQ(setting.exit_code, 2);
  EXPECT_THAT(setting.err, HasSubstr("max_depth"));
  const ProgramResult crop = run_penumbra(folder.path(), {"render", "s.xml", "--crop", "0,0,25,10"});
  EXPECT_EQ(crop.exit_code, 2);
  EXPECT_THAT(crop.err, AllOf(HasSubstr("--crop"), HasSubstr("24 x 20")));
  const ProgramResult pixel = run_penumbra(folder.path(), {"render", "s.xml", "--pixel", "3,20"});
  EXPECT_EQ(pixel.exit_code, 2);
  EXPECT_THAT(pixel.err, HasSubstr("--pixel"));
  EXPECT_THAT(folder.names(), ElementsAre("s.xml"));
}

TEST(BadInput, SettingsThatAreNoNumbersOrOutOfRange) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  for (const char* key : {"camera.fov", "camera.near_clip", "film.rfilter_radius", "film.rfilter_stddev",
                          "film.rfilter_b", "film.width", "sampler.sample_count", "sampler.seed",
                          "integrator.max_depth", "integrator.alpha", "integrator.emitter_samples"}) {
    for (const char* value : {"nan", "inf", "-inf", "-1e300", "1e300", "1e999", "", "1e60"}) {
      const ProgramResult result =
          run_penumbra(folder.path(), {"render", "s.xml", "--set", std::string(key) + "=" + value});
      EXPECT_EQ(result.exit_code, 2) << key << "=" << value << "\n" << result.err;
      EXPECT_THAT(result.err, HasSubstr(key)) << value;
    }
  }
  // Its square is no float above 0: every sample was NaN.
  const ProgramResult narrow = run_penumbra(
      folder.path(),
      {"render", "s.xml", "--set", "film.rfilter=gaussian", "--set", "film.rfilter_stddev=1e-300"});
  EXPECT_EQ(narrow.exit_code, 2);
  EXPECT_THAT(folder.names(), ElementsAre("s.xml"));
}

TEST(BadInput, DeviceAndInstructionSetAreOfTheBackendInUse) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"render", "s.xml", "--device", "0"}, "add --backend opencl"},
      {{"render", "s.xml", "--backend", "native", "--opencl-device", "x"}, "--device x"},
      {{"render", "s.xml", "--backend", "opencl", "--isa", "sse2"}, "--isa sse2"},
      {{"preview", "s.xml", "--device", "0"}, "add --backend opencl"},
      {{"report", "s.xml", "-o", "out", "--no-plots", "--opencl-device", "0"}, "add --backend opencl"},
      {{"report", "s.xml", "-o", "out", "--no-plots", "--backend", "opencl", "--isa", "sse2"}, "--isa sse2"},
      {{"worker", "--connect", "unix:x", "--backend", "native", "--device", "0"}, "add --backend opencl"},
      {{"stress", "--backend", "native", "--opencl-device", "0", "--case", "mis/"}, "add --backend opencl"},
  };
  for (const auto& [arguments, message] : cases) {
    const ProgramResult result = run_penumbra(folder.path(), arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments[0] << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
}

TEST(BadInput, EmptyNamesAndTimesThatAreNoNumbersAreBadUsage) {
  const TemporaryFolder folder;
  const std::vector<std::vector<std::string>> cases = {
      {"compare", "", ""},
      {"compare", "a.exr", ""},
      {"serve", "--listen", ""},
      {"render", "s.xml", "--listen", ""},
      {"worker", "--connect", "unix:x", "--retry-for", "nan"},
      {"worker", "--connect", "unix:x", "--retry-for", "-1"},
  };
  for (const auto& arguments : cases) {
    const ProgramResult result = run_penumbra(folder.path(), arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments[0] << " " << arguments[1];
    EXPECT_THAT(result.err, HasSubstr("error")) << arguments[0];
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(BadInput, AFilmLargerThanMemoryIsRefused) {
  if (double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE)) > 100e9)
    GTEST_SKIP() << "the largest film that scenes may have fits this machine";
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const ProgramResult result = run_penumbra(
      folder.path(), {"render", "s.xml", "--set", "film.width=46000", "--set", "film.height=46000"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("46000 x 46000 pixels need"), HasSubstr("in several crops")));
  EXPECT_THAT(folder.names(), ElementsAre("s.xml"));
}

TEST(BadInput, OutputsAreCheckedBeforeRendering) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  std::string scene = file_contents(folder / "s.xml");
  write_text(folder / "wall.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  scene.insert(scene.find("</scene>"),
               "<shape type=\"obj\"><string name=\"filename\" value=\"wall.obj\"/></shape>\n");
  write_text(folder / "s.xml", scene);
  std::filesystem::create_hard_link(folder / "s.xml", folder / "linked.json");
  write_text(folder / "protected.exr", "precious");
  std::filesystem::permissions(folder / "protected.exr", std::filesystem::perms::owner_read);
  const auto before = folder.names();
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"-o", "/proc/missing/a.exr"}, "cannot make the folder /proc/missing"},
      {{"-o", "s.xml/a.exr"}, "not a folder"},
      {{"-o", "a.jpg"}, "must end in .exr or .png"},
      {{"-o", "/proc/a.exr"}, "/proc/a.exr"},
      {{"-o", "a.exr", "--report", "/proc/r.json"}, "/proc/r.json"},
      {{"-o", "a.exr", "--report", "s.xml"}, "s.xml is an input of this command; it is not overwritten"},
      {{"-o", "a.exr", "--report", "./linked.json"}, "linked.json is an input of this command"},
      {{"-o", "a.exr", "--report", "wall.obj"}, "wall.obj is an input of this command"},
      {{"-o", "a.exr", "--report", "./a.exr"}, "two outputs in one file"},
      {{"-o", "new/a.exr", "--report", "new/../new/a.png"}, "two outputs in one file"},
      {{"-o", "protected.exr"}, "it is write-protected"},
      {{"-o", "new.exr", "--report", "."}, "it is a folder"},
  };
  for (const auto& [arguments, message] : cases) {
    // Two billion samples a pixel would take for ever: that it returns shows that it did not begin.
    std::vector<std::string> all = {"render", "s.xml", "--spp", "2000000000"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const ProgramResult result = run_penumbra(folder.path(), all);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
  EXPECT_EQ(folder.names(), before);
  EXPECT_EQ(file_contents(folder / "s.xml"), scene);
  EXPECT_EQ(file_contents(folder / "protected.exr"), "precious");
}

TEST(BadInput, EmbreeIsNotForOpenCl) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const ProgramResult result =
      run_penumbra(folder.path(), {"render", "s.xml", "--backend", "opencl", "--intersector", "embree"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--intersector portable"));
}

}  // namespace
}  // namespace penumbra
