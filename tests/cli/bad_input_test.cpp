// Scenes and outputs that `penumbra render` and `penumbra info` refuse before any work is done.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.h"
#include "tests/cli/small_scene.h"
#include "tests/outputs/temporary_folder.h"

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

TEST(BadInput, OutputsAreCheckedBeforeRendering) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"-o", "missing/a.exr"}, "the folder missing does not exist"},
      {{"-o", "s.xml/a.exr"}, "not a folder"},
      {{"-o", "a.jpg"}, "must end in .exr or .png"},
      {{"-o", "/proc/a.exr"}, "/proc/a.exr"},
      {{"-o", "a.exr", "--report", "missing/r.json"}, "missing/r.json"},
  };
  for (const auto& [arguments, message] : cases) {
    // Two billion samples a pixel would take for ever: that it returns shows that it did not begin.
    std::vector<std::string> all = {"render", "s.xml", "--spp", "2000000000"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const ProgramResult result = run_penumbra(folder.path(), all);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
  EXPECT_THAT(folder.names(), ElementsAre("s.xml"));
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
