#include "gl/script.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace penumbra {
namespace {

using testing::HasSubstr;

std::vector<ScriptCommand> commands_of(std::string_view text) {
  auto commands = parse_script(text, "test.script");
  EXPECT_TRUE(commands.has_value()) << commands.error().message;
  return commands ? *commands : std::vector<ScriptCommand>{};
}

/// The only command of a text.
template <typename T>
T one(std::string_view text) {
  const auto commands = commands_of(text);
  EXPECT_EQ(commands.size(), 1u) << text;
  const T* command = commands.size() == 1 ? std::get_if<T>(&commands[0]) : nullptr;
  EXPECT_NE(command, nullptr) << text;
  return command ? *command : T{};
}

std::string error_of(std::string_view text) {
  const auto commands = parse_script(text, "test.script");
  EXPECT_FALSE(commands.has_value()) << text;
  return commands ? "" : commands.error().message;
}

TEST(Script, AWholeOne) {
  const auto commands = commands_of(
      "# what a test does\n"
      "wait connected timeout 2.5\n"
      "\n"
      "key space 16   # presses\n"
      "\twait samples 16\r\n"
      "camera eye 1 2 3 at -1 .5 1e-3\n"
      "wait analytic\n"
      "screenshot \"my shots/one.png\"\n"
      "quit\n");
  ASSERT_EQ(commands.size(), 7u);
  const int lines[] = {2, 4, 5, 6, 7, 8, 9};
  for (std::size_t i = 0; i < commands.size(); ++i) EXPECT_EQ(line_of(commands[i]), lines[i]);
  const auto& connected = std::get<WaitCommand>(commands[0]);
  EXPECT_EQ(connected.what, WaitFor::kConnected);
  EXPECT_EQ(connected.timeout_seconds, 2.5);
  const auto& key = std::get<KeyCommand>(commands[1]);
  EXPECT_EQ(key.action, Action::kOneMoreSample);
  EXPECT_EQ(key.times, 16);
  const auto& samples = std::get<WaitCommand>(commands[2]);
  EXPECT_EQ(samples.what, WaitFor::kSamples);
  EXPECT_EQ(samples.samples, 16u);
  EXPECT_EQ(samples.timeout_seconds, std::nullopt);
  const auto& camera = std::get<CameraCommand>(commands[3]);
  EXPECT_EQ(camera.eye, glm::dvec3(1, 2, 3));
  EXPECT_EQ(camera.at, glm::dvec3(-1, 0.5, 1e-3));
  EXPECT_EQ(camera.up, std::nullopt);
  EXPECT_EQ(std::get<WaitCommand>(commands[4]).what, WaitFor::kAnalytic);
  EXPECT_EQ(std::get<ScreenshotCommand>(commands[5]).path, "my shots/one.png");
  EXPECT_TRUE(std::holds_alternative<QuitCommand>(commands[6]));
}

TEST(Script, EachCommand) {
  EXPECT_EQ(one<KeyCommand>("key F1").action, Action::kToggleHelp);
  EXPECT_EQ(one<KeyCommand>("key F1").times, 1);
  EXPECT_EQ(one<KeyCommand>("key [ 100000").times, 100000);
  EXPECT_EQ(one<CameraCommand>("camera up 0 0 2 at 0 0 0 eye 1 0 0").up, glm::dvec3(0, 0, 2));
  EXPECT_EQ(one<WaitCommand>("wait analytic").samples, 1u);
  EXPECT_EQ(one<WaitCommand>("wait analytic 8 timeout 3").samples, 8u);
  EXPECT_EQ(one<WaitCommand>("wait analytic timeout 3").timeout_seconds, 3.0);
  EXPECT_EQ(one<WaitCommand>("wait finished").what, WaitFor::kFinished);
  EXPECT_EQ(one<WaitCommand>("wait samples 4 timeout 1").timeout_seconds, 1.0);
  EXPECT_EQ(one<TimeoutCommand>("timeout 0.5").seconds, 0.5);
  EXPECT_EQ(one<SetAlphaCommand>("set alpha -0.5").alpha, -0.5);
  EXPECT_EQ(one<SetExposureCommand>("set exposure +3").exposure, 3.0);
  EXPECT_EQ(one<ResizeCommand>("resize 640 480").width, 640);
  EXPECT_EQ(one<ResizeCommand>("resize 640 480").height, 480);
  EXPECT_EQ(one<SaveCommand>("save out/a.EXR").format, SaveFormat::kExr);
  EXPECT_EQ(one<SaveCommand>("save a.b.png").format, SaveFormat::kPng);
  EXPECT_EQ(one<SaveCommand>("save \"a # b.png\"").path, "a # b.png");
  EXPECT_EQ(one<SaveCommand>("save a#1.png").path, "a#1.png");
}

TEST(Script, LogTakesTheRestOfTheLine) {
  EXPECT_EQ(one<LogCommand>("log here  we are  ").text, "here  we are");
  EXPECT_EQ(one<LogCommand>("log one # two").text, "one");
  EXPECT_EQ(one<LogCommand>("log \"one # two \"").text, "one # two ");
  EXPECT_EQ(one<LogCommand>("log say \"a b\" again").text, "say \"a b\" again");
  EXPECT_EQ(one<LogCommand>("log größer\r\n").text, "größer");
}

TEST(Script, NothingIsAScriptToo) {
  for (const std::string_view text :
       {"", "\n", "# only this", "  \r\n\t\n", "\xEF\xBB\xBF", "\xEF\xBB\xBF# x\n"})
    EXPECT_TRUE(commands_of(text).empty());
  EXPECT_EQ(one<QuitCommand>("\n\nquit").line, 3);  // no end of line at the end
  EXPECT_EQ(one<QuitCommand>("\xEF\xBB\xBFquit").line, 1);
}

TEST(Script, AnErrorShowsPlaceLineCaretAndTheNearestName) {
  EXPECT_EQ(error_of("quit\n  key spcae 3\n"),
            "test.script:2:7: error: unknown key 'spcae'; did you mean 'space'?\n"
            "    key spcae 3\n"
            "        ^");
  EXPECT_EQ(error_of("wait \"é\" x"),
            "test.script:1:6: error: unknown thing to wait for 'é'; there are: samples, analytic, finished, "
            "connected, denoised, layer, message, frame\n"
            "  wait \"é\" x\n"
            "       ^");
  EXPECT_EQ(error_of("resize 640"),
            "test.script:1:11: error: a height in pixels is missing\n"
            "  resize 640\n"
            "            ^");
}

TEST(Script, EveryErrorIsAtItsPlace) {
  struct Case {
    std::string_view text;
    int column;
    std::string_view message;
  };
  for (const Case& c : {
           Case{"screnshot a.png", 1, "unknown command 'screnshot'; did you mean 'screenshot'?"},
           Case{"xyzzy", 1,
                "there are: key, camera, wait, set, resize, screenshot, save, log, quit, layer, zoom, "
                "reference, point, compare, copy"},
           Case{"Quit", 1, "did you mean 'quit'?"},
           Case{"key", 4, "the name of a key is missing"},
           Case{"key w 0", 7, "0"},
           Case{"key w 1.5", 7, "1.5"},
           Case{"key w 100001", 7, "100001"},
           Case{"key w 1 2", 9, "nothing is expected after this 'key' command"},
           Case{"quit now", 6, "nothing is expected after this 'quit' command"},
           Case{"camera", 1, "a camera needs 'eye X Y Z'"},
           Case{"camera eye 0 0 0", 1, "a camera needs 'at X Y Z'"},
           Case{"camera at 0 0 0", 1, "a camera needs 'eye X Y Z'"},
           Case{"camera eye 0 0", 15, "the z coordinate of 'eye' is missing"},
           Case{"camera eye 0 y 0 at 1 1 1", 14, "'y' is not a number"},
           Case{"camera eye 0 nan 0 at 1 1 1", 14, "nan"},
           Case{"camera eye 0 1e16 0 at 1 1 1", 14, "'1e16' is not between"},
           Case{"camera eye 0 0 0 eye 1 1 1", 18, "a second 'eye'"},
           Case{"camera eye 0 0 0 at 1 1 1 up 0 1 0 up 0 1 0", 36, "a second 'up'"},
           Case{"camera eye 1 2 3 at 1 2 3", 18, "the camera looks at the point where it is"},
           Case{"camera eye 0 0 0 at 0 0 5 up 0 0 0", 27, "'up' has no direction"},
           Case{"camera eye 0 0 0 at 0 0 5 up 0 0 -3", 27, "'up' is along the view"},
           Case{"camera from 0 0 0", 8, "unknown part of a camera 'from'; there are: eye, at, up"},
           Case{"wait", 5,
                "samples, analytic, finished, connected, denoised, layer, message or frame is missing"},
           Case{"wait finishd", 6, "did you mean 'finished'?"},
           Case{"wait samples", 13, "a number of samples is missing"},
           Case{"wait \"samples\"", 15, "a number of samples is missing"},
           Case{"wait samples 0", 14, "0"},
           Case{"wait analytic 0", 15, "0"},
           Case{"wait samples -1", 14, "-1"},
           Case{"wait samples 99999999999", 14, "99999999999"},
           Case{"wait finished 3", 15, "unknown part of a wait '3'"},
           Case{"wait finished timeot 3", 15, "did you mean 'timeout'?"},
           Case{"wait finished timeout", 22, "seconds is missing"},
           Case{"timeout", 8, "seconds is missing"},
           Case{"timeout 0", 9, "a timeout is longer than 0 seconds"},
           Case{"wait finished timeout 0", 23, "a timeout is longer than 0 seconds"},
           Case{"wait finished timeout -1", 23, "'-1' is not between"},
           Case{"set", 4, "alpha or exposure is missing"},
           Case{"set alhpa 1", 5, "did you mean 'alpha'?"},
           Case{"set alpha", 10, "a value is missing"},
           Case{"set alpha inf", 11, "inf"},
           Case{"set exposure 101", 14, "'101' is not between"},
           Case{"resize 0 5", 8, "0"},
           Case{"resize 5 16385", 10, "16385"},
           Case{"screenshot", 11, "a file name is missing"},
           Case{"screenshot a.jpg", 12, "a screenshot is written as FILE.png"},
           Case{"screenshot .png", 12, "a screenshot is written as FILE.png"},
           Case{"screenshot \"\"", 12, "a screenshot is written as FILE.png"},
           Case{"save a.tiff", 6, "an image is saved as FILE.exr or FILE.png"},
           Case{"save a.png b.png", 12, "nothing is expected after this 'save' command"},
           Case{"save a b.png", 6, "an image is saved as FILE.exr or FILE.png"},
           Case{"log", 4, "a text is missing"},
           Case{"log # x", 4, "a text is missing"},
           Case{"log \"abc", 5, "this quote does not end on its line"},
           Case{"save \"a.png\"b", 13, "a blank belongs between"},
           Case{std::string_view("log a\0b", 7), 5, "a byte 0 in a text"},
       }) {
    const std::string error = error_of(c.text);
    EXPECT_TRUE(error.starts_with("test.script:1:" + std::to_string(c.column) + ": error: ")) << error;
    EXPECT_THAT(error, HasSubstr(std::string(c.message))) << c.text;
  }
}

TEST(Script, AllErrorsAreShownAndAFewOfVeryMany) {
  const std::string two = error_of("key spcae\nquit\nresize 1\n");
  EXPECT_THAT(two, HasSubstr("test.script:1:5"));
  EXPECT_THAT(two, HasSubstr("test.script:3:9"));
  std::string many;
  for (int i = 0; i < 5000; ++i) many += "nonsense\n";
  const std::string some = error_of(many);
  EXPECT_THAT(some, HasSubstr("perhaps more"));
  EXPECT_LT(some.size(), 5000u);
}

TEST(Script, AQuoteOfTheNextLineClosesNothing) {
  const std::string error = error_of("log \"a\nlog b\"\n");
  EXPECT_THAT(error, HasSubstr("test.script:1:5: error: this quote does not end on its line"));
  EXPECT_THAT(error, testing::Not(HasSubstr("test.script:2:")));  // b" is a word like others
}

TEST(Script, CommandsAboutThePicture) {
  EXPECT_EQ(one<LayerCommand>("layer CryptoObject00").name, "CryptoObject00");
  EXPECT_EQ(one<ReferenceCommand>("reference \"a b.exr\"").path, "a b.exr");
  EXPECT_EQ(one<CompareCommand>("compare relative").comparison, ShownComparison::kRelativeError);
  EXPECT_EQ(one<ZoomCommand>("zoom fit").factor, 0);
  EXPECT_EQ(one<ZoomCommand>("zoom 2.5").middle, std::nullopt);
  EXPECT_EQ(one<ZoomCommand>("zoom 4 30 20").middle, (std::array<double, 2>{30, 20}));
  EXPECT_EQ(one<PointCommand>("point 3 4").y, 4);
  EXPECT_EQ(one<CopyCommand>("copy tinyrender").format, CameraFormat::kTinyRender);
  EXPECT_EQ(one<WaitCommand>("wait message \"a.xml:1:\" timeout 3").text, "a.xml:1:");
  EXPECT_EQ(one<WaitCommand>("wait frame 0 timeout 3").what, WaitFor::kFrame);
  EXPECT_EQ(one<FrameCommand>("frame 12").frame, 12);
  EXPECT_TRUE(one<PlayCommand>("play").plays);
  EXPECT_FALSE(one<PlayCommand>("play off").plays);
  EXPECT_THAT(error_of("frame -1"), HasSubstr("test.script:1:7"));
  EXPECT_THAT(error_of("play backwards"), HasSubstr("on, off"));
  EXPECT_THAT(error_of("compare with\n"), testing::HasSubstr("none, reference, difference, relative"));
  EXPECT_THAT(error_of("zoom 1000\n"), testing::HasSubstr("between"));
  EXPECT_THAT(error_of("copy pbrt\n"), testing::HasSubstr("settings, mitsuba, tinyrender"));
  EXPECT_THAT(error_of("zoom 2 5\n"), testing::HasSubstr("a row of the image is missing"));
}

}  // namespace
}  // namespace penumbra
