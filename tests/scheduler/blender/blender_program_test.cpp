#include "scheduler/blender/blender_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/scheduler/blender/fake_blender.h"

namespace penumbra::blender_program_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// An environment with no Blender, and how it was before.
class BlenderProgramTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"PENUMBRA_BLENDER", "PENUMBRA_BLENDER_PYTHON"}) unsetenv(name);
    setenv("PATH", "/bin:/usr/bin", 1);
  }
  void TearDown() override { setenv("PATH", path_.c_str(), 1); }

  static std::string error_of(const std::string& named = "") {
    const auto found = find_blender(named);
    return found ? "found " + found->path.string() : found.error().message;
  }

  const std::string path_ = std::getenv("PATH");
  TemporaryFolder folder_;
};

TEST_F(BlenderProgramTest, IsWhatIsNamedElseInPath) {
  const auto fake = write_fake_blender(folder_.path());
  EXPECT_EQ(find_blender(fake.string())->path, fake);
  setenv("PENUMBRA_BLENDER_PYTHON", "/none", 1);
  setenv("PATH", (folder_.path().string() + ":/bin:/usr/bin").c_str(), 1);
  EXPECT_EQ(find_blender("")->path, fake) << "before PENUMBRA_BLENDER_PYTHON";
  EXPECT_EQ(find_blender("blender")->path, fake);
  setenv("PENUMBRA_BLENDER", "/none", 1);
  EXPECT_THAT(error_of(), AllOf(HasSubstr("PENUMBRA_BLENDER: "), HasSubstr("/none"))) << "before PATH";
  EXPECT_EQ(find_blender(fake.string())->path, fake) << "before PENUMBRA_BLENDER";
  EXPECT_FALSE(find_blender(fake.string())->is_python);
  EXPECT_THAT(find_blender(fake.string())->arguments("x.py", {"a"}),
              ElementsAre("--background", "--factory-startup", "--disable-autoexec", "--python-exit-code",
                          "1", "--python", "x.py", "--", "a"));
}

TEST_F(BlenderProgramTest, MayBeAPython) {
  const auto fake = write_fake_blender(folder_.path(), "", "Python 3.11.7");
  setenv("PENUMBRA_BLENDER_PYTHON", fake.c_str(), 1);
  ASSERT_TRUE(find_blender(""));
  EXPECT_TRUE(find_blender("")->is_python);
  EXPECT_THAT(find_blender("")->arguments("x.py", {"a"}), ElementsAre("x.py", "a"));
}

TEST_F(BlenderProgramTest, MayBeAPythonWhereTheOneInPathIsTooOld) {
  const TemporaryFolder other;
  write_fake_blender(folder_.path(), "", "Blender 3.4.1");
  setenv("PATH", (folder_.path().string() + ":/bin:/usr/bin").c_str(), 1);
  EXPECT_THAT(error_of(), AllOf(HasSubstr("PATH: "), HasSubstr("Blender 3.4.1, which is too old")));
  const auto python = write_fake_blender(other.path(), "", "Python 3.11.7");
  setenv("PENUMBRA_BLENDER_PYTHON", python.c_str(), 1);
  ASSERT_TRUE(find_blender(""));
  EXPECT_EQ(find_blender("")->path, python);
}

TEST_F(BlenderProgramTest, SaysWhatIsMissingOrWrong) {
  const TemporaryFolder empty;
  setenv("PATH", empty.path().c_str(), 1);  // the system may have a Blender
  EXPECT_THAT(error_of(),
              AllOf(HasSubstr("--blender, PENUMBRA_BLENDER and PENUMBRA_BLENDER_PYTHON name no program"),
                    HasSubstr("no 'blender' is in PATH"), HasSubstr("Blender 4.2 or newer would do")));
  setenv("PATH", "/bin:/usr/bin", 1);
  EXPECT_THAT(error_of("/none"), AllOf(HasSubstr("--blender: "), HasSubstr("/none")));
  EXPECT_THAT(error_of("no-such-blender"), HasSubstr("no-such-blender"));
  const std::pair<const char*, const char*> versions[] = {{"Blender 4.1.9", "too old"},
                                                          {"Blender 2.93", "too old"},
                                                          {"Blender x.y", "neither Blender nor a Python"},
                                                          {"Python 2.7", "neither Blender nor a Python"},
                                                          {"", "neither Blender nor a Python"}};
  for (const auto& [version, what] : versions)
    EXPECT_THAT(error_of(write_fake_blender(folder_.path(), "", version).string()), HasSubstr(what))
        << version;
  for (const char* version : {"Blender 4.2", "Blender 5.0.1", "Blender 10.0.0 Alpha"})
    EXPECT_TRUE(find_blender(write_fake_blender(folder_.path(), "", version).string())) << version;
}

TEST_F(BlenderProgramTest, RunsTheScriptOfThisBuild) {
  const auto script = find_export_script();
  ASSERT_TRUE(script) << script.error().message;
  EXPECT_EQ(file_contents(*script), file_contents(PENUMBRA_SOURCE_DIR "/scenes/blender/command_line.py"));
}

}  // namespace
}  // namespace penumbra::blender_program_test
