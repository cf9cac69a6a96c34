// Tests `penumbra render --frames`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "scheduler/image/image.h"
#include "tests/scheduler/cli/moving_scene.h"
#include "tests/support/fake_processes.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class Shot : public ::testing::Test {
 protected:
  void SetUp() override { write_moving_scene(folder_ / "s.xml"); }

  ProgramResult run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "render");
    return run_penumbra(folder_.path(), arguments);
  }
  nlohmann::json jobs(const std::string& summary = "jobs.json") {
    return nlohmann::json::parse(file_contents(folder_ / summary))["jobs"];
  }
  std::vector<std::string> states() {
    std::vector<std::string> states;
    for (const auto& job : jobs()) states.push_back(job["state"]);
    return states;
  }
  template <typename Value = std::string>
  Value attribute(const std::string& name, const std::string& key) {
    const auto read = read_image(folder_ / name);
    EXPECT_TRUE(read) << read.error().message;
    const auto value = read ? read->attribute(key) : std::nullopt;
    EXPECT_TRUE(value) << key;
    return value ? std::get<Value>(*value) : Value();
  }
  std::string film_hash(const std::string& name) { return attribute(name, "penumbra:film_hash"); }

  TemporaryFolder folder_;
};

TEST_F(Shot, AFrameHasTheImageThatItHasAlone) {
  ASSERT_EQ(run({"s.xml", "--frames", "0-12x4", "--workers", "2"}).exit_code, 0);
  EXPECT_THAT(states(), ElementsAre("done", "done", "done", "done"));
  ASSERT_EQ(run({"s.xml", "--frame", "8", "-o", "alone.exr"}).exit_code, 0);
  EXPECT_EQ(film_hash("s.0008.exr"), film_hash("alone.exr"));
  EXPECT_EQ(file_contents(folder_ / "s.0008.exr"), file_contents(folder_ / "alone.exr"));
  EXPECT_NE(film_hash("s.0004.exr"), film_hash("s.0008.exr"));
  EXPECT_EQ(attribute<int>("s.0008.exr", "penumbra:frame"), 8);
  EXPECT_EQ(attribute<double>("s.0008.exr", "penumbra:fps"), 24.0);
  EXPECT_EQ(attribute<double>("s.0008.exr", "penumbra:time"), 8.0 / 24.0);
}

TEST_F(Shot, FramesThatAreThereAreKept) {
  ASSERT_EQ(run({"s.xml", "--frames", "1,3"}).exit_code, 0);
  ASSERT_EQ(run({"s.xml", "--frames", "1-4", "--order", "preview"}).exit_code, 0);
  std::map<std::string, std::string> ends;
  for (const auto& job : jobs()) ends[job["options"]["frame"]] = job["state"];
  const std::map<std::string, std::string> expected{
      {"1", "unchanged"}, {"2", "done"}, {"3", "unchanged"}, {"4", "done"}};
  EXPECT_EQ(ends, expected);
  EXPECT_EQ(jobs()[1]["options"]["frame"], "4") << "the last comes second";
  ASSERT_EQ(run({"s.xml", "--frames", "1-2", "--fps", "12"}).exit_code, 0);
  EXPECT_THAT(states(), ElementsAre("done", "done")) << "they are at other times";
}

TEST_F(Shot, TheClockSaysWhatMoves) {
  ASSERT_EQ(run({"s.xml", "--frames", "12", "-o", "a.exr"}).exit_code, 0);
  ASSERT_EQ(run({"s.xml", "--frames", "11", "--fps", "30", "--frame-offset", "4", "-o", "b.exr"}).exit_code,
            0);
  EXPECT_EQ(film_hash("a.0012.exr"), film_hash("b.0011.exr")) << "both are at half a second";
}

