// Shots: which frames are there, what is kept in memory, and which frame is shown when.
#include "gl/shot_player.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <semaphore>
#include <set>

#include "gl/shot_listing.h"
#include "scheduler/sets/set_summary.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;
using Clock = ShotPlayer::Clock;

// --- The folder

class ShotFolderTest : public testing::Test {
 protected:
  void file(int frame, const std::string& text = "x") const {
    write_text(folder_.path() / fmt::format("a.{:04}.exr", frame), text);
  }
  void summary(std::initializer_list<std::pair<int, SetState>> frames) const {
    std::vector<SetEntry> entries;
    for (const auto& [frame, state] : frames) {
      SetEntry& entry = entries.emplace_back();
      entry.scene = "a.xml";
      entry.state = state;
      entry.files = {(folder_.path() / fmt::format("a.{:04}.exr", frame)).string()};
    }
    ASSERT_TRUE(write_set_summary(folder_.path() / "jobs.json", entries).has_value());
  }
  [[nodiscard]] FrameFiles files() const {
    return FrameFiles::of((folder_.path() / "a.####.exr").string()).value();
  }
  /// "1 2m 3f": the numbers, with a letter for those that are not there.
  [[nodiscard]] std::string listed() const {
    std::string text;
    for (const ListedFrame& frame : list_shot(files())) {
      const char* letters[] = {"", "w", "f", "m"};
      text += fmt::format("{}{}{}{}", text.empty() ? "" : " ", frame.number, letters[int(frame.state)],
                          frame.has_file && frame.state != FrameState::kThere ? "+" : "");
    }
    return text;
  }

  TemporaryFolder folder_;
};

TEST_F(ShotFolderTest, GapsBetweenFilesAreMissing) {
  EXPECT_EQ(listed(), "");
  file(7);
  EXPECT_EQ(listed(), "7");
  file(2);
  file(3);
  EXPECT_EQ(listed(), "2 3 4m 5m 6m 7");
}

TEST_F(ShotFolderTest, EverySecondFrameHasNoGaps) {
  for (const int frame : {1, 3, 5, 9}) file(frame);
  EXPECT_EQ(listed(), "1 3 5 7m 9");
}

TEST_F(ShotFolderTest, TheSummaryKnowsWhatIsToCome) {
  file(1);
  file(2);
  file(4);
  summary({{1, SetState::kDone},
           {2, SetState::kWaiting},
           {3, SetState::kFailed},
           {4, SetState::kUnchanged},
           {5, SetState::kWaiting},
           {6, SetState::kNotBegun},
           {7, SetState::kDone}});
  EXPECT_EQ(listed(), "1 2w+ 3f 4 5w 6w 7m") << "2 is of an earlier render, 7 was removed";
}

TEST_F(ShotFolderTest, OtherFilesAndBrokenSummariesAreIgnored) {
  file(1);
  write_text(folder_.path() / "jobs.json", "{");
  write_text(folder_.path() / "a.0009.png", "x");
  write_text(folder_.path() / "b.0009.exr", "x");
  EXPECT_EQ(listed(), "1");
}

// --- The memory

/// A picture of so many bytes of values.
FramePicture picture_of(std::size_t bytes, bool whole) {
  FramePicture picture;
  picture.picture.layers = {make_layer("image", LayerKind::kColor, std::vector<float>(bytes / 4), 3)};
  picture.is_whole = whole;
  return picture;
}

bool soon(const std::function<bool()>& is_true) {
  const auto end = Clock::now() + 20s;
  while (!is_true())
    if (std::this_thread::sleep_for(1ms); Clock::now() > end) return false;
  return true;
}

