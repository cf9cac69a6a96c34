// What `penumbra render` makes of the frames of a shot: the contact sheet and the video.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scheduler/image/contact_sheet.h"
#include "scheduler/image/image.h"
#include "scheduler/image/tone_map.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A light that fills the picture of 128 × 72 pixels; its radiance is 0.FRAME.
std::string light(const std::string& radiance) {
  return fmt::format(R"(<scene version="3.0.0">
  <integrator type="direct"/>
  <sensor type="perspective">
    <transform name="to_world"><lookat origin="0, 0, 2" target="0, 0, 0" up="0, 1, 0"/></transform>
    <sampler type="independent"><integer name="sample_count" value="1"/></sampler>
    <film type="hdrfilm"><integer name="width" value="128"/><integer name="height" value="72"/></film>
  </sensor>
  <shape type="rectangle">
    <transform name="to_world"><scale value="20"/></transform>
    <emitter type="area"><rgb name="radiance" value="{}"/></emitter>
  </shape>
</scene>)",
                     radiance);
}

class ShotPictures : public testing::Test {
 protected:
  void SetUp() override { write_text(folder_ / "a.xml", light("0.$frame")); }

  ProgramResult run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "render");
    return run_penumbra(folder_.path(), arguments);
  }
  /// The bytes in the middles of the sheet's cells, from the first.
  std::vector<int> cells(const std::string& name, std::size_t count) {
    const auto sheet = read_image(folder_ / name);
    EXPECT_TRUE(sheet.has_value()) << sheet.error().message;
    std::vector<int> bytes;
    const SheetLayout layout = sheet_layout(count, 128, 72);
    if (!sheet || sheet->data.width != layout.width() || sheet->data.height != layout.height()) return bytes;
    for (std::size_t cell = 0; cell < count; ++cell)
      bytes.push_back(int(std::lround(255 * sheet->at(layout.x(cell) + layout.cell_width / 2,
                                                      layout.y(cell) + layout.cell_height / 2, 1))));
    return bytes;
  }
  [[nodiscard]] bool exists(const std::string& name) const { return std::filesystem::exists(folder_ / name); }

  TemporaryFolder folder_;
};

// Of a picture with that radiance, and of an outlined cell.
int shown(float radiance) { return display_byte(radiance); }
const int kEmpty = shown(0.014f);

TEST_F(ShotPictures, TheContactSheetHasEveryFrame) {
  const ProgramResult set = run({"a.xml", "--frames", "2-5", "-o", "out/shot.####.exr"});
  ASSERT_EQ(set.exit_code, 0) << set.err;
  EXPECT_THAT(set.out, HasSubstr("wrote out/jobs.json, out/shot-contact.png"));
  EXPECT_EQ(cells("out/shot-contact.png", 4),
            (std::vector{shown(0.2f), shown(0.3f), shown(0.4f), shown(0.5f)}));
}

TEST_F(ShotPictures, FramesThatFailedAreEmptyEvenWhereThereIsAnOlderPicture) {
  for (const int frame : {2, 3, 4}) write_text(folder_ / fmt::format("s.000{}.xml", frame), light("0.6"));
  ASSERT_EQ(run({"s.####.xml", "--frames", "2-4", "-o", "out/"}).exit_code, 0);
  EXPECT_EQ(cells("out/s-contact.png", 3), (std::vector{shown(0.6f), shown(0.6f), shown(0.6f)}));
  write_text(folder_ / "s.0003.xml", "<scene");
  EXPECT_EQ(run({"s.####.xml", "--frames", "2-4", "-o", "out/"}).exit_code, 1);
  EXPECT_EQ(cells("out/s-contact.png", 3), (std::vector{shown(0.6f), kEmpty, shown(0.6f)}));
}

TEST_F(ShotPictures, FramesOfOtherSetsOfTheShotAreOnTheSheetToo) {
  ASSERT_EQ(run({"a.xml", "--frames", "5", "-o", "####.png"}).exit_code, 0);
  EXPECT_FALSE(exists("contact.png")) << "a sheet of one frame tells nothing";
  ASSERT_EQ(run({"a.xml", "--frames", "1", "-o", "####.png"}).exit_code, 0);
  EXPECT_EQ(cells("contact.png", 2), (std::vector{shown(0.1f), shown(0.5f)}));
}

