// `penumbra view 'shot.####.exr'` as users run it: each frame is that of its file, also while they come.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <thread>

#include "kernels/host/atomic_file.h"
#include "scheduler/image/image.h"
#include "scheduler/image/image_files.h"
#include "tests/gl/gl_test_context.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

class ShotViewTest : public GlTest {
 protected:
  /// A picture of 40 × 30 pixels of one colour, with a layer of depths.
  void write_frame(int frame, float value, double fps = 0) {
    Image image;
    image.data = image.display = {0, 0, 40, 30};
    image.channels = {"R", "G", "B", "depth.Z"};
    for (std::size_t i = 0; i < image.pixels(); ++i)
      image.values.insert(image.values.end(), {value, 0.5f * value, 0.25f, 10 * value});
    if (fps > 0) image.metadata.emplace_back("penumbra:fps", fps);
    const auto bytes = encode_exr(image);
    ASSERT_TRUE(bytes.has_value());
    ASSERT_TRUE(write_output(folder_ / fmt::format("out/a.{:04}.exr", frame), *bytes).has_value());
  }
  ProgramResult view(std::vector<std::string> arguments, const std::string& script) {
    write_text(folder_ / "script.txt", script);
    arguments.insert(arguments.begin(), "view");
    arguments.insert(arguments.end(), {"--script", "script.txt", "--gl-debug", "--hidden"});
    return run_penumbra(folder_.path(), arguments);
  }
  /// Red, green and blue of the first pixel.
  [[nodiscard]] std::array<float, 3> pixel(const std::string& name) const {
    const auto image = read_image(folder_ / name);
    EXPECT_TRUE(image.has_value()) << name;
    if (!image) return {};
    return {image->at(0, 0, *image->channel("R")), image->at(0, 0, *image->channel("G")),
            image->at(0, 0, *image->channel("B"))};
  }

  TemporaryFolder folder_;
};

TEST_F(ShotViewTest, ShowsEachFrameAsItsFileHasIt) {
  for (const int frame : {1, 2, 4}) write_frame(frame, 0.1f * float(frame));
  for (const char* name : {"out/a.####.exr", "out/a.{frame:04}.exr", "out/a.%04d.exr"}) {
    const ProgramResult result = view({name},
                                      "wait frame 1\nsave 1.exr\n"
                                      "frame 4\nwait frame 4\nsave 4.exr\n"
                                      "key left\nkey left\nwait frame 2\nsave 2.exr\n"
                                      "key end\nwait frame 4\nkey home\nwait frame 1\n"
                                      "frame 3\nwait frame 2\nscreenshot 3.png\nquit\n");
    ASSERT_EQ(result.exit_code, 0) << name << result.err;
    for (const int frame : {1, 2, 4})
      EXPECT_EQ(pixel(fmt::format("{}.exr", frame)),
                (std::array{0.1f * float(frame), 0.5f * (0.1f * float(frame)), 0.25f}))
          << frame;
  }
}

TEST_F(ShotViewTest, LayersStayChosenFromFrameToFrame) {
  for (const int frame : {1, 2, 3}) write_frame(frame, 0.1f * float(frame));
  const ProgramResult result =
      view({"out/a.####.exr", "--frame", "2"},
           "wait frame 2\nlayer depth\nwait layer\nkey right\nwait frame 3\nwait layer\n"
           "save 3.png\nzoom 4 10 10\nset exposure 1\nlayer image\nsave 3.exr\n"
           "screenshot end.png\nquit\n");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(pixel("3.exr")[0], 0.1f * 3.0f);
}

TEST_F(ShotViewTest, PlaysAllFramesAndGoesOnAtTheStart) {
  for (const int frame : {1, 2, 3, 4}) write_frame(frame, 0.1f * float(frame));
  const ProgramResult result =
      view({"out/a.####.exr", "--fps", "4"},
           "wait frame 1\nplay\nwait frame 3 timeout 30\nwait frame 1 timeout 30\nplay off\nkey space\n"
           "wait frame 2 timeout 30\nkey space\nscreenshot end.png\nquit\n");
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST_F(ShotViewTest, FollowsAShotThatIsBeingRendered) {
  std::filesystem::create_directories(folder_ / "out");
  write_text(folder_ / "script.txt",
             "wait message \"no frame of\"\nlog begun\nwait frame 1\nsave 1.exr\nframe 2\nwait frame 2\n"
             "save 2.exr\nlog two\nframe 1\nwait message \"never\" timeout 5\n");
  Program window(folder_.path(), {"view", "out/a.####.exr", "--script", "script.txt", "--hidden"});
  const auto says = [&](const std::string& text) {
    for (int i = 0; i < 3000; ++i, std::this_thread::sleep_for(10ms))
      if (file_contents(folder_ / ".stdout").find(text) != std::string::npos) return true;
    return false;
  };
  ASSERT_TRUE(says("begun"));
  write_frame(1, 0.5f);
  std::this_thread::sleep_for(100ms);
  write_frame(2, 0.75f);
  EXPECT_TRUE(says("two"));
  window.wait();
  EXPECT_EQ(pixel("1.exr")[0], 0.5f);
  EXPECT_EQ(pixel("2.exr")[0], 0.75f);
}

TEST_F(ShotViewTest, WhatCannotWorkIsSaid) {
  const ProgramResult no_folder = view({"nowhere/a.####.exr"}, "quit\n");
  EXPECT_EQ(no_folder.exit_code, 2);
  EXPECT_THAT(no_folder.err, HasSubstr("there is no folder nowhere"));
  write_frame(1, 1);
  const ProgramResult options = view({"out/a.####.exr", "--spp", "4"}, "quit\n");
  EXPECT_EQ(options.exit_code, 2);
  EXPECT_THAT(options.err, HasSubstr("options of renders do not apply: --spp 4"));
  const ProgramResult no_shot = view({"out/a.0001.exr"}, "frame 1\n");
  EXPECT_EQ(no_shot.exit_code, 1);
  EXPECT_THAT(no_shot.err, HasSubstr("what is shown is no shot"));
  write_text(folder_ / "out/a.0002.exr", "no picture");
  const ProgramResult broken =
      view({"out/a.####.exr"}, "wait frame 1\nframe 2\nwait message a.0002.exr timeout 20\nquit\n");
  EXPECT_EQ(broken.exit_code, 0) << broken.err;
}

}  // namespace
}  // namespace penumbra
