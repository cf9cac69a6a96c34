// `--backend opencl` on the command line: devices are listed, kernels are compiled once, and the image is the
// same as the native one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "worker/device.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class OpenClCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    write_small_scene(folder_ / "s.xml");
    devices_ = run_penumbra(folder_.path(), {"worker", "--list-devices"}).out;
    setenv("PENUMBRA_KERNEL_CACHE", (folder_ / "kernels").c_str(), 1);
  }
  void TearDown() override { unsetenv("PENUMBRA_KERNEL_CACHE"); }

  [[nodiscard]] bool has_device() const { return !devices_.contains("no device"); }

  ProgramResult render(const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> arguments = {"render", "s.xml", "-o", name + ".exr"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_penumbra(folder_.path(), arguments);
  }
  nlohmann::json report(const std::string& name) {
    return nlohmann::json::parse(file_contents(folder_ / (name + ".json")));
  }

  TemporaryFolder folder_;
  std::string devices_;
};

TEST_F(OpenClCommand, TheWorkerListsWhatThereIs) {
  EXPECT_THAT(devices_, AllOf(StartsWith("native: " + isa_list(usable_isas())), HasSubstr("\nOpenCL:")));
  EXPECT_THAT(devices_, AnyOf(HasSubstr("no device"), HasSubstr("\n0  ")));
}

TEST_F(OpenClCommand, ADeviceThatIsNotThereIsFoundOutBeforeRendering) {
  for (const std::string backend : {"opencl", "auto"})
    for (const std::string option : {"--opencl-device", "--device"}) {
      const ProgramResult result =
          render("a", {"--spp", "2000000000", "--backend", backend, option, "no such device"});
      EXPECT_EQ(result.exit_code, 2);
      const std::string first = devices_.substr(devices_.find("OpenCL:") + 8);
      if (has_device()) {
        EXPECT_THAT(result.err,
                    AllOf(HasSubstr("'no such device'"), HasSubstr(first.substr(0, first.find('\n')))));
      }
    }
  EXPECT_THAT(folder_.names(), ElementsAre("s.xml"));
  EXPECT_EQ(run_penumbra(folder_.path(), {"worker", "--connect", "unix:x", "--device", "no such"}).exit_code,
            2);
}

TEST_F(OpenClCommand, KernelsAreCompiledOnceAndThatIsSaid) {
  if (!has_device()) GTEST_SKIP() << "no OpenCL device on this machine";
  const ProgramResult first = render("first", {"--backend", "opencl"});
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.err,
              AllOf(HasSubstr("compiling OpenCL kernels for "), HasSubstr("OpenCL kernels compiled in ")));
  nlohmann::json kernels = report("first")["workers"][0]["kernels"];
  EXPECT_EQ(kernels["cached"], false);
  EXPECT_GT(kernels["compile_seconds"], 0.0);

  const ProgramResult second = render("second", {"--backend", "opencl", "--device", "0"});
  EXPECT_EQ(second.exit_code, 0) << second.err;
  EXPECT_THAT(second.err, AllOf(HasSubstr("from the cache"), Not(HasSubstr("compiling"))));
  kernels = report("second")["workers"][0]["kernels"];
  EXPECT_EQ(kernels["cached"], true);
  EXPECT_EQ(kernels["compile_seconds"], 0.0);

  EXPECT_EQ(render("native", {}).exit_code, 0);
  EXPECT_TRUE(report("native")["workers"][0]["kernels"].is_null());
  EXPECT_EQ(report("native")["film_hash"], report("first")["film_hash"]);
  EXPECT_EQ(report("native")["film_hash"], report("second")["film_hash"]);
}

TEST_F(OpenClCommand, AutoRendersNativelyWhereTheCompilerBreaks) {
  if (!has_device() || !devices_.contains("Portable Computing Language: "))
    GTEST_SKIP() << "PoCL is the driver whose compiler is easily broken";
  // It needs a linker, and aborts where it finds none. Its own cache must not help.
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  std::filesystem::create_directory(folder_ / "pocl");
  setenv("POCL_CACHE_DIR", (folder_ / "pocl").c_str(), 1);
  const ProgramResult asked = render("asked", {"--backend", "opencl", "--device", "portable"});
  const ProgramResult chosen = render("chosen", {"--backend", "auto", "--device", "portable"});
  std::filesystem::copy_file(folder_ / "s.xml", folder_ / "other.xml");
  const ProgramResult set = run_penumbra(folder_.path(), {"render", "s.xml", "other.xml", "-o", "set/",
                                                          "--backend", "auto", "--device", "portable"});
  setenv("PATH", path.c_str(), 1);
  unsetenv("POCL_CACHE_DIR");
  EXPECT_EQ(set.exit_code, 0) << set.err;
  EXPECT_THAT(set.err, HasSubstr("other.xml: native code renders"));
  EXPECT_EQ(asked.exit_code, 1);
  EXPECT_THAT(asked.err, HasSubstr("Final linking of kernel"));
  EXPECT_EQ(chosen.exit_code, 0) << chosen.err;
  EXPECT_THAT(chosen.err, HasSubstr("warning: native code renders: no worker can do this job"));
  EXPECT_THAT(report("chosen")["problems"][0].get<std::string>(), StartsWith("native code renders"));
  EXPECT_THAT(report("chosen")["workers"][0]["device"].get<std::string>(), StartsWith("native"));
}

TEST_F(OpenClCommand, AutoIsRecordedAsSuchWhateverItTakes) {
  EXPECT_EQ(render("auto", {"--backend", "auto"}).exit_code, 0);
  EXPECT_EQ(render("native", {}).exit_code, 0);
  EXPECT_EQ(report("auto")["film_hash"], report("native")["film_hash"]);
  EXPECT_EQ(report("auto")["settings"]["backend"], "auto");
  EXPECT_THAT(report("auto")["repeat_command"].get<std::string>(), HasSubstr("--backend auto"));
  // Embree is native's, so auto is too.
  EXPECT_EQ(render("embree", {"--backend", "auto", "--intersector", "embree"}).exit_code, 0);
  EXPECT_THAT(report("embree")["workers"][0]["device"].get<std::string>(), HasSubstr("Embree"));
}

}  // namespace
}  // namespace penumbra