TEST_F(ShotPictures, EachShotHasItsOwnSheet) {
  write_text(folder_ / "b.xml", light("0.0$frame"));
  ASSERT_EQ(run({"a.xml", "b.xml", "--frames", "1,2", "-o", "out/"}).exit_code, 0);
  EXPECT_EQ(cells("out/a-contact.png", 2), (std::vector{shown(0.1f), shown(0.2f)}));
  EXPECT_EQ(cells("out/b-contact.png", 2), (std::vector{shown(0.01f), shown(0.02f)}));
}

TEST_F(ShotPictures, NoSheetWhereNoneIsWanted) {
  ASSERT_EQ(run({"a.xml", "--frames", "1,2", "-o", "out/", "--no-contact-sheet"}).exit_code, 0);
  EXPECT_FALSE(exists("out/a-contact.png"));
}

TEST_F(ShotPictures, FilesAboutTheSetReplaceNoTexture) {
  ASSERT_EQ(run({"a.xml", "--frames", "3", "-o", "x.####.png"}).exit_code, 0);
  const std::string texture = file_contents(folder_ / "x.0003.png");
  std::string scene = light("1");
  const std::string color = "<rgb name=\"radiance\" value=\"1\"/>";
  ASSERT_TRUE(scene.contains(color));
  for (const char* option : {"the sheet", "--summary", "--table"}) {
    const std::string file = option == std::string("--table") ? "t.png" : "t-contact.png";
    write_text(folder_ / file, texture);
    scene = light("1");
    scene.replace(scene.find(color), color.size(),
                  "<texture type=\"bitmap\" name=\"radiance\"><string name=\"filename\" value=\"" + file +
                      "\"/></texture>");
    write_text(folder_ / "t.xml", scene);
    std::vector<std::string> arguments{"t.xml", "--frames", "1-2", "-o", "t.exr"};
    const bool is_sheet = option == std::string("the sheet");
    if (!is_sheet) arguments.insert(arguments.end(), {option, file});
    const ProgramResult set = run(arguments);
    EXPECT_EQ(set.exit_code, is_sheet ? 0 : 1) << set.err;
    EXPECT_THAT(set.err, HasSubstr(is_sheet ? "no contact sheet is written: t-contact.png is an input"
                                            : file + " is an input of a scene"));
    EXPECT_EQ(file_contents(folder_ / file), texture) << option;
  }
}

TEST_F(ShotPictures, ShotsWithNamesAlikeHaveTheirOwnSheets) {
  write_text(folder_ / "jobs.toml",
             "[[render]]\nscene = 'a.xml'\nframes = '1-2'\nout = 'col/a.####.exr'\n"
             "[[render]]\nscene = 'a.xml'\nframes = '3-4'\nout = 'col/a_####.exr'\n");
  const ProgramResult set = run({"jobs.toml"});
  ASSERT_EQ(set.exit_code, 0) << set.err;
  EXPECT_EQ(cells("col/a-contact.png", 2), (std::vector{shown(0.1f), shown(0.2f)}));
  EXPECT_EQ(cells("col/a_####-contact.png", 2), (std::vector{shown(0.3f), shown(0.4f)}));
}

// --- Videos

class ShotVideo : public ShotPictures {
 protected:
  void SetUp() override {
    ShotPictures::SetUp();
    if (run_shell(folder_.path(), "ffmpeg -version && ffprobe -version").exit_code != 0)
      GTEST_SKIP() << "the programs ffmpeg and ffprobe are not in PATH";
  }
  /// "WIDTH,HEIGHT,PIXELS,RATE,FRAMES"
  std::string probe(const std::string& file) {
    const auto result = run_shell(folder_.path(),
                                  "ffprobe -v error -count_frames -show_entries "
                                  "stream=width,height,pix_fmt,r_frame_rate,nb_read_frames -of csv=p=0 " +
                                      file);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  }
  /// The green of each frame's first pixel.
  std::vector<int> greens(const std::string& file) {
    EXPECT_EQ(
        run_shell(folder_.path(), "ffmpeg -v error -y -i " + file +
                                      " -vf format=rgb24,crop=1:1:8:8 -f rawvideo -pix_fmt rgb24 pixels.raw")
            .exit_code,
        0);
    const std::string bytes = file_contents(folder_ / "pixels.raw");
    std::vector<int> greens;
    for (std::size_t i = 1; i < bytes.size(); i += 3) greens.push_back(int(std::uint8_t(bytes[i])));
    return greens;
  }
};

// Of 8-bit signals through the video's Y'CbCr and its compression.
constexpr int kVideoError = 4;

