#include "scheduler/blender/blender_shots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "tests/scheduler/blender/fake_blender.h"
#include "tests/support/fake_processes.h"

namespace penumbra::blender_shots_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class BlenderShotsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(folder_ / "tmp");
    setenv("TMPDIR", (folder_ / "tmp").c_str(), 1);
  }
  void TearDown() override { unsetenv("TMPDIR"); }

  SceneOptions options(std::optional<int> frame = {}) const {
    SceneOptions options;
    options.file = (folder_ / "shot.blend").string();
    options.blender = (folder_ / "blender").string();
    options.frame = frame;
    return options;
  }
  std::string scene_of(std::optional<int> frame = {}) { return scene_of(options(frame)); }
  /// The exported file, or the error.
  std::string scene_of(const SceneOptions& options) {
    const auto scene = shots_->scene_of(options);
    return scene ? file_contents(scene->file) : scene.error().message;
  }
  void expect_frames(int first, int last) {
    std::vector<SceneOptions> renders;
    for (int frame = first; frame <= last; ++frame) renders.push_back(options(frame));
    std::vector<const SceneOptions*> all;
    for (const SceneOptions& each : renders) all.push_back(&each);
    shots_->expect(all);
  }
  std::string made_up(int frame) const { return scene_of_fake_blender(folder_.path(), frame); }
  std::ptrdiff_t runs() const { return std::ranges::count(file_contents(folder_ / "runs"), '\n'); }
  bool is_tidy() const { return std::filesystem::is_empty(folder_ / "tmp"); }

  TemporaryFolder folder_;
  std::unique_ptr<BlenderShots> shots_ = std::make_unique<BlenderShots>();
};

TEST_F(BlenderShotsTest, FramesThatAreExpectedComeFromOneRun) {
  write_fake_blender(folder_.path());
  expect_frames(1, 4);
  for (const int frame : {1, 3, 2, 4, 3}) EXPECT_EQ(scene_of(frame), made_up(frame));
  EXPECT_EQ(runs(), 1);
  const auto scene = shots_->scene_of(options(2));
  EXPECT_EQ(scene->fps, 25.0);
  EXPECT_THAT(scene->left_out, ElementsAre("object \"Lamp\": is left out"));
  EXPECT_EQ(scene_of(9), made_up(9)) << "others are exported alone";
  EXPECT_EQ(scene_of(), made_up(7)) << "the file's own";
  EXPECT_EQ(scene_of(), made_up(7));
  EXPECT_EQ(runs(), 3);
  EXPECT_FALSE(is_tidy());
  shots_.reset();
  EXPECT_TRUE(is_tidy());
}

TEST_F(BlenderShotsTest, AFrameIsThereBeforeTheNext) {
  write_fake_blender(folder_.path(), "while [ $frame = 2 ] && [ ! -e \"$here/go\" ]; do sleep 0.01; done");
  expect_frames(1, 2);
  EXPECT_EQ(scene_of(1), made_up(1));
  write_text(folder_ / "go", "");
  EXPECT_EQ(scene_of(2), made_up(2));
  EXPECT_EQ(runs(), 1);
}

TEST_F(BlenderShotsTest, WhereBlenderDiesAtAFrameTheOthersAreExported) {
  write_fake_blender(folder_.path(), "if [ $frame = 2 ]; then echo last words; kill -9 $$; fi");
  expect_frames(1, 4);
  EXPECT_EQ(scene_of(1), made_up(1));
  EXPECT_THAT(scene_of(2), AllOf(HasSubstr("killed by signal 9"), HasSubstr("noise\nlast words")));
  EXPECT_EQ(scene_of(3), made_up(3));
  EXPECT_EQ(scene_of(4), made_up(4));
  EXPECT_EQ(runs(), 2);
  EXPECT_THAT(scene_of(2), HasSubstr("killed by signal 9")) << "another try";
  EXPECT_EQ(runs(), 3);
}

TEST_F(BlenderShotsTest, WhereNothingIsExportedNobodyTriesAgain) {
  write_fake_blender(folder_.path(), "echo no memory; exit 11");
  expect_frames(1, 3);
  for (const int frame : {1, 2, 3})
    EXPECT_THAT(scene_of(frame), AllOf(HasSubstr("exit code 11"), HasSubstr("no memory")));
  EXPECT_EQ(runs(), 1);
  SceneOptions wrong = options(1);
  wrong.camera = "Camra";
  EXPECT_EQ(scene_of(wrong), "no camera 'Camra'") << "the script's error, without noise";
  write_fake_blender(folder_.path(), "exit 0");
  shots_ = std::make_unique<BlenderShots>();
  EXPECT_THAT(scene_of(1), HasSubstr("did not export the frame"));
}

TEST_F(BlenderShotsTest, NeitherBlenderNorItsFilesOutliveThem) {
  write_fake_blender(folder_.path(), "if [ $frame = 2 ]; then exec sleep 60; fi");
  expect_frames(1, 2);
  EXPECT_EQ(scene_of(1), made_up(1));
  const pid_t blender = std::stoi(file_contents(folder_ / "runs"));
  EXPECT_NE(process_state(blender), 0);
  shots_.reset();
  EXPECT_EQ(process_state(blender), 0);
  EXPECT_TRUE(is_tidy());
}

TEST_F(BlenderShotsTest, FramesAreWholeAndNotNegative) {
  write_fake_blender(folder_.path());
  SceneOptions moved = options(3);
  moved.frame_offset = 4;
  EXPECT_EQ(scene_of(moved), made_up(7));
  for (const double offset : {0.5, -4.0}) {
    moved.frame_offset = offset;
    EXPECT_THAT(scene_of(moved), HasSubstr("--frame-offset")) << offset;
  }
}

TEST_F(BlenderShotsTest, AFolderThatCannotBeMadeIsAnError) {
  write_fake_blender(folder_.path());
  setenv("TMPDIR", "/none", 1);
  EXPECT_THAT(scene_of(1), HasSubstr("cannot make a folder"));
}

}  // namespace
}  // namespace penumbra::blender_shots_test
