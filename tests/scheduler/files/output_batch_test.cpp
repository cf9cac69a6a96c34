#include "scheduler/files/output_batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <future>
#include <map>
#include <new>
#include <set>
#include <thread>

#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

std::vector<std::uint8_t> bytes(std::string_view text) { return {text.begin(), text.end()}; }

/// The files of all folders in `folder`, by name.
std::map<std::string, std::string> rescued(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[entry.path().filename()] = file_contents(entry.path());
  return files;
}

class OutputBatchTest : public ::testing::Test {
 protected:
  void SetUp() override { setenv("TMPDIR", temporary_.path().c_str(), 1); }
  void TearDown() override { unsetenv("TMPDIR"); }
  TemporaryFolder folder_, temporary_;
};

TEST_F(OutputBatchTest, NothingIsThereBeforeTheEnd) {
  OutputBatch batch;
  batch.add(folder_ / "a.exr", bytes("image"));
  batch.add(folder_ / "a.json", bytes("report"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.exr"));
  ASSERT_TRUE(batch.finish());
  EXPECT_THAT(folder_.names(), ElementsAre("a.exr", "a.json"));
  EXPECT_EQ(file_contents(folder_ / "a.exr"), "image");
  EXPECT_THAT(temporary_.names(), IsEmpty());
}

TEST_F(OutputBatchTest, WhatIsMadeAsideIsThereAtTheEndWithTheRest) {
  std::promise<void> go;
  OutputBatch batch;
  batch.add_aside(folder_ / "a.exr", [wait = go.get_future().share()]() -> Expected<OutputBatch::Bytes> {
    wait.wait();
    return bytes("image");
  });
  batch.add_aside(folder_ / "a.png", []() -> Expected<OutputBatch::Bytes> { return bytes("picture"); });
  batch.add(folder_ / "a.json", bytes("report"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.json")) << "all or none";
  go.set_value();
  ASSERT_TRUE(batch.finish());
  EXPECT_THAT(folder_.names(), ElementsAre("a.exr", "a.json", "a.png"));
  EXPECT_EQ(file_contents(folder_ / "a.exr"), "image");
  EXPECT_EQ(file_contents(folder_ / "a.png"), "picture");
}

TEST_F(OutputBatchTest, ErrorsComeInTheOrderOfTheFilesAndWhatIsMadeIsKept) {
  write_text(folder_ / "a.png", "old");
  std::promise<void> go;
  OutputBatch batch;
  batch.add_aside(folder_ / "a.exr", [wait = go.get_future().share()]() -> Expected<OutputBatch::Bytes> {
    wait.wait();
    return fail("no image");
  });
  batch.add_aside(folder_ / "b.exr", []() -> Expected<OutputBatch::Bytes> { throw std::bad_alloc(); });
  batch.add_aside(folder_ / "gone/c.exr", []() -> Expected<OutputBatch::Bytes> { return bytes("third"); });
  batch.add_aside(folder_ / "a.png", []() -> Expected<OutputBatch::Bytes> { return bytes("picture"); });
  std::thread last([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    go.set_value();
  });
  const auto done = batch.finish();
  last.join();
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message,
              ContainsRegex("^no image\ncannot write .*b\\.exr: .*bad_alloc\ncannot write .*c\\.exr: "));
  EXPECT_THAT(done.error().message, Not(HasSubstr("lost")));
  EXPECT_EQ(rescued(temporary_.path()),
            (std::map<std::string, std::string>{{"a.png", "picture"}, {"c.exr", "third"}}));
  EXPECT_EQ(file_contents(folder_ / "a.png"), "old");
  EXPECT_THAT(folder_.names(), ElementsAre("a.png"));
}

TEST_F(OutputBatchTest, OneThatIsGivenUpLeavesNothing) {
  for (int i = 0; i < 20; ++i) {
    OutputBatch batch;
    batch.add_aside(folder_ / "a.exr", []() -> Expected<OutputBatch::Bytes> { return bytes("image"); });
  }
  EXPECT_THAT(folder_.names(), IsEmpty());
}

TEST_F(OutputBatchTest, WhatHasNoPlaceIsKeptElsewhereTogether) {
  std::filesystem::create_directory(folder_ / "gone");
  write_text(folder_ / "a.png", "old");
  OutputBatch batch;
  batch.add(folder_ / "gone/a.exr", bytes("image"));
  std::filesystem::remove_all(folder_ / "gone");
  batch.add(folder_ / "a.png", bytes("picture"));
  batch.add(folder_ / "gone/a.json", bytes("report"));
  const auto done = batch.finish();
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, AllOf(HasSubstr("gone does not exist"), HasSubstr("; written instead: "),
                                          HasSubstr(temporary_.path().string())));
  using Files = std::map<std::string, std::string>;
  EXPECT_EQ(rescued(temporary_.path()),
            (Files{{"a.exr", "image"}, {"a.json", "report"}, {"a.png", "picture"}}));
  EXPECT_EQ(file_contents(folder_ / "a.png"), "old") << "beside it would be the image of another run";
  EXPECT_THAT(folder_.names(), ElementsAre("a.png"));
}

TEST_F(OutputBatchTest, ADeviceThatIsFullCostsTheFilesNothing) {
  std::filesystem::create_symlink("/dev/full", folder_ / "a.exr");
  OutputBatch batch;
  batch.add(folder_ / "a.exr", bytes("image"));
  batch.add(folder_ / "a.json", bytes("report"));
  const auto done = batch.finish();
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, HasSubstr("No space left on device; written instead: "));
  EXPECT_EQ(rescued(temporary_.path()), (std::map<std::string, std::string>{{"a.exr", "image"}}));
  EXPECT_EQ(file_contents(folder_ / "a.json"), "report");
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "a.exr"));
}

TEST_F(OutputBatchTest, FilesOfTwoRunsAreNeverMixed) {
  constexpr int kRounds = 30, kRuns = 4;
  const std::array<const char*, 3> names = {"a.exr", "a.png", "a.json"};
  for (int round = 0; round < kRounds; ++round) {
    std::vector<OutputBatch> batches(kRuns);
    for (int run = 0; run < kRuns; ++run)
      for (const char* name : names)
        batches[std::size_t(run)].add(folder_ / name, bytes(std::to_string(run)));
    std::vector<std::thread> threads;
    std::atomic<bool> go = false;
    for (OutputBatch& batch : batches)
      threads.emplace_back([&] {
        while (!go) {
        }
        EXPECT_TRUE(batch.finish());
      });
    go = true;
    for (std::thread& thread : threads) thread.join();
    std::set<std::string> runs;
    for (const char* name : names) runs.insert(file_contents(folder_ / name));
    EXPECT_EQ(runs.size(), 1u) << "in round " << round;
  }
  EXPECT_THAT(folder_.names(), ElementsAre("a.exr", "a.json", "a.png"));
}

}  // namespace
}  // namespace penumbra
