// Tests what commands do with .blend files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "scheduler/image/image.h"
#include "tests/scheduler/blender/fake_blender.h"
#include "tests/support/fake_processes.h"
#include "tests/support/program.h"

namespace penumbra::blender_command_test {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class BlenderCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(folder_ / "tmp");
    setenv("TMPDIR", (folder_ / "tmp").c_str(), 1);
    setenv("PENUMBRA_BLENDER", (folder_ / "blender").c_str(), 1);
    write_fake_blender(folder_.path());
  }
  void TearDown() override {
    for (const char* name : {"TMPDIR", "PENUMBRA_BLENDER"}) unsetenv(name);
  }

  ProgramResult run(const std::vector<std::string>& arguments) {
    return run_penumbra(folder_.path(), arguments);
  }
  void write_frame(int frame, const std::string& name) {
    write_text(folder_ / name, scene_of_fake_blender(folder_.path(), frame));
  }
  template <typename Value = std::string>
  Value attribute(const std::string& name, const std::string& key) {
    const auto read = read_image(folder_ / name);
    EXPECT_TRUE(read) << read.error().message;
    const auto value = read ? read->attribute(key) : std::nullopt;
    EXPECT_TRUE(value) << name << " " << key;
    return value ? std::get<Value>(*value) : Value();
  }
  std::string film_hash(const std::string& name) { return attribute(name, "penumbra:film_hash"); }
  std::ptrdiff_t runs() const { return std::ranges::count(file_contents(folder_ / "runs"), '\n'); }
  bool is_tidy() const { return std::filesystem::is_empty(folder_ / "tmp"); }

  TemporaryFolder folder_;
};

