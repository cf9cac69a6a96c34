#include "scheduler/outputs/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string_view>
#include <vector>

#include "tests/outputs/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::uint8_t> bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

TEST(AtomicFile, WritesAndReplacesAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const auto path = folder / "image.exr";
  ASSERT_TRUE(write_file_atomically(path, bytes_of("first")));
  EXPECT_EQ(file_contents(path), "first");
  ASSERT_TRUE(write_file_atomically(path, bytes_of("second, longer")));
  EXPECT_EQ(file_contents(path), "second, longer");
  EXPECT_THAT(folder.names(), ElementsAre("image.exr"));
}

TEST(AtomicFile, OldFileSurvivesAWriteThatFails) {
  const TemporaryFolder folder;
  const auto path = folder / "image.exr";
  ASSERT_TRUE(write_file_atomically(path, bytes_of("old")));
  // A file size limit fails a write half way, as a full disk does. It is set in a child since it cannot be
  // undone.
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{4096, 4096};
    setrlimit(RLIMIT_FSIZE, &limit);
    const auto written = write_file_atomically(path, std::vector<std::uint8_t>(100000, 'x'));
    _exit(!written && written.error().message.find("File too large") != std::string::npos ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0)
      << "the write did not fail, or without its reason";
  EXPECT_EQ(file_contents(path), "old");
  EXPECT_THAT(folder.names(), ElementsAre("image.exr"));
}

TEST(AtomicFile, SaysWhatIsWrongWithTheTarget) {
  const TemporaryFolder folder;
  const auto message = [](const std::filesystem::path& path) {
    const auto checked = check_writable(path);
    const auto written = write_file_atomically(path, bytes_of("x"));
    EXPECT_FALSE(written) << path;
    return checked ? "writable" : checked.error().message;
  };
  EXPECT_THAT(message(folder / "missing/a.exr"), HasSubstr("missing does not exist"));
  write_text(folder / "plain", "file");
  EXPECT_THAT(message(folder / "plain/a.exr"), HasSubstr("plain is not a folder"));
  std::filesystem::create_directory(folder / "taken.exr");
  EXPECT_THAT(message(folder / "taken.exr"), HasSubstr("it is a folder"));
  EXPECT_THAT(folder.names(), ElementsAre("plain", "taken.exr"));
}

TEST(AtomicFile, CheckingLeavesNoTrace) {
  const TemporaryFolder folder;
  EXPECT_TRUE(check_writable(folder / "image.exr"));
  EXPECT_THAT(folder.names(), IsEmpty());
  write_text(folder / "image.exr", "old");
  EXPECT_TRUE(check_writable(folder / "image.exr"));
  EXPECT_EQ(file_contents(folder / "image.exr"), "old");
}

}  // namespace
}  // namespace penumbra
