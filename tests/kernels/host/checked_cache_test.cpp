// Caches on disk: what was stored is found again, and a damaged file is never used.
#include "kernels/host/checked_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <set>
#include <thread>

#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

namespace fs = std::filesystem;
using Bytes = std::vector<unsigned char>;

/// A cache with room for so many files.
CheckedCache cache_in(const fs::path& folder, std::size_t most_files = 64) {
  return {folder, ".cached", {.most_files = most_files}};
}

std::string key(const std::string& text) { return CheckedCache::key_of(std::vector<std::string>{text}); }

Bytes some_bytes(std::size_t size, unsigned char first) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), first);
  return bytes;
}

TEST(CheckedCache, FindsWhatWasKeptAndNothingElse) {
  const TemporaryFolder folder;
  const CheckedCache cache = cache_in(folder / "deep/er");
  EXPECT_FALSE(cache.find(key("a")).bytes);
  for (const std::size_t size : {0u, 1u, 100000u}) {
    const Bytes bytes = some_bytes(size, 7);
    ASSERT_TRUE(cache.keep(key("a"), bytes));
    const auto found = cache.find(key("a"));
    ASSERT_TRUE(found.bytes);
    EXPECT_EQ(*found.bytes, bytes);
    EXPECT_THAT(found.note, IsEmpty());
  }
  EXPECT_FALSE(cache.find(key("b")).bytes);
  cache.remove(key("a"));
  EXPECT_FALSE(cache.find(key("a")).bytes);
}

TEST(CheckedCache, KeysTellAllPartsApart) {
  const std::vector<std::vector<std::string>> inputs = {{"source", "options", "device"},
                                                        {"source ", "options", "device"},
                                                        {"source", "options2", "device"},
                                                        {"source", "options", "driver"},
                                                        {"sourceo", "ptions", "device"},
                                                        {"source", "optionsdevice"},
                                                        {"options", "source", "device"},
                                                        {},
                                                        {""}};
  std::set<std::string> keys;
  for (const auto& input : inputs) {
    EXPECT_EQ(CheckedCache::key_of(input), CheckedCache::key_of(input));
    EXPECT_EQ(CheckedCache::key_of(input).size(), 64u);
    keys.insert(CheckedCache::key_of(input));
  }
  EXPECT_EQ(keys.size(), inputs.size());
}

TEST(CheckedCache, EveryDamageIsNoticedAndRemoved) {
  const TemporaryFolder folder;
  const CheckedCache cache = cache_in(folder.path());
  const Bytes bytes = some_bytes(300, 1);
  const fs::path file = cache.file_of(key("a"));
  ASSERT_TRUE(cache.keep(key("a"), bytes));
  const std::string whole = file_contents(file);
  ASSERT_GT(whole.size(), bytes.size());
  const auto expect_refused = [&](const std::string& contents, const std::string& what) {
    write_text(file, contents);
    const auto found = cache.find(key("a"));
    EXPECT_FALSE(found.bytes) << what;
    EXPECT_THAT(found.note, HasSubstr(file.string())) << what;
    EXPECT_FALSE(fs::exists(file)) << what;
  };
  // Any one byte changed, and cut at any place.
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string changed = whole;
    changed[i] = char(changed[i] ^ 0x20);
    expect_refused(changed, "byte " + std::to_string(i));
    expect_refused(whole.substr(0, i), "cut at " + std::to_string(i));
  }
  expect_refused(whole + "x", "longer");
  expect_refused(std::string(whole.size(), '\0'), "zeros, as after a crash of the machine");
  // Another entry under this name.
  ASSERT_TRUE(cache.keep(key("b"), bytes));
  expect_refused(file_contents(cache.file_of(key("b"))), "foreign");
  // Whole again, it is found again.
  write_text(file, whole);
  EXPECT_EQ(cache.find(key("a")).bytes, bytes);
}