TEST(FrameCache, KeepsToItsBound) {
  constexpr std::size_t kPicture = 12'000, kMost = 50'000;
  std::atomic<int> reads = 0;
  FrameCache cache(
      [&](const FrameWish& wish) {
        ++reads;
        return picture_of(kPicture, wish.whole);
      },
      [] {}, kMost, 2);
  std::vector<FrameWish> wishes;
  for (int frame = 1; frame <= 100; ++frame) wishes.push_back({frame});
  cache.want(wishes);
  ASSERT_TRUE(soon([&] { return cache.there().size() >= 4; }));
  std::this_thread::sleep_for(50ms);
  EXPECT_THAT(cache.there(), ElementsAre(1, 2, 3, 4)) << "the most urgent, as many as fit";
  EXPECT_LE(cache.bytes(), kMost);
  EXPECT_LE(reads, 6) << "two threads may begin before the first tells how large a picture is";
  // What is no longer wished for makes room.
  cache.want({{50}, {51}, {4}});
  ASSERT_TRUE(soon([&] { return cache.has(50) && cache.has(51); }));
  EXPECT_TRUE(cache.has(4));
  EXPECT_LE(cache.bytes(), kMost);
}

TEST(FrameCache, TheMostUrgentIsKeptHoweverLarge) {
  FrameCache cache([](const FrameWish&) { return picture_of(120'000, true); }, [] {}, 1000, 1);
  for (const int frame : {1, 2}) {
    cache.want({{frame}, {frame + 10}});
    ASSERT_TRUE(soon([&] { return cache.has(frame); }));
    EXPECT_THAT(cache.there(), ElementsAre(frame));
  }
}

TEST(FrameCache, WholePicturesReplaceThoseWithOneLayer) {
  FrameCache cache([](const FrameWish& wish) { return picture_of(100, wish.whole); }, [] {}, 10'000, 1);
  cache.want({{1}});
  ASSERT_TRUE(soon([&] { return cache.has(1); }));
  EXPECT_FALSE(cache.get(1)->is_whole);
  cache.want({{1, true}});
  EXPECT_TRUE(soon([&] { return cache.get(1)->is_whole; }));
}

TEST(FrameCache, WhatChangesWhileItIsReadIsReadAgain) {
  std::binary_semaphore may_end(0);
  std::atomic<int> begun = 0;
  FrameCache cache(
      [&](const FrameWish&) {
        const int number = ++begun;
        if (number == 1) may_end.acquire();
        FramePicture picture = picture_of(100, true);
        picture.fps = number;
        return picture;
      },
      [] {}, 10'000, 1);
  cache.want({{1}});
  ASSERT_TRUE(soon([&] { return begun == 1; }));
  cache.forget(1);
  may_end.release();
  ASSERT_TRUE(soon([&] { return cache.has(1); }));
  EXPECT_EQ(cache.get(1)->fps, 2);
}

// --- Playing

class ShotPlayerTest : public ShotFolderTest {
 protected:
  /// A player whose pictures tell their file's text as integrator. Reading waits while `slow_` is set.
  std::unique_ptr<ShotPlayer> player(ShotOptions options = {}) {
    options.read = [this](const std::filesystem::path& path, const std::vector<std::string>&, bool whole) {
      while (slow_ && is_slow_(path)) std::this_thread::sleep_for(1ms);
      FramePicture picture = picture_of(100, whole);
      picture.integrator = file_contents(path);
      return picture;
    };
    return std::make_unique<ShotPlayer>(files(), options, [] {});
  }
  /// The frame that is shown once everything that is to be read has been.
  static int shown(ShotPlayer& player, Clock::time_point now) {
    for (int i = 0; i < 100; ++i) {
      player.update(now);
      std::this_thread::sleep_for(1ms);
    }
    return player.status().shown.value_or(-1);
  }

  std::atomic<bool> slow_ = false;
  std::function<bool(const std::filesystem::path&)> is_slow_ = [](const auto&) { return true; };
};

TEST_F(ShotPlayerTest, StepsOverAllFramesAndHoldsThePictureWhereOneIsMissing) {
  for (const int frame : {1, 2, 4}) file(frame);
  const auto shot = player();
  const auto now = Clock::now();
  EXPECT_EQ(shown(*shot, now), 1);
  shot->step(1);
  EXPECT_EQ(shown(*shot, now), 2);
  shot->step(1);
  EXPECT_EQ(shot->status().current, 3);
  EXPECT_EQ(shown(*shot, now), 2) << "3 is missing";
  shot->step(1);
  EXPECT_EQ(shown(*shot, now), 4);
  shot->step(1);
  EXPECT_EQ(shot->status().current, 4);
  shot->go_to_first();
  EXPECT_EQ(shown(*shot, now), 1);
  shot->go_to_last();
  EXPECT_EQ(shown(*shot, now), 4);
}

TEST_F(ShotPlayerTest, PlaysByTheClockAndBeginsAgainAtTheEnd) {
  for (const int frame : {10, 11, 12, 13}) file(frame);
  const auto shot = player({.fps = 10});
  const auto begin = Clock::now();
  EXPECT_EQ(shown(*shot, begin), 10);
  shot->play(true, begin);
  for (const auto& [seconds, frame] : {std::pair{0.05, 10}, {0.11, 11}, {0.25, 12}, {0.39, 13}, {0.41, 10}}) {
    const auto now = begin + std::chrono::microseconds(int(1e6 * seconds));
    EXPECT_EQ(shown(*shot, now), frame) << seconds;
  }
  EXPECT_NEAR(*shot->seconds_to_next(begin + 130ms), 0.07, 1e-6);
  EXPECT_EQ(shot->status().skipped, 0u);
  shot->play(false, begin + 420ms);
  EXPECT_EQ(shown(*shot, begin + 10s), 10);
  EXPECT_FALSE(shot->seconds_to_next(begin + 10s).has_value());
}

TEST_F(ShotPlayerTest, EverySecondFrameLastsTwiceAsLong) {
  for (const int frame : {1, 3, 5}) file(frame);
  const auto shot = player({.fps = 10});
  const auto begin = Clock::now();
  EXPECT_EQ(shown(*shot, begin), 1);
  shot->play(true, begin);
  EXPECT_EQ(shown(*shot, begin + 150ms), 1);
  EXPECT_EQ(shown(*shot, begin + 250ms), 3);
  EXPECT_EQ(shown(*shot, begin + 550ms), 5);
  EXPECT_EQ(shown(*shot, begin + 650ms), 1);
}

TEST_F(ShotPlayerTest, FramesForWhichThereIsNoTimeAreLeftOut) {
  for (int frame = 1; frame <= 10; ++frame) file(frame);
  is_slow_ = [](const std::filesystem::path& path) {  // 2, 3 and 4 take for ever
    return std::set<std::string>{"a.0002.exr", "a.0003.exr", "a.0004.exr"}.contains(path.filename().string());
  };
  slow_ = true;
  const auto shot = player({.fps = 10});
  const auto begin = Clock::now();
  EXPECT_EQ(shown(*shot, begin), 1);
  shot->play(true, begin);
  EXPECT_EQ(shown(*shot, begin + 250ms), 1);
  slow_ = false;
  EXPECT_EQ(shown(*shot, begin + 450ms), 5);
  EXPECT_EQ(shot->status().skipped, 3u);
  EXPECT_EQ(shown(*shot, begin + 550ms), 6);
  EXPECT_EQ(shot->status().skipped, 3u);
}

TEST_F(ShotPlayerTest, FollowsTheFolder) {
  const auto shot = player();
  EXPECT_EQ(shown(*shot, Clock::now()), -1);
  file(3);
  ASSERT_TRUE(soon([&] { return shot->update(Clock::now()), shot->status().shown == 3; }));
  file(4);
  file(6);
  ASSERT_TRUE(soon([&] { return shot->update(Clock::now()), shot->status().frames.size() == 4; }));
  EXPECT_FALSE(shot->status().frames[2].has_file);
  EXPECT_EQ(shot->status().shown, 3) << "it stays where it stands";
  // A file that changes is read again, in place.
  std::string read;
  file(3, "another text");
  EXPECT_TRUE(soon([&] {
    if (const auto picture = shot->update(Clock::now())) read = picture->integrator;
    return read == "another text";
  }));
}

TEST_F(ShotPlayerTest, BeginsAtTheFrameAndRateThatAreGiven) {
  for (const int frame : {1, 2, 3}) file(frame);
  const auto shot = player({.first = 2, .fps = 12.5});
  EXPECT_EQ(shown(*shot, Clock::now()), 2);
  EXPECT_EQ(shot->status().fps, 12.5);
}

TEST_F(ShotPlayerTest, AFrameThatCannotBeReadSaysWhy) {
  file(1, "no picture");
  EXPECT_NE(read_frame(folder_.path() / "a.0001.exr", {"image"}, false).error, "");
}

}  // namespace
}  // namespace penumbra