TEST_F(Shot, SeedsAreFixedOrByFrame) {
  write_small_scene(folder_ / "still.xml");
  const ProgramResult fixed = run({"still.xml", "--frames", "1-2", "--seed", "7", "-o", "f.exr"});
  ASSERT_EQ(fixed.exit_code, 0);
  EXPECT_THAT(fixed.err, HasSubstr("nothing moves in the scene"));
  EXPECT_EQ(film_hash("f.0001.exr"), film_hash("f.0002.exr"));
  ASSERT_EQ(run({"still.xml", "--frames", "1-2", "--seed", "7", "--seed-per-frame", "frame", "-o", "g.exr"})
                .exit_code,
            0);
  ASSERT_EQ(run({"still.xml", "--seed", "9", "-o", "nine.exr"}).exit_code, 0);
  EXPECT_EQ(film_hash("g.0002.exr"), film_hash("nine.exr"));
  EXPECT_NE(film_hash("g.0001.exr"), film_hash("g.0002.exr"));
}

TEST_F(Shot, TheSeedOfAFrameIsRecorded) {
  ASSERT_EQ(run({"s.xml", "--frames", "1-8x7", "--seed-per-frame", "frame"}).exit_code, 0);
  ASSERT_EQ(run({"s.xml", "--frame", "8", "--seed-per-frame", "frame", "-o", "alone.exr"}).exit_code, 0);
  EXPECT_EQ(file_contents(folder_ / "s.0008.exr"), file_contents(folder_ / "alone.exr"));
  EXPECT_EQ(attribute<int>("s.0008.exr", "penumbra:seed"), 8);
  write_small_scene(folder_ / "f.0001.xml");
  ASSERT_EQ(run({"f.####.xml", "--frames", "1", "--seed-per-frame", "frame", "-o", "g.exr"}).exit_code, 0);
  EXPECT_EQ(attribute<int>("g.0001.exr", "penumbra:seed"), 1) << "also where each frame is a file";
  EXPECT_EQ(attribute<int>("g.0001.exr", "penumbra:frame"), 1);
}

TEST_F(Shot, KeepsWhatBecameOfOtherFrames) {
  for (const char* name : {"f.0001.xml", "f.0003.xml"}) write_small_scene(folder_ / name);
  EXPECT_EQ(run({"f.####.xml", "--frames", "1-2"}).exit_code, 1);
  EXPECT_EQ(run({"f.####.xml", "--frames", "3"}).exit_code, 0);
  std::map<std::string, std::string> states;
  for (const auto& job : nlohmann::json::parse(file_contents(folder_ / "jobs.json"))["earlier"])
    states[job["options"]["frame"]] = job["state"];
  const std::map<std::string, std::string> expected{{"1", "done"}, {"2", "failed"}};
  EXPECT_EQ(states, expected);
}

TEST_F(Shot, AStateOfAnotherVersionIsNoTrouble) {
  ASSERT_EQ(run({"s.xml", "--frames", "1"}).exit_code, 0);
  std::string text = file_contents(folder_ / "jobs.json");
  text.replace(text.find("\"done\""), 6, "\"finished\"");
  write_text(folder_ / "jobs.json", text);
  EXPECT_EQ(run({"s.xml", "--frames", "1-2"}).exit_code, 0);
  EXPECT_THAT(states(), ElementsAre("done", "done"));
}