TEST(CheckedCache, WhatOthersCanWriteIsNotUsed) {
  const TemporaryFolder folder;
  const fs::path shared = folder / "shared";
  const CheckedCache cache = cache_in(shared);
  const Bytes bytes = some_bytes(30, 1);
  ASSERT_TRUE(cache.keep(key("a"), bytes));
  EXPECT_EQ(fs::status(shared).permissions(), fs::perms::owner_all) << "whatever the umask";
  for (const fs::perms others : {fs::perms::group_write, fs::perms::others_write}) {
    fs::permissions(shared, others, fs::perm_options::add);
    const auto found = cache.find(key("a"));
    EXPECT_FALSE(found.bytes);
    EXPECT_THAT(found.note, HasSubstr(shared.string() + " is not used: others may write to it"));
    EXPECT_FALSE(cache.keep(key("b"), bytes));
    fs::permissions(shared, others, fs::perm_options::remove);
    EXPECT_TRUE(cache.find(key("a")).bytes);
    // The same of a file, which somebody may have left there while the folder was open to all.
    fs::permissions(cache.file_of(key("a")), others, fs::perm_options::add);
    EXPECT_THAT(cache.find(key("a")).note, HasSubstr("may be another user's and was removed"));
    ASSERT_TRUE(cache.keep(key("a"), bytes));
  }
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a folder to another user";
  ASSERT_EQ(chown(shared.c_str(), 1, 1), 0);
  EXPECT_FALSE(cache.find(key("a")).bytes);
  EXPECT_THAT(cache.find(key("a")).note, HasSubstr("another user owns it"));
  ASSERT_EQ(chown(shared.c_str(), 0, 0), 0);
  ASSERT_EQ(chown(cache.file_of(key("a")).c_str(), 1, 1), 0);
  EXPECT_FALSE(cache.find(key("a")).bytes);
}

TEST(CheckedCache, AFolderInTheWayIsNoFile) {
  const TemporaryFolder folder;
  const CheckedCache cache = cache_in(folder.path());
  fs::create_directories(cache.file_of(key("a")) / "inside");
  EXPECT_FALSE(cache.find(key("a")).bytes);
  EXPECT_FALSE(cache.keep(key("a"), some_bytes(10, 1)));
  EXPECT_TRUE(fs::exists(cache.file_of(key("a")) / "inside")) << "not made by the cache";
  EXPECT_THAT(folder.names(), ElementsAre(cache.file_of(key("a")).filename().string()))
      << "nothing left over";
}

TEST(CheckedCache, WhatCannotBeWrittenIsSaidAndNothingElse) {
  const TemporaryFolder folder;
  write_text(folder / "file", "in the way");
  for (const fs::path& impossible : {folder / "file", folder / "file/below", fs::path("/proc/penumbra")}) {
    const CheckedCache cache = cache_in(impossible);
    EXPECT_FALSE(cache.find(key("a")).bytes);
    const auto kept = cache.keep(key("a"), some_bytes(10, 1));
    ASSERT_FALSE(kept);
    EXPECT_THAT(kept.error().message, HasSubstr(impossible.string()));
  }
  EXPECT_THAT(folder.names(), ElementsAre("file"));
}

TEST(CheckedCache, WithoutAFolderThereIsNone) {
  const CheckedCache none = cache_in(fs::path());
  EXPECT_FALSE(none.enabled());
  EXPECT_TRUE(none.keep(key("a"), some_bytes(10, 1)));
  EXPECT_FALSE(none.find(key("a")).bytes);
}