TEST_F(ShotVideo, HasEveryFrameInOrderAtItsRate) {
  const ProgramResult set = run({"a.xml", "--frames", "1-6", "--order", "preview", "--fps", "12", "-o",
                                 "out/it's.####.exr", "--video", "out/a.mp4"});
  ASSERT_EQ(set.exit_code, 0) << set.err;
  EXPECT_THAT(set.err, HasSubstr("out/a.mp4: 6 frames at 12 fps"));
  EXPECT_EQ(probe("out/a.mp4"), "128,72,yuv420p,12/1,6\n");
  const auto seen = greens("out/a.mp4");
  ASSERT_EQ(seen.size(), 6u);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(seen[std::size_t(i)], shown(0.1f * float(i + 1)), kVideoError) << i;
}

TEST_F(ShotVideo, EverySecondFrameLastsTwiceAsLongAndOddSizesAreFilledUp) {
  const ProgramResult set =
      run({"a.xml", "--frames", "1-5x2", "-o", "out/", "--crop", "0,0,67,35", "--video", "out/a.mp4"});
  ASSERT_EQ(set.exit_code, 0) << set.err;
  EXPECT_EQ(probe("out/a.mp4"), "68,36,yuv420p,12/1,3\n");
}

TEST_F(ShotVideo, AFrameThatFailedHoldsThePictureBefore) {
  for (const int frame : {2, 4})
    write_text(folder_ / fmt::format("s.000{}.xml", frame), light(fmt::format("0.{}", frame)));
  const ProgramResult set = run({"s.####.xml", "--frames", "1-5", "-o", "out/", "--video", "a.mp4"});
  EXPECT_EQ(set.exit_code, 1);
  EXPECT_THAT(set.err,
              HasSubstr("a.mp4: 5 frames at 24 fps; 3 frames without a picture hold that before: 1, 3, 5"));
  const auto seen = greens("a.mp4");
  ASSERT_EQ(seen.size(), 5u);
  for (const auto& [i, radiance] : {std::pair{0, 0.2f}, {1, 0.2f}, {2, 0.2f}, {3, 0.4f}, {4, 0.4f}})
    EXPECT_NEAR(seen[std::size_t(i)], shown(radiance), kVideoError) << i;
}

TEST_F(ShotVideo, NamesMayHaveWhatFfmpegTakesForPatternsAndProtocols) {
  const ProgramResult set =
      run({"a.xml", "--frames", "1-2", "-o", "50%done %d/it's.exr", "--video", "take:2.mp4"});
  ASSERT_EQ(set.exit_code, 0) << set.err;
  EXPECT_EQ(probe("file:take:2.mp4"), "128,72,yuv420p,24/1,2\n");
}

TEST_F(ShotVideo, HasTheRateOfItsOwnFrames) {
  write_text(folder_ / "jobs.toml",
             "[[render]]\nscene = 'a.xml'\nframes = '1-2'\nfps = 12\nout = 's.####.exr'\npriority = 1\n"
             "[[render]]\nscene = 'a.xml'\ndefine.frame = 3\nout = 'still.exr'\n");
  const ProgramResult set = run({"jobs.toml", "--video", "a.mp4"});
  ASSERT_EQ(set.exit_code, 0) << set.err;
  EXPECT_EQ(probe("a.mp4"), "128,72,yuv420p,12/1,2\n");
}

TEST_F(ShotPictures, WithoutTheProgramAVideoIsRefusedBeforeTheRender) {
  const ProgramResult result =
      run_shell(folder_.path(),
                "p=$(command -v penumbra); PATH= \"$p\" render a.xml --frames 1-2 -o out/ --video a.mp4");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("ffmpeg"), HasSubstr("not in PATH")));
  EXPECT_FALSE(exists("out"));
}

TEST_F(ShotPictures, AVideoIsOfOneShot) {
  write_text(folder_ / "b.xml", light("0.0$frame"));
  for (const auto& [arguments, text] : {std::pair{std::vector<std::string>{"a.xml"}, "--frames"},
                                        {{"a.xml", "b.xml", "--frames", "1-2"}, "one shot, not of 2"}}) {
    std::vector<std::string> all = arguments;
    all.insert(all.end(), {"-o", "out/", "--video", "a.mp4"});
    const ProgramResult result = run(all);
    EXPECT_EQ(result.exit_code, 2) << text;
    EXPECT_THAT(result.err, HasSubstr(text));
  }
  EXPECT_THAT(run({"a.xml", "--frames", "1-2", "--video", "a.gif"}).err, HasSubstr("FILE.mp4"));
}

}  // namespace
}  // namespace penumbra
