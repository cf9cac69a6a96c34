#include "scheduler/render/frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;

TEST(Frames, AreNumbersRangesAndLists) {
  EXPECT_THAT(*frames_of("300"), ElementsAre("300"));
  EXPECT_THAT(*frames_of("3-5"), ElementsAre("3", "4", "5"));
  EXPECT_THAT(*frames_of("3..5"), ElementsAre("3", "4", "5"));
  EXPECT_THAT(*frames_of("1-10x4"), ElementsAre("1", "5", "9"));
  EXPECT_THAT(*frames_of("7,1-3,50-52x2"), ElementsAre("7", "1", "2", "3", "50", "52"));
  EXPECT_THAT(*frames_of("0-999999"), SizeIs(1'000'000));
  EXPECT_THAT(*frames_of("999999999-999999999"), ElementsAre("999999999"));
}

TEST(Frames, SayWhatIsWrong) {
  const std::pair<const char*, const char*> cases[] = {{"", "whole numbers from 0"},
                                                       {"5-3", "not '5-3'"},
                                                       {"1-10x0", "not '1-10x0'"},
                                                       {"1,,2", "not ''"},
                                                       {"-3", "not '-3'"},
                                                       {"1.5", "not '1.5'"},
                                                       {"a-b", "not 'a-b'"},
                                                       {"1-1000000000", "not '1-1000000000'"},
                                                       {"99999999999999999999", "not '9"},
                                                       {"1-5,4", "frame 4 is there twice"},
                                                       {"0-1000000", "more than 1000000 frames"}};
  for (const auto& [text, what] : cases) {
    const auto frames = frames_of(text);
    ASSERT_FALSE(frames) << text;
    EXPECT_THAT(frames.error().message, HasSubstr(what)) << text;
  }
}

TEST(Frames, AreToldInRanges) {
  const std::pair<std::vector<int>, const char*> cases[] = {{{}, ""},
                                                            {{300}, "300"},
                                                            {{13, 14}, "13-14"},
                                                            {{3, 1, 2, 2}, "1-3"},
                                                            {{1, 3}, "1,3"},
                                                            {{1, 3, 5}, "1-5x2"},
                                                            {{1, 3, 4, 5}, "1,3-5"},
                                                            {{1, 2, 3, 5, 7, 9, 20}, "1-3,5-9x2,20"}};
  for (const auto& [frames, text] : cases) EXPECT_EQ(frames_text(frames), text);
}

TEST(Frames, AreThoseOfTheirRanges) {
  std::mt19937 random(7);
  for (int i = 0; i < 200; ++i) {
    std::vector<int> frames;
    for (int frame = 0; frame < 40; ++frame)
      if (std::bernoulli_distribution(0.1 * (i % 10) + 0.05)(random)) frames.push_back(frame);
    if (frames.empty()) continue;
    std::vector<std::string> texts;
    for (const int frame : frames) texts.push_back(std::to_string(frame));
    EXPECT_EQ(*frames_of(frames_text(frames)), texts) << frames_text(frames);
  }
}

TEST(Frames, HaveATime) {
  SceneOptions options;
  options.frame = 36;
  EXPECT_EQ(frame_seconds(options), 1.5);
  EXPECT_EQ(frames_per_second(options), 24);
  options.fps = 30;
  options.frame_offset = -1.5;
  EXPECT_EQ(frame_seconds(options), 1.15);
}

TEST(Frames, OfAPreviewAreTheEndsThenMiddles) {
  EXPECT_THAT(preview_order(*frames_of("1-9")), ElementsAre("1", "9", "5", "3", "7", "2", "4", "6", "8"));
  EXPECT_THAT(preview_order({"4"}), ElementsAre("4"));
  EXPECT_THAT(preview_order({"4", "8"}), ElementsAre("4", "8"));
  for (const char* text : {"1-2", "1-3", "5-104", "1-1001x7"}) {
    std::vector<std::string> all = *frames_of(text), order = preview_order(all);
    std::ranges::sort(all);
    std::ranges::sort(order);
    EXPECT_EQ(order, all) << text;
  }
}

TEST(Frames, HaveAFieldInNames) {
  EXPECT_EQ(with_frame_field("out/a.####.exr"), "out/a.{frame:04}.exr");
  EXPECT_EQ(with_frame_field("a_######.png"), "a_{frame:06}.png");
  EXPECT_EQ(with_frame_field("out/a.exr"), "out/a.{frame:04}.exr");
  EXPECT_EQ(with_frame_field("a-{frame}.exr"), "a-{frame}.exr");
  EXPECT_EQ(with_frame_field("c#/a.exr"), "c#/a.{frame:04}.exr") << "the folder's own name";
  EXPECT_EQ(with_frame_field("c#/a.##.exr"), "c#/a.{frame:02}.exr");
  EXPECT_EQ(with_frame_field("c/####/a.exr"), "c/{frame:04}/a.exr");
  EXPECT_EQ(with_frame_field("####"), "{frame:04}");
  EXPECT_EQ(with_frame_field("{scene}.exr"), "{scene}.{frame:04}.exr");
  EXPECT_THAT(with_frame_field("{folder}/{seed}-x.exr"), StartsWith("{folder}/{seed}-x.{frame:04}"));
}

}  // namespace
}  // namespace penumbra