TEST_F(BlenderCommand, RendersWhatIsExported) {
  write_frame(7, "still.xml");
  ASSERT_EQ(run({"render", "still.xml", "--spp", "4"}).exit_code, 0);
  const ProgramResult result = run({"render", "shot.blend", "--spp", "4", "--workers", "2"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("shot.blend: warning: object \"Lamp\": is left out"));
  EXPECT_EQ(film_hash("shot.exr"), film_hash("still.exr"));
  EXPECT_EQ(attribute("shot.exr", "penumbra:scene"), "shot.blend");
  EXPECT_TRUE(is_tidy());
}

TEST_F(BlenderCommand, AShotIsExportedOnce) {
  for (int frame = 1; frame <= 3; ++frame) write_frame(frame, fmt::format("f.{:04}.xml", frame));
  ASSERT_EQ(run({"render", "f.####.xml", "--frames", "1-3", "-o", "a.exr"}).exit_code, 0);
  const ProgramResult result =
      run({"render", "shot.blend", "--frames", "1-3", "--workers", "2", "-o", "b.exr"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, Not(HasSubstr("nothing moves")));
  EXPECT_EQ(runs(), 1);
  for (const char* frame : {"0001", "0002", "0003"})
    EXPECT_EQ(film_hash(fmt::format("a.{}.exr", frame)), film_hash(fmt::format("b.{}.exr", frame)));
  EXPECT_NE(film_hash("b.0001.exr"), film_hash("b.0002.exr"));
  EXPECT_EQ(attribute<double>("b.0002.exr", "penumbra:fps"), 25.0);
  EXPECT_EQ(attribute<int>("b.0002.exr", "penumbra:frame"), 2);
  // The same exports are the same renders.
  ASSERT_EQ(run({"render", "shot.blend", "--frames", "1-4", "-o", "b.exr"}).exit_code, 0);
  const auto jobs = nlohmann::json::parse(file_contents(folder_ / "jobs.json"))["jobs"];
  EXPECT_EQ(jobs[0]["state"], "unchanged");
  EXPECT_EQ(jobs[3]["state"], "done");
}

TEST_F(BlenderCommand, JobFilesMayNameThem) {
  write_text(folder_ / "jobs.toml",
             "[[render]]\nscene = \"shot.blend\"\nframes = \"2-3\"\nspp = [1, 4]\nblender = \"./blender\"\n");
  unsetenv("PENUMBRA_BLENDER");
  const ProgramResult result = run({"render", "jobs.toml"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(runs(), 1);
  EXPECT_NE(film_hash("shot-1.0002.exr"), film_hash("shot-4.0002.exr"));
}

TEST_F(BlenderCommand, OtherCommandsReadThem) {
  const ProgramResult info = run({"info", "shot.blend", "--frame", "3", "--json"});
  ASSERT_EQ(info.exit_code, 0) << info.err;
  const auto json = nlohmann::json::parse(info.out);
  EXPECT_EQ(json["scene"], "shot.blend");
  EXPECT_THAT(json["warnings"].dump(), AllOf(HasSubstr("Lamp"), Not(HasSubstr("/tmp/"))));
  write_frame(3, "three.xml");
  ASSERT_EQ(run({"convert", "shot.blend", "again.xml", "--frame", "3"}).exit_code, 0);
  ASSERT_EQ(run({"render", "three.xml", "-o", "a.exr"}).exit_code, 0);
  ASSERT_EQ(run({"render", "again.xml", "-o", "b.exr"}).exit_code, 0);
  EXPECT_EQ(film_hash("a.exr"), film_hash("b.exr"));
  ASSERT_EQ(run({"render", "shot.blend", "--estimate", "--spp", "1"}).exit_code, 0);
  EXPECT_TRUE(is_tidy());
}

TEST_F(BlenderCommand, WarningsOfAnExportAreErrorsWhereTheyCountAsSuch) {
  const ProgramResult result = run({"render", "shot.blend", "--strict"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("Lamp"), HasSubstr("warnings count as errors here")));
}

TEST_F(BlenderCommand, SaysWhatIsWrong) {
  ProgramResult result = run({"render", "shot.blend", "--camera", "Camra"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("shot.blend: no camera 'Camra'"));
  write_small_scene(folder_ / "s.xml");
  result = run({"render", "s.xml", "--scene", "Room"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--scene Room is of Blender's files; this one is Mitsuba XML"));
  EXPECT_EQ(run({"render", "s.xml", "--blender", "/none"}).exit_code, 0) << "where it is not needed";
  result = run({"render", "none.blend"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("none.blend"));
  result =
      run_shell(folder_.path(), "unset PENUMBRA_BLENDER PENUMBRA_BLENDER_PYTHON; PATH=" PENUMBRA_BINARY_DIR
                                " penumbra info shot.blend");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("no 'blender' is in PATH"));
  write_text(folder_ / "template",
             "<scene version=\"3.0.0\"><shape type=\"sphere\"><FRAME/></shape></scene>");
  result = run({"info", "shot.blend"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("shot.blend/frame.7.xml:1:"), Not(HasSubstr("/tmp/"))));
}

TEST_F(BlenderCommand, CtrlCEndsBlenderAndWhatItHasWritten) {
  write_fake_blender(folder_.path(), "exec sleep 60");
  for (const std::vector<std::string>& words : {std::vector<std::string>{"render", "shot.blend"},
                                                {"render", "shot.blend", "--frames", "1-3"},
                                                {"info", "shot.blend"}}) {
    std::filesystem::remove(folder_ / "runs");
    Program program(folder_.path(), words);
    ASSERT_TRUE(eventually([&] { return runs() == 1; }, 60s)) << words.front();
    const pid_t blender = std::stoi(file_contents(folder_ / "runs"));
    program.send(SIGINT);
    const ProgramResult result = program.wait();
    EXPECT_NE(result.exit_code, 0) << words.front();
    EXPECT_TRUE(
        eventually([&] { return process_state(blender) == 0 || process_state(blender) == 'Z'; }, 60s));
    EXPECT_TRUE(is_tidy()) << words.front();
  }
}

}  // namespace
}  // namespace penumbra::blender_command_test
