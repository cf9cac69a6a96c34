// Compiled kernels on disk: a stored binary is found again, and a damaged file is never used.
#include "worker/opencl_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
using Binary = std::vector<unsigned char>;

std::string key(const std::string& text) { return KernelCache::key_of(std::vector<std::string>{text}); }

Binary some_binary(std::size_t size, unsigned char first) {
  Binary binary(size);
  std::iota(binary.begin(), binary.end(), first);
  return binary;
}

TEST(KernelCache, FindsWhatWasKeptAndNothingElse) {
  const TemporaryFolder folder;
  const KernelCache cache(folder / "deep/er");
  EXPECT_FALSE(cache.find(key("a")).binary);
  for (const std::size_t size : {0u, 1u, 100000u}) {
    const Binary binary = some_binary(size, 7);
    ASSERT_TRUE(cache.keep(key("a"), binary));
    const auto found = cache.find(key("a"));
    ASSERT_TRUE(found.binary);
    EXPECT_EQ(*found.binary, binary);
    EXPECT_THAT(found.note, IsEmpty());
  }
  EXPECT_FALSE(cache.find(key("b")).binary);
  cache.remove(key("a"));
  EXPECT_FALSE(cache.find(key("a")).binary);
}

TEST(KernelCache, KeysTellAllPartsApart) {
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
    EXPECT_EQ(KernelCache::key_of(input), KernelCache::key_of(input));
    EXPECT_EQ(KernelCache::key_of(input).size(), 32u);
    keys.insert(KernelCache::key_of(input));
  }
  EXPECT_EQ(keys.size(), inputs.size());
}

TEST(KernelCache, EveryDamageIsNoticedAndRemoved) {
  const TemporaryFolder folder;
  const KernelCache cache(folder.path());
  const Binary binary = some_binary(300, 1);
  const fs::path file = cache.file_of(key("a"));
  ASSERT_TRUE(cache.keep(key("a"), binary));
  const std::string whole = file_contents(file);
  ASSERT_GT(whole.size(), binary.size());
  const auto expect_refused = [&](const std::string& contents, const std::string& what) {
    write_text(file, contents);
    const auto found = cache.find(key("a"));
    EXPECT_FALSE(found.binary) << what;
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
  ASSERT_TRUE(cache.keep(key("b"), binary));
  expect_refused(file_contents(cache.file_of(key("b"))), "foreign");
  // Whole again, it is found again.
  write_text(file, whole);
  EXPECT_EQ(cache.find(key("a")).binary, binary);
}

TEST(KernelCache, AFolderInTheWayIsNoKernel) {
  const TemporaryFolder folder;
  const KernelCache cache(folder.path());
  fs::create_directories(cache.file_of(key("a")) / "inside");
  EXPECT_FALSE(cache.find(key("a")).binary);
  EXPECT_FALSE(cache.keep(key("a"), some_binary(10, 1)));
  EXPECT_TRUE(fs::exists(cache.file_of(key("a")) / "inside")) << "not made by the cache";
  EXPECT_THAT(folder.names(), ElementsAre(cache.file_of(key("a")).filename().string()))
      << "nothing left over";
}

TEST(KernelCache, WhatCannotBeWrittenIsSaidAndNothingElse) {
  const TemporaryFolder folder;
  write_text(folder / "file", "in the way");
  for (const fs::path& impossible : {folder / "file", folder / "file/below", fs::path("/proc/penumbra")}) {
    const KernelCache cache(impossible);
    EXPECT_FALSE(cache.find(key("a")).binary);
    const auto kept = cache.keep(key("a"), some_binary(10, 1));
    ASSERT_FALSE(kept);
    EXPECT_THAT(kept.error().message, HasSubstr(impossible.string()));
  }
  EXPECT_THAT(folder.names(), ElementsAre("file"));
}

TEST(KernelCache, WithoutAFolderThereIsNone) {
  const KernelCache none{fs::path()};
  EXPECT_FALSE(none.enabled());
  EXPECT_TRUE(none.keep(key("a"), some_binary(10, 1)));
  EXPECT_FALSE(none.find(key("a")).binary);
}

TEST(KernelCache, KeepsTheFilesUsedLast) {
  const TemporaryFolder folder;
  constexpr int kMost = 4;
  const KernelCache cache(folder.path(), kMost);
  write_text(folder / "notes.txt", "not ours");
  write_text(folder / ".bashrc", "not ours either");
  const auto now = fs::file_time_type::clock::now();
  for (int i = 0; i < kMost; ++i) {
    ASSERT_TRUE(cache.keep(key(std::to_string(i)), some_binary(10, 1)));
    fs::last_write_time(cache.file_of(key(std::to_string(i))), now - std::chrono::hours(10 - i));
  }
  fs::last_write_time(folder / ".bashrc", now - std::chrono::hours(100));
  ASSERT_TRUE(cache.find(key("0")).binary);  // the oldest, but used now
  ASSERT_TRUE(cache.keep(key("new"), some_binary(10, 1)));
  for (const auto& [name, expected] :
       {std::pair{"0", true}, {"1", false}, {"2", true}, {"3", true}, {"new", true}})
    EXPECT_EQ(fs::exists(cache.file_of(key(name))), expected) << name;
  EXPECT_TRUE(fs::exists(folder / "notes.txt"));
  EXPECT_TRUE(fs::exists(folder / ".bashrc"));
}

TEST(KernelCache, RemovesWhatADeadProcessLeft) {
  const TemporaryFolder folder;
  const KernelCache cache(folder.path());
  const fs::path dead = folder / ".0123.99.0.clbin-aside", living = folder / ".0123.98.0.clbin-aside";
  write_text(dead, "half");
  write_text(living, "half");
  fs::last_write_time(dead, fs::file_time_type::clock::now() - std::chrono::hours(2));
  ASSERT_TRUE(cache.keep(key("a"), some_binary(10, 1)));
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(living));
}

