#include "kernels/host/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(AtomicFile, WritesAndReplacesAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const auto path = folder / "image.exr";
  ASSERT_TRUE(write_file_atomically(path, bytes_of("first")));
  EXPECT_EQ(file_contents(path), "first");
  ASSERT_TRUE(write_file_atomically(path, bytes_of("second, longer")));
  EXPECT_EQ(file_contents(path), "second, longer");
  EXPECT_THAT(folder.names(), ElementsAre("image.exr"));
}

TEST(AtomicFile, APipeWaitsForItsReaderButNotForEver) {
  const TemporaryFolder folder;
  const std::string pipe = (folder / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const auto unread = write_file_atomically(pipe, bytes_of("lost"));
  ASSERT_FALSE(unread);
  EXPECT_THAT(unread.error().message, HasSubstr("no reader has opened this pipe"));
  // More than a pipe holds, and a reader that comes late and reads slowly.
  const std::string text(1 << 20, 'x');
  std::string read;
  std::jthread reader([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    read = file_contents(pipe);
  });
  EXPECT_TRUE(write_file_atomically(pipe, bytes_of(text)));
  reader.join();
  EXPECT_EQ(read, text);
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

/// Ends a process that has written a file aside and holds it, before that is put in place.
void kill_a_writer_of(const std::filesystem::path& path) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const auto staged = StagedFile::write(path, bytes_of("half"));
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
}

TEST(AtomicFile, WhatKilledWritersLeaveIsInNobodysWay) {
  const TemporaryFolder folder;
  const auto path = folder / "image.exr";
  kill_a_writer_of(path);
  EXPECT_THAT(folder.names(), ElementsAre(".image.exr.part"));
  EXPECT_TRUE(check_writable(path));
  EXPECT_THAT(folder.names(), IsEmpty());
  kill_a_writer_of(path);
  ASSERT_TRUE(write_file_atomically(path, bytes_of("whole")));
  EXPECT_EQ(file_contents(path), "whole");
  EXPECT_THAT(folder.names(), ElementsAre("image.exr"));

  kill_a_writer_of(path);
  write_text(folder / ".image.exr.1.part", "of another killed one, while the first still wrote");
  write_text(folder / ".other.part", "of another file");
  ASSERT_TRUE(write_file_atomically(path, bytes_of("again")));
  EXPECT_THAT(folder.names(), ElementsAre(".other.part", "image.exr"));
  remove_all_abandoned_parts(folder.path());
  EXPECT_THAT(folder.names(), ElementsAre("image.exr"));
}

TEST(AtomicFile, WritersOfOneFileAtATimeHaveTheirOwnParts) {
  const TemporaryFolder folder;
  const auto path = folder / "image.exr";
  auto first = StagedFile::write(path, bytes_of("first")),
       second = StagedFile::write(path, bytes_of("second"));
  ASSERT_TRUE(first && second);
  EXPECT_THAT(folder.names(), ElementsAre(".image.exr.1.part", ".image.exr.part"));
  remove_all_abandoned_parts(folder.path());
  EXPECT_TRUE(check_writable(path));
  EXPECT_THAT(folder.names(), ElementsAre(".image.exr.1.part", ".image.exr.part")) << "they are written";
  ASSERT_TRUE(second->rename_into_place());
  ASSERT_TRUE(first->rename_into_place());
  EXPECT_EQ(file_contents(path), "first");
  EXPECT_THAT(folder.names(), ElementsAre("image.exr"));

  constexpr int kWriters = 16;
  std::vector<std::jthread> writers;
  for (int i = 0; i < kWriters; ++i)
    writers.emplace_back([&] {
      for (int k = 0; k < 50; ++k) EXPECT_TRUE(write_file_atomically(path, bytes_of("whole")));
    });
  writers.clear();
  EXPECT_EQ(file_contents(path), "whole");
  EXPECT_THAT(folder.names(), ElementsAre("image.exr"));
}

// As Linux's protected_symlinks.
TEST(AtomicFile, LinksOfOthersInSharedFoldersAreNotFollowed) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can lay a link of another user";
  const TemporaryFolder folder;
  constexpr uid_t kSomebody = 12345;
  const auto shared = folder / "shared";
  std::filesystem::create_directory(shared);
  write_text(folder / "precious", "precious");
  std::filesystem::create_symlink("../precious", shared / "a.exr");
  ASSERT_EQ(lchown((shared / "a.exr").c_str(), kSomebody, kSomebody), 0);
  const auto written = [&] { return bool(write_file_atomically(shared / "a.exr", bytes_of("x"))); };
  chmod(shared.c_str(), 01777);
  EXPECT_FALSE(written());
  const auto checked = check_writable(shared / "a.exr");
  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.error().message, HasSubstr("a.exr is a link that somebody else has laid"));
  EXPECT_EQ(file_contents(folder / "precious"), "precious");
  chmod(shared.c_str(), 0777);  // where anybody could replace the file itself
  EXPECT_TRUE(written());
  chmod(shared.c_str(), 01777);
  ASSERT_EQ(chown(shared.c_str(), kSomebody, kSomebody), 0);  // the owner's own
  EXPECT_TRUE(written());
  ASSERT_EQ(lchown((shared / "a.exr").c_str(), 0, 0), 0);
  EXPECT_TRUE(written());
}

