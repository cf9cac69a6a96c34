// Pieces of scenes on disk: a stored piece is found again, and a damaged one never is, whichever other
// processes use the folder.
#include "worker/piece_cache.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "kernels/host/content_hash.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kPlenty = std::uint64_t(1) << 40;

Bytes some_bytes(std::size_t size, std::uint32_t seed) {
  std::mt19937 random(seed);
  Bytes bytes(size);
  std::ranges::generate(bytes, [&] { return std::uint8_t(random()); });
  return bytes;
}
AssetPiece piece_of(const Bytes& bytes) { return {content_hash(bytes), bytes.size()}; }

std::uint64_t bytes_in(const fs::path& folder) {
  std::uint64_t bytes = 0;
  for (const auto& entry : fs::directory_iterator(folder)) bytes += entry.file_size();
  return bytes;
}

TEST(PieceCache, FindsWhatWasKeptAlsoAfterAStart) {
  const TemporaryFolder folder;
  const Bytes bytes = some_bytes(100'000, 1);
  for (int start = 0; start < 2; ++start) {
    PieceCache cache(folder / "deep/er", kPlenty);
    EXPECT_EQ(cache.may_have(piece_of(bytes)), start > 0);
    EXPECT_EQ(cache.read(piece_of(bytes)).has_value(), start > 0);
    cache.keep(piece_of(bytes), bytes);
    EXPECT_EQ(cache.read(piece_of(bytes)), bytes);
    EXPECT_FALSE(cache.may_have(piece_of(some_bytes(10, 2))));
    EXPECT_THAT(cache.take_notes(), IsEmpty());
  }
}

TEST(PieceCache, WhatIsDamagedIsRemovedAndSaid) {
  const TemporaryFolder folder;
  PieceCache cache(folder.path(), kPlenty);
  const Bytes bytes = some_bytes(300, 1);
  const fs::path file = cache.file_of(piece_of(bytes));
  const std::string whole(bytes.begin(), bytes.end());
  std::vector<std::string> damaged = {"", whole + "x"};
  for (std::size_t i = 0; i < whole.size(); ++i) damaged.push_back(whole.substr(0, i));
  for (const std::string& content : damaged) {
    write_text(file, content);
    EXPECT_TRUE(cache.may_have(piece_of(bytes)));
    EXPECT_FALSE(cache.read(piece_of(bytes)));
    EXPECT_FALSE(fs::exists(file));
    EXPECT_THAT(cache.take_notes(), ElementsAre(AllOf(HasSubstr(file.string()), HasSubstr("damaged"))));
  }
  write_text(file, std::string(whole.size(), '\0'));
  EXPECT_TRUE(cache.read(piece_of(bytes))) << "whoever reads it verifies it";
  cache.reject(piece_of(bytes));
  EXPECT_FALSE(fs::exists(file));
  EXPECT_THAT(cache.take_notes(), ElementsAre(AllOf(HasSubstr(file.string()), HasSubstr("damaged"))));
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  EXPECT_FALSE(cache.read(piece_of(bytes))) << "a pipe is not waited for";
  cache.keep(piece_of(bytes), bytes);
  EXPECT_EQ(cache.read(piece_of(bytes)), bytes);
}

TEST(PieceCache, OfTooManyThoseUsedLastStay) {
  const TemporaryFolder folder;
  constexpr std::size_t kSize = 1000;
  std::vector<Bytes> pieces;
  for (std::uint32_t i = 0; i < 6; ++i) pieces.push_back(some_bytes(kSize, i));
  write_text(folder / "notes.txt", "not ours");
  const auto now = fs::file_time_type::clock::now();
  {
    PieceCache cache(folder.path(), 4 * kSize);
    for (int i = 0; i < 4; ++i) {
      cache.keep(piece_of(pieces[std::size_t(i)]), pieces[std::size_t(i)]);
      fs::last_write_time(cache.file_of(piece_of(pieces[std::size_t(i)])), now - std::chrono::hours(10 - i));
    }
    EXPECT_TRUE(cache.may_have(piece_of(pieces[0]))) << "which is a use";
    cache.expect(2 * kSize, 3 * kSize);
    for (const auto& [i, expected] : {std::pair{0u, true}, {1u, false}, {2u, false}, {3u, true}})
      EXPECT_EQ(fs::exists(cache.file_of(piece_of(pieces[i]))), expected) << i;
    for (int i = 4; i < 6; ++i) cache.keep(piece_of(pieces[std::size_t(i)]), pieces[std::size_t(i)]);
  }
  EXPECT_LE(bytes_in(folder.path()), 4 * kSize + fs::file_size(folder / "notes.txt"));
  {
    PieceCache cache(folder.path(), 2 * kSize);  // by another worker that was given less
    cache.keep(piece_of(pieces[1]), pieces[1]);
  }
  EXPECT_EQ(bytes_in(folder.path()), 2 * kSize + fs::file_size(folder / "notes.txt"));
}

TEST(PieceCache, ASceneAboveTheLimitIsNotKeptAndDrivesOutNothing) {
  const TemporaryFolder folder;
  PieceCache cache(folder.path(), 1000);
  const Bytes small = some_bytes(500, 1), large = some_bytes(800, 2);
  cache.expect(500, 500);
  cache.keep(piece_of(small), small);
  cache.expect(1600, 1600);
  cache.keep(piece_of(large), large);
  EXPECT_THAT(cache.take_notes(), ElementsAre(HasSubstr("1600 bytes is not kept")));
  EXPECT_FALSE(cache.may_have(piece_of(large)));
  EXPECT_TRUE(cache.may_have(piece_of(small)));
}

TEST(PieceCache, WithoutAFolderOrAPlaceThereIsNone) {
  const TemporaryFolder folder;
  write_text(folder / "file", "in the way");
  const Bytes bytes = some_bytes(10, 1);
  for (const fs::path& place :
       {fs::path(), folder / "file", folder / "file/below", fs::path("/proc/penumbra")}) {
    PieceCache cache(place, kPlenty);
    cache.expect(10, 10);
    cache.keep(piece_of(bytes), bytes);
    cache.keep(piece_of(bytes), bytes);
    EXPECT_FALSE(cache.may_have(piece_of(bytes)));
    EXPECT_FALSE(cache.read(piece_of(bytes)));
    EXPECT_EQ(cache.take_notes().size(), place.empty() ? 0u : 1u) << "said once: " << place;
  }
}

TEST(PieceCache, OnAFullDiskItGivesUpForThisSceneAndLeavesNothingHalf) {
  const TemporaryFolder folder;
  const Bytes small = some_bytes(20'000, 1), large = some_bytes(3'000'000, 2);
  // A disk of 1 MiB where that may be mounted, else a limit to the size of files.
  const bool is_mounted = mount("none", folder.path().c_str(), "tmpfs", 0, "size=1m") == 0;
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  if (!is_mounted) {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit low{.rlim_cur = 1 << 20, .rlim_max = before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &low), 0);
  }
  {
    PieceCache cache(folder.path(), kPlenty);
    cache.expect(small.size() + large.size(), small.size() + large.size());
    cache.keep(piece_of(small), small);
    cache.keep(piece_of(large), large);
    EXPECT_THAT(cache.take_notes(), ElementsAre(HasSubstr("scenes are not kept: cannot write")));
    EXPECT_EQ(cache.read(piece_of(small)), small);
    EXPECT_FALSE(cache.may_have(piece_of(large)));
    EXPECT_EQ(bytes_in(folder.path()), small.size()) << "nothing half written stays";
    const Bytes other = some_bytes(10, 3);
    cache.keep(piece_of(other), other);
    EXPECT_FALSE(cache.may_have(piece_of(other))) << "not tried again for this scene";
    cache.expect(10, 10);
    cache.keep(piece_of(other), other);
    EXPECT_TRUE(cache.may_have(piece_of(other))) << "but for the next one";
  }
  setrlimit(RLIMIT_FSIZE, &before);
  if (is_mounted) {
    EXPECT_EQ(umount(folder.path().c_str()), 0);
  }
  RecordProperty("disk", is_mounted ? "tmpfs" : "limited file size");
}

/// One of the workers of the next test: reads, keeps, and now and then damages what is there.
int work_with(const fs::path& folder, std::uint32_t seed, std::uint64_t limit) {
  std::mt19937 random(seed);
  int wrong = 0, found = 0;
  for (int scene = 0; scene < 60; ++scene) {
    PieceCache cache(folder, limit);
    std::vector<Bytes> pieces;
    for (int i = 0; i < 5; ++i) {
      const std::uint32_t which = random() % 12;  // of all processes the same dozen
      pieces.push_back(some_bytes(1000 + 100 * which, which));
    }
    cache.expect(3000, 10'000);
    for (const Bytes& bytes : pieces) {
      if (cache.may_have(piece_of(bytes))) {
        const auto read = cache.read(piece_of(bytes));
        found += read ? 1 : 0;
        wrong += read && *read != bytes ? 1 : 0;
      }
      if (random() % 16 == 0) write_text(cache.file_of(piece_of(bytes)), "damaged");
      if (random() % 2 == 0) cache.keep(piece_of(bytes), bytes);
    }
    for (const std::string& note : cache.take_notes()) wrong += note.find("not kept") != std::string::npos;
  }
  return wrong > 0 ? 1 : found == 0 ? 2 : 0;
}

TEST(PieceCache, SeveralProcessesUseOneFolder) {
  const TemporaryFolder folder;
  constexpr std::uint64_t kLimit = 15'000;
  std::vector<pid_t> children;
  for (std::uint32_t i = 0; i < 6; ++i) {
    const pid_t child = fork();
    if (child == 0) _exit(work_with(folder.path(), i, kLimit));
    children.push_back(child);
  }
  // One that is killed in the middle of it all leaves the others at peace.
  const pid_t killed = fork();
  if (killed == 0)
    for (;;) work_with(folder.path(), 99, kLimit);
  usleep(20'000);
  kill(killed, SIGKILL);
  waitpid(killed, nullptr, 0);
  for (const pid_t child : children) {
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0) << "1: took what is damaged or could not write; 2: found nothing";
  }
  {
    PieceCache last(folder.path(), kLimit);
    const Bytes bytes = some_bytes(10, 100);
    last.keep(piece_of(bytes), bytes);
  }
  std::uint64_t whole = 0;
  for (const auto& entry : fs::directory_iterator(folder.path()))
    if (entry.path().extension() == ".piece") whole += entry.file_size();
  EXPECT_LE(whole, kLimit);
}

TEST(PieceCache, TheUsersChoice) {
  unsetenv("PENUMBRA_CACHE");
  setenv("XDG_CACHE_HOME", "/c", 1);
  EXPECT_EQ(default_piece_cache("host:7000"), "/c/penumbra/scenes");
  EXPECT_EQ(default_piece_cache("unix:/run/socket"), "") << "the scheduler is on this machine";
  setenv("PENUMBRA_CACHE", "/elsewhere", 1);
  EXPECT_EQ(default_piece_cache("host:7000"), "/elsewhere");
  EXPECT_EQ(default_piece_cache("unix:/run/socket"), "/elsewhere");
  setenv("PENUMBRA_CACHE", "off", 1);
  EXPECT_EQ(default_piece_cache("host:7000"), "");
  unsetenv("PENUMBRA_CACHE");
  unsetenv("XDG_CACHE_HOME");
}

}  // namespace
}  // namespace penumbra
