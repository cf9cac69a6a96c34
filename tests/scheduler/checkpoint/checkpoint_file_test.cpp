// Tests checkpoints on disk: when they are written, that a complete old one remains until the new one is
// complete, and what happens where a file or folder cannot be written.
#include "scheduler/checkpoint/checkpoint_file.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/scheduler/checkpoint/merged_work.h"
#include "tests/support/film_layers.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr Seconds kOften = 1e-3;

template <typename Condition>
bool wait_until(const Condition& condition) {
  for (int i = 0; i < 3000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

class CheckpointFileTest : public testing::Test {
 protected:
  const TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_ / "a.exr.checkpoint";
  const Merge merge_ = half_merged();
};

TEST_F(CheckpointFileTest, KeepsTheNewestState) {
  CheckpointFile file(path_, small_identity(), kOften);
  const Merge nothing_merged = empty_merge();
  const auto nothing = file.read(empty_merge());
  ASSERT_TRUE(nothing);
  EXPECT_FALSE(*nothing);
  for (int i = 1; i <= 3; ++i) {
    ASSERT_TRUE(wait_until([&] { return file.is_due(merge_); }));
    file.keep(i < 3 ? nothing_merged : merge_, i);
  }
  ASSERT_TRUE(wait_until([&] { return file.is_due(merge_); })) << "the last one is written";
  const auto read = file.read(empty_merge());
  ASSERT_TRUE(read && *read);
  EXPECT_EQ((*read)->merge.film().hash(), merge_.film().hash());
  EXPECT_EQ((*read)->rendered, 3);
  file.remove();
  EXPECT_THAT(folder_.names(), IsEmpty());
  EXPECT_EQ(file.take_problem(), std::nullopt);
}

TEST_F(CheckpointFileTest, TheLastOneIsThereAtOnceAndNeverMeansNever) {
  CheckpointFile file(path_, small_identity(), 3600);
  EXPECT_FALSE(file.is_due(merge_));
  file.keep_last(merge_, 1);
  EXPECT_THAT(folder_.names(), ElementsAre("a.exr.checkpoint"));
  file.remove();
  CheckpointFile never(path_, small_identity(), 0);
  EXPECT_FALSE(never.is_due(merge_));
  never.keep_last(merge_, 1);
  EXPECT_THAT(folder_.names(), IsEmpty());
}

TEST_F(CheckpointFileTest, ItTakesAtMostItsShareOfTheTime) {
  // A film whose copy takes a while: 2 million pixels, 112 MB.
  const Merge large(FilmAccumulator(0, 0, 2000, 500, kFeatureLayers), TileGrid(0, 0, 2000, 500, 500, 1, 1));
  CheckpointFile file(path_, small_identity(), kOften);
  EXPECT_FALSE(file.is_due(large)) << "nothing is measured yet, but its size is known";
  const auto begin = std::chrono::steady_clock::now();
  file.keep(large, 1);
  const double copied = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(path_); }));
  std::this_thread::sleep_for(std::chrono::duration<double>(20 * copied));
  EXPECT_FALSE(file.is_due(large)) << "the copy alone takes its share of 100 times its time";
}

TEST_F(CheckpointFileTest, AFileThatIsNoneIsRefusedByName) {
  write_text(path_, "nonsense");
  CheckpointFile file(path_, small_identity(), kOften);
  const auto read = file.read(empty_merge());
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, HasSubstr("a.exr.checkpoint: it is no checkpoint"));
  EXPECT_EQ(file_contents(path_), "nonsense");
}

TEST_F(CheckpointFileTest, AFolderThatIsGoneIsToldOnceAndTheNextOneIsTried) {
  std::filesystem::create_directory(folder_ / "out");
  CheckpointFile file(folder_ / "out/a.checkpoint", small_identity(), kOften);
  std::filesystem::remove(folder_ / "out");
  file.keep_last(merge_, 1);
  EXPECT_THAT(file.take_problem().value_or("none"), HasSubstr("could not be resumed"));
  file.keep_last(merge_, 1);
  EXPECT_EQ(file.take_problem(), std::nullopt);
  std::filesystem::create_directory(folder_ / "out");
  file.keep_last(merge_, 1);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/a.checkpoint"));
}

TEST_F(CheckpointFileTest, AFullDiskLeavesTheOldOne) {
  {
    CheckpointFile file(path_, small_identity(), kOften);
    file.keep_last(merge_, 1);
  }
  const std::string old = file_contents(path_);
  // As in the tests of files: a limit on their size fails a write half way.
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{4096, 4096};
    setrlimit(RLIMIT_FSIZE, &limit);
    CheckpointFile file(path_, small_identity(), kOften);
    file.keep_last(half_merged(), 2);
    _exit(file.take_problem().value_or("").contains("File too large") ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_EQ(file_contents(path_), old);
  EXPECT_THAT(folder_.names(), ElementsAre("a.exr.checkpoint"));
}

TEST_F(CheckpointFileTest, WhatKilledProcessesWereWritingIsRemoved) {
  for (const char* name : {".a.exr.checkpoint.part", ".a.exr.checkpoint.1.part", ".b.exr.checkpoint.part"})
    write_text(folder_ / name, "x");
  const CheckpointFile file(path_, small_identity(), kOften);
  EXPECT_THAT(folder_.names(), ElementsAre(".b.exr.checkpoint.part"));
}

}  // namespace
}  // namespace penumbra