TEST(CheckedCache, KeepsTheFilesUsedLast) {
  const TemporaryFolder folder;
  constexpr std::size_t kMost = 4;
  const CheckedCache cache = cache_in(folder.path(), kMost);
  write_text(folder / "notes.txt", "not ours");
  write_text(folder / ".bashrc", "not ours either");
  const auto now = fs::file_time_type::clock::now();
  for (int i = 0; i < int(kMost); ++i) {
    ASSERT_TRUE(cache.keep(key(std::to_string(i)), some_bytes(10, 1)));
    fs::last_write_time(cache.file_of(key(std::to_string(i))), now - std::chrono::hours(10 - i));
  }
  fs::last_write_time(folder / ".bashrc", now - std::chrono::hours(100));
  ASSERT_TRUE(cache.find(key("0")).bytes);  // the oldest, but used now
  ASSERT_TRUE(cache.keep(key("new"), some_bytes(10, 1)));
  for (const auto& [name, expected] :
       {std::pair{"0", true}, {"1", false}, {"2", true}, {"3", true}, {"new", true}})
    EXPECT_EQ(fs::exists(cache.file_of(key(name))), expected) << name;
  EXPECT_TRUE(fs::exists(folder / "notes.txt"));
  EXPECT_TRUE(fs::exists(folder / ".bashrc"));
}

TEST(CheckedCache, RemovesWhatADeadProcessLeft) {
  const TemporaryFolder folder;
  const CheckedCache cache = cache_in(folder.path());
  const fs::path dead = folder / ".0123.99.0.cached-aside", living = folder / ".0123.98.0.cached-aside";
  write_text(dead, "half");
  write_text(living, "half");
  fs::last_write_time(dead, fs::file_time_type::clock::now() - std::chrono::hours(2));
  ASSERT_TRUE(cache.keep(key("a"), some_bytes(10, 1)));
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(living));
}

TEST(CheckedCache, ReadersSeeAWholeFileWhateverIsWritten) {
  const TemporaryFolder folder;
  const CheckedCache cache = cache_in(folder.path(), 2);
  constexpr int kWriters = 4, kTimes = 100;
  constexpr std::size_t kSize = 60000;
  std::atomic<int> running = kWriters, wrong = 0, found_some = 0;
  std::vector<std::thread> threads;
  for (int w = 0; w < kWriters; ++w)
    threads.emplace_back([&, w] {
      for (int i = 0; i < kTimes; ++i)
        if (!cache.keep(key("a"), some_bytes(kSize - std::size_t(w), (unsigned char)(w)))) ++wrong;
      --running;
    });
  threads.emplace_back([&] {
    while (running > 0) {
      const auto found = cache.find(key("a"));
      if (!found.note.empty()) ++wrong;
      if (!found.bytes) continue;
      ++found_some;
      const std::size_t writer = kSize - found.bytes->size();
      if (writer >= kWriters || *found.bytes != some_bytes(kSize - writer, (unsigned char)(writer))) ++wrong;
    }
  });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(found_some, 0);
  EXPECT_THAT(folder.names(), ElementsAre(cache.file_of(key("a")).filename().string()));
}

/// Sets a variable of the environment, or removes it, until the end of the test.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    value ? setenv(name, value, 1) : unsetenv(name);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;
  ~Variable() { before_ ? setenv(name_, before_->c_str(), 1) : unsetenv(name_); }

 private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST(CheckedCache, IsWhereTheUserWantsIt) {
  struct Case {
    const char *own, *xdg, *home, *folder;
  };
  for (const Case& c : {Case{"/own", "/xdg", "/home/u", "/own"}, Case{"off", "/xdg", "/home/u", ""},
                        Case{nullptr, "/xdg", "/home/u", "/xdg/penumbra/some"},
                        Case{"", "", "/home/u", "/home/u/.cache/penumbra/some"},
                        Case{nullptr, "relative", "/home/u", "/home/u/.cache/penumbra/some"},
                        Case{nullptr, nullptr, nullptr, ""}}) {
    const Variable own("PENUMBRA_SOME_CACHE", c.own), xdg("XDG_CACHE_HOME", c.xdg), home("HOME", c.home);
    EXPECT_EQ(cache_folder("PENUMBRA_SOME_CACHE", "some"), fs::path(c.folder));
  }
}

}  // namespace
}  // namespace penumbra