TEST(KernelCache, ReadersSeeAWholeFileWhateverIsWritten) {
  const TemporaryFolder folder;
  const KernelCache cache(folder.path(), 2);
  constexpr int kWriters = 4, kTimes = 100;
  constexpr std::size_t kSize = 60000;
  std::atomic<int> running = kWriters, wrong = 0, found_some = 0;
  std::vector<std::thread> threads;
  for (int w = 0; w < kWriters; ++w)
    threads.emplace_back([&, w] {
      for (int i = 0; i < kTimes; ++i)
        if (!cache.keep(key("a"), some_binary(kSize - std::size_t(w), (unsigned char)(w)))) ++wrong;
      --running;
    });
  threads.emplace_back([&] {
    while (running > 0) {
      const auto found = cache.find(key("a"));
      if (!found.note.empty()) ++wrong;
      if (!found.binary) continue;
      ++found_some;
      const std::size_t writer = kSize - found.binary->size();
      if (writer >= kWriters || *found.binary != some_binary(kSize - writer, (unsigned char)(writer)))
        ++wrong;
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

TEST(KernelCache, IsWhereTheUserWantsIt) {
  struct Case {
    const char *own, *xdg, *home, *folder;
  };
  for (const Case& c : {Case{"/own", "/xdg", "/home/u", "/own"}, Case{"off", "/xdg", "/home/u", ""},
                        Case{nullptr, "/xdg", "/home/u", "/xdg/penumbra/kernels"},
                        Case{"", "", "/home/u", "/home/u/.cache/penumbra/kernels"},
                        Case{nullptr, "relative", "/home/u", "/home/u/.cache/penumbra/kernels"},
                        Case{nullptr, nullptr, nullptr, ""}}) {
    const Variable own("PENUMBRA_KERNEL_CACHE", c.own), xdg("XDG_CACHE_HOME", c.xdg), home("HOME", c.home);
    EXPECT_EQ(default_kernel_cache(), fs::path(c.folder));
  }
}

}  // namespace
}  // namespace penumbra