TEST(AtomicFile, SaysWhatIsWrongWithTheTarget) {
  const TemporaryFolder folder;
  const auto message = [](const std::filesystem::path& path) {
    const auto checked = check_writable(path);
    const auto written = write_file_atomically(path, bytes_of("x"));
    EXPECT_FALSE(written) << path;
    return checked ? "writable" : checked.error().message;
  };
  write_text(folder / "plain", "file");
  EXPECT_THAT(message(folder / "plain/a.exr"), HasSubstr("plain is not a folder"));
  std::filesystem::create_directory(folder / "taken.exr");
  EXPECT_THAT(message(folder / "taken.exr"), HasSubstr("it is a folder"));
  write_text(folder / "protected", "precious");
  std::filesystem::permissions(folder / "protected", std::filesystem::perms::owner_read);
  EXPECT_THAT(message(folder / "protected"), HasSubstr("it is write-protected"));
  std::filesystem::create_symlink("protected", folder / "link");
  EXPECT_THAT(message(folder / "link"), HasSubstr("it is write-protected"));
  std::filesystem::create_symlink("loop", folder / "loop");
  EXPECT_THAT(message(folder / "loop"), HasSubstr("symbolic links"));
  EXPECT_THAT(message(folder / "new/"), HasSubstr("it names a folder"));
  EXPECT_THAT(folder.names(), ElementsAre("link", "loop", "plain", "protected", "taken.exr"));
  EXPECT_EQ(file_contents(folder / "protected"), "precious");
}

TEST(AtomicFile, CheckingLeavesNoTrace) {
  const TemporaryFolder folder;
  EXPECT_TRUE(check_writable(folder / "image.exr"));
  EXPECT_THAT(folder.names(), IsEmpty());
  write_text(folder / "image.exr", "old");
  EXPECT_TRUE(check_writable(folder / "image.exr"));
  EXPECT_EQ(file_contents(folder / "image.exr"), "old");
}

TEST(AtomicFile, MakesFoldersOnlyWhenTold) {
  const TemporaryFolder folder;
  const auto path = folder / "new/newer/a.exr";
  EXPECT_TRUE(check_writable(path));
  EXPECT_THAT(folder.names(), IsEmpty());
  const auto written = write_file_atomically(path, bytes_of("x"));
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("newer does not exist"));
  ASSERT_TRUE(make_folders(path));
  ASSERT_TRUE(write_file_atomically(path, bytes_of("x")));
  EXPECT_EQ(file_contents(path), "x");
}

TEST(AtomicFile, FollowsLinksAndKeepsThemAndPermissions) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "real/deep");
  write_text(folder / "real/a.exr", "old");
  const auto owner = std::filesystem::perms::owner_read | std::filesystem::perms::owner_write;
  std::filesystem::permissions(folder / "real/a.exr", owner);
  std::filesystem::create_symlink("../a.exr", folder / "real/deep/link");
  std::filesystem::create_symlink("real/deep/link", folder / "b.exr");
  ASSERT_TRUE(write_file_atomically(folder / "b.exr", bytes_of("new")));
  EXPECT_EQ(file_contents(folder / "real/a.exr"), "new");
  EXPECT_EQ(std::filesystem::status(folder / "real/a.exr").permissions(), owner);
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "b.exr"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "real/deep/link"));
  std::filesystem::create_symlink("real/none.exr", folder / "c.exr");
  ASSERT_TRUE(write_file_atomically(folder / "c.exr", bytes_of("first")));
  EXPECT_EQ(file_contents(folder / "real/none.exr"), "first");
}

TEST(AtomicFile, WritesIntoDevicesPipesAndOpenFiles) {
  const TemporaryFolder folder;
  // By links of our own: if this code is broken and runs as root, it replaces only these links.
  std::filesystem::create_symlink("/dev/null", folder / "null");
  std::filesystem::create_symlink("/dev/full", folder / "full");
  std::filesystem::create_symlink("/proc/self/fd", folder / "descriptors");
  EXPECT_TRUE(write_file_atomically(folder / "null", bytes_of("x")));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "null"));
  const auto full = write_file_atomically(folder / "full", bytes_of("x"));
  ASSERT_FALSE(full);
  EXPECT_THAT(full.error().message, HasSubstr("No space left on device"));

  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_TRUE(check_writable(folder / "pipe")) << "and does not wait for its reader";
  std::string read;
  std::thread reader([&] { read = file_contents(folder / "pipe"); });
  EXPECT_TRUE(write_file_atomically(folder / "pipe", bytes_of("through")));
  reader.join();
  EXPECT_EQ(read, "through");
  EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe"));

  std::FILE* file = std::fopen((folder / "open").c_str(), "w");
  ASSERT_NE(file, nullptr);
  std::fputs("before ", file);
  std::fflush(file);
  EXPECT_TRUE(write_file_atomically(folder / "descriptors" / std::to_string(fileno(file)), bytes_of("it")));
  std::fputs(" after", file);
  std::fclose(file);
  EXPECT_EQ(file_contents(folder / "open"), "before it after");
}

}  // namespace
}  // namespace penumbra
