#include "scheduler/run/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

namespace penumbra {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

RenderProgress at(double seconds, std::uint64_t done, std::uint64_t total) {
  RenderProgress progress;
  progress.elapsed_seconds = seconds;
  progress.samples_done = done;
  progress.samples_total = total;
  progress.relative_error = NAN;
  progress.workers = 2;
  return progress;
}

/// What a printer writes to stderr while the clock of the progress runs.
std::string printed(ProgressStyle style, const std::vector<RenderProgress>& updates, int columns = 80) {
  testing::internal::CaptureStderr();
  ProgressPrinter printer(style, columns);
  for (const RenderProgress& progress : updates) printer.update(progress);
  printer.finish();
  return testing::internal::GetCapturedStderr();
}

TEST(ProgressPrinter, NoticesAreLinesThatStay) {
  RenderProgress progress = at(0, 0, 100);
  progress.notices = {"compiling kernels", "compiled"};
  EXPECT_EQ(printed(ProgressStyle::kLines, {progress, at(1, 0, 100)}), "compiling kernels\ncompiled\n");
  EXPECT_THAT(printed(ProgressStyle::kBar, {at(0, 0, 100), progress}),
              HasSubstr("\r\x1b[Kcompiling kernels\ncompiled\n\r\x1b[K["));
  EXPECT_EQ(printed(ProgressStyle::kNone, {progress}), "");
}

TEST(DurationText, RoundsUpToWholeSeconds) {
  EXPECT_EQ(clock_text(0), "0 s");
  EXPECT_EQ(clock_text(0.1), "1 s");
  EXPECT_EQ(clock_text(59.5), "1:00");
  EXPECT_EQ(clock_text(125), "2:05");
  EXPECT_EQ(clock_text(3723), "1:02:03");
  EXPECT_EQ(clock_text(-1), "0 s");
}

TEST(ProgressText, RateAndTimeLeftFollowFromTheClock) {
  // 30 of 120 million samples in 10 s: 3 a second, 30 s to go.
  EXPECT_EQ(progress_text(at(10, 30'000'000, 120'000'000)), " 25%  3.00 Msamples/s  30 s left  2 workers");
}

TEST(ProgressText, LeavesOutWhatIsNotKnown) {
  RenderProgress progress = at(0, 0, 100);
  progress.workers = 1;
  EXPECT_EQ(progress_text(progress), "  0%  1 worker");
  progress = at(4, 100, 100);
  progress.relative_error = 0.0123;
  EXPECT_EQ(progress_text(progress), "100%  0.00 Msamples/s  error 1.2%  2 workers");
}

TEST(ProgressText, IsNotDoneBeforeAllIsDone) {
  EXPECT_THAT(progress_text(at(1, 9999, 10000)), HasSubstr(" 99%"));
  EXPECT_THAT(progress_text(at(1, 0, 0)), HasSubstr("  0%"));
}

TEST(ProgressBar, FitsTheTerminal) {
  const RenderProgress half = at(1, 500, 1000);
  EXPECT_THAT(progress_bar(half, 200), HasSubstr("[##########..........]  50%"));
  for (int columns = 0; columns < 120; ++columns) {
    EXPECT_LE(progress_bar(half, columns).size(), std::size_t(columns)) << columns;
  }
  EXPECT_THAT(progress_bar(half, 20), Not(HasSubstr("[")));
}

TEST(ProgressPrinter, RedrawsOneLineOnATerminalAndClearsIt) {
  const std::string text = printed(ProgressStyle::kBar, {at(1, 10, 100), at(2, 20, 100)});
  EXPECT_EQ(text, "\r\x1b[K" + progress_bar(at(1, 10, 100), 79) + "\r\x1b[K" +
                      progress_bar(at(2, 20, 100), 79) + "\r\x1b[K");
  EXPECT_THAT(text, Not(HasSubstr("\n")));
}

TEST(ProgressPrinter, WritesALineEveryTenSecondsElsewhere) {
  std::vector<RenderProgress> updates;
  for (int tenth = 0; tenth <= 350; ++tenth) updates.push_back(at(tenth / 10.0, std::uint64_t(tenth), 1000));
  EXPECT_EQ(printed(ProgressStyle::kLines, updates), progress_text(at(10, 100, 1000)) + "\n" +
                                                         progress_text(at(20, 200, 1000)) + "\n" +
                                                         progress_text(at(30, 300, 1000)) + "\n");
}

TEST(ProgressPrinter, JsonIsALineForOtherPrograms) {
  RenderProgress progress = at(10, 30, 120);
  progress.notices = {"compiling \"kernels\"\n"};
  testing::internal::CaptureStdout();
  EXPECT_EQ(printed(ProgressStyle::kJson, {progress}), "");
  const std::string text = testing::internal::GetCapturedStdout();
  ASSERT_EQ(std::ranges::count(text, '\n'), 1);
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["samples_done"], 30);
  EXPECT_EQ(json["seconds_left"], 30.0) << "at 3 a second, 90 are left";
  EXPECT_TRUE(json["relative_error"].is_null()) << "unknown";
  EXPECT_EQ(json["notices"][0], progress.notices[0]);
  EXPECT_FALSE(json.contains("render"));
  EXPECT_EQ(nlohmann::json::parse(progress_json(progress, "2 of 3"))["render"], "2 of 3");
}

TEST(ProgressStyle, JsonIsNotSilencedByQuiet) {
  EXPECT_EQ(progress_style("json", false), ProgressStyle::kJson);
  EXPECT_EQ(progress_style("lines", false), ProgressStyle::kNone);
  EXPECT_EQ(progress_style("lines", true), ProgressStyle::kLines);
  EXPECT_EQ(progress_style("bar", true), ProgressStyle::kBar);
  EXPECT_EQ(progress_style("", true), progress_style());
}

TEST(ProgressPrinter, QuietIsQuiet) {
  EXPECT_EQ(printed(ProgressStyle::kNone, {at(1, 1, 2), at(20, 2, 2)}), "");
}

}  // namespace
}  // namespace penumbra