TEST_F(Shot, MayBeAFileForEachFrame) {
  for (const char* name : {"f.0001.xml", "f.0002.xml"}) write_small_scene(folder_ / name);
  ASSERT_EQ(run({"f.####.xml", "--frames", "1-2", "-o", "out/####.exr"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/0002.exr"));
}

TEST_F(Shot, WhatAFileCallsFrameAndTimeIsFilledIn) {
  std::string text = file_contents(folder_ / "s.xml");
  text.replace(text.find("value=\"4, 3, 2\""), 15, "value=\"$time, $frame, 0\"");
  write_text(folder_ / "v.xml", text);
  ASSERT_EQ(run({"v.xml", "--frames", "3-6x3", "--fps", "2"}).exit_code, 0);
  ASSERT_EQ(run({"v.xml", "-D", "frame=6", "-D", "time=3", "--frame", "6", "--fps", "2", "-o", "alone.exr"})
                .exit_code,
            0);
  EXPECT_EQ(film_hash("v.0006.exr"), film_hash("alone.exr"));
}

TEST_F(Shot, AFrameThatFailedGetsAnotherTry) {
  for (const char* name : {"f.0001.xml", "f.0003.xml", "f.0004.xml"}) write_small_scene(folder_ / name);
  Program shot(folder_.path(), {"render", "f.####.xml", "--frames", "2,1,3,4", "-o", "out/####.exr", "--spp",
                                "1000000", "--time-budget", "1s", "--checkpoint-interval", "0"});
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(folder_ / "out/0001.exr"); }, 60s));
  write_small_scene(folder_ / "f.0002.xml");
  EXPECT_EQ(shot.wait().exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/0002.exr"));
}

TEST_F(Shot, FramesThatFailTwiceAreNamed) {
  for (const char* name : {"f.0001.xml", "f.0003.xml"}) write_small_scene(folder_ / name);
  const ProgramResult shot = run({"f.####.xml", "--frames", "1-3", "-o", "out/####.exr"});
  EXPECT_EQ(shot.exit_code, 1);
  EXPECT_THAT(shot.err, AllOf(HasSubstr("f.0002.xml"), HasSubstr("1 of 3 renders failed")));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/0003.exr"));
}

TEST_F(Shot, TwoProcessesKeepEachOthersFrames) {
  Program first(folder_.path(), {"render", "s.xml", "--frames", "1-6", "-q"}),
      second(folder_.path(), {"render", "s.xml", "--frames", "7-12", "-q"});
  EXPECT_EQ(first.wait().exit_code, 0);
  EXPECT_EQ(second.wait().exit_code, 0);
  ASSERT_EQ(run({"s.xml", "--frames", "1-12"}).exit_code, 0);
  const auto all = states();
  EXPECT_EQ(std::ranges::count(all, "unchanged"), 12);
}

TEST_F(Shot, BadOptionsAreBadInput) {
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{"--frames", "9-1"}, "1-250x2"},
      {{"--frames", "1-3", "--frame", "2"}, "--frame"},
      {{"--order", "preview"}, "--frames"},
      {{"--frames", "1", "--order", "random"}, "preview"},
      {{"--frames", "1", "--fps", "0"}, "above 0"},
      {{"--frames", "1", "--clip", "walk"}, "glTF"},
      {{"--frames", "1-2", "-D", "frame=abc"}, "$frame is the number"},
      {{"--frames", "1", "--seed-per-frame", "often"}, "fixed"},
      {{"--frames", "1-2", "-o", "out/a-{frame:0x}.exr"}, "width"}};
  for (const auto& [arguments, what] : cases) {
    std::vector<std::string> all{"s.xml"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const ProgramResult result = run(all);
    EXPECT_NE(result.exit_code, 0) << what;
    EXPECT_THAT(result.err, HasSubstr(what)) << result.err;
  }
}

// Kills scheduler or workers at random moments, and starts the command again until it is done.
TEST_F(Shot, SurvivesAnyKill) {
  const std::vector<std::string> command{"render",
                                         "s.xml",
                                         "--frames",
                                         "1-12",
                                         "--spp",
                                         "256",
                                         "--pass",
                                         "16",
                                         "--tile",
                                         "8",
                                         "--workers",
                                         "2",
                                         "--checkpoint-interval",
                                         "0.02"};
  std::vector<std::string> undisturbed = command;
  undisturbed.insert(undisturbed.end(), {"-o", "whole/"});
  std::filesystem::create_directory(folder_ / "whole");
  ASSERT_EQ(run_penumbra(folder_.path(), undisturbed).exit_code, 0);
  std::mt19937 random(60);
  for (int kill = 0; kill < 6; ++kill) {
    Program program(folder_.path(), command);
    std::this_thread::sleep_for(std::chrono::milliseconds(100 + random() % 500));
    program.send(SIGKILL);
    program.wait();
  }
  ASSERT_EQ(run_penumbra(folder_.path(), command).exit_code, 0);
  for (int frame = 1; frame <= 12; ++frame) {
    const std::string name = fmt::format("s.{:04}.exr", frame);
    EXPECT_EQ(file_contents(folder_ / name), file_contents(folder_ / "whole" / name)) << frame;
  }
}

}  // namespace
}  // namespace penumbra
