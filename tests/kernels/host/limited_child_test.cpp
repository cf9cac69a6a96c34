// Work in a child process: its output, its errors, and its limits.
#include "kernels/host/limited_child.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <csignal>
#include <new>
#include <string>
#include <vector>

namespace penumbra::limited_child_test {
namespace {

using ::testing::HasSubstr;

constexpr ChildLimits kLimits{.memory_bytes = 256u << 20, .cpu_seconds = 20};

/// What the child writes, or its error.
std::string result_of(const std::function<Expected<void>(const ChildOutput&)>& work,
                      ChildLimits limits = kLimits) {
  std::string all;
  const auto done = run_limited(limits, work, [&](const ChildInput& input) -> Expected<void> {
    for (std::uint8_t byte = 0; input({&byte, 1});) all += char(byte);
    return {};
  });
  return done ? all : "error: " + done.error().message;
}

bool write_text(const ChildOutput& output, const std::string& text) {
  return output({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(LimitedChild, PassesOnAnyAmount) {
  const std::string much(2'000'000, 'x');  // more than a pipe holds
  EXPECT_EQ(result_of([](const ChildOutput&) -> Expected<void> { return {}; }), "");
  EXPECT_TRUE(result_of([&](const ChildOutput& output) -> Expected<void> {
                write_text(output, much);
                write_text(output, "y");
                return {};
              }) == much + "y");
}

TEST(LimitedChild, ErrorsAreThoseOfTheWork) {
  EXPECT_EQ(result_of([](const ChildOutput&) -> Expected<void> { return fail("no grid"); }),
            "error: no grid");
  EXPECT_EQ(result_of([](const ChildOutput&) -> Expected<void> { throw std::runtime_error("odd"); }),
            "error: odd");
  EXPECT_EQ(
      result_of([](const ChildOutput&) -> Expected<void> { return fail(std::string(9999, 'a')); }).size(),
      7u + 4000u);
}

TEST(LimitedChild, ACrashIsTheChildsAlone) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGKILL})
    EXPECT_THAT(result_of([&](const ChildOutput&) -> Expected<void> {
                  raise(signal);
                  return {};
                }),
                HasSubstr("signal " + std::to_string(signal)));
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "none is left";
}

TEST(LimitedChild, WhatNeverEndsIsEnded) {
  EXPECT_THAT(result_of(
                  [](const ChildOutput&) -> Expected<void> {
                    for (volatile unsigned i = 0;; i = i + 1) {
                    }
                  },
                  {.memory_bytes = kLimits.memory_bytes, .cpu_seconds = 1}),
              HasSubstr("more than 1 s"));
}

TEST(LimitedChild, MemoryIsLimited) {
  if (!limits_child_memory()) GTEST_SKIP() << "not under a sanitizer";
  const auto take = [](std::size_t bytes) {
    return result_of([=](const ChildOutput& output) -> Expected<void> {
      std::vector<char> much(bytes, 'x');
      write_text(output, much[bytes / 2] == 'x' ? "there" : "");
      return {};
    });
  };
  EXPECT_EQ(take(100u << 20), "there");
  EXPECT_EQ(take(300u << 20), "error: std::bad_alloc");
}

TEST(LimitedChild, WhatWritesMoreThanIsAskedForIsEnded) {
  const auto done = run_limited(
      kLimits,
      [](const ChildOutput& output) -> Expected<void> {
        while (write_text(output, std::string(1 << 20, 'x'))) {
        }
        return {};
      },
      [](const ChildInput& input) -> Expected<void> {
        std::uint8_t byte = 0;
        input({&byte, 1});
        return {};
      });
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, HasSubstr("more than was asked for"));
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "none is left";
}

TEST(LimitedChild, AnErrorOfTheParentEndsIt) {
  const auto done = run_limited(
      kLimits,
      [](const ChildOutput& output) -> Expected<void> {
        for (;;) write_text(output, "more");
      },
      [](const ChildInput&) { return fail("enough"); });
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().message, "enough");
  const auto throws = [](const ChildInput&) -> Expected<void> { throw std::bad_alloc(); };
  EXPECT_THROW(static_cast<void>(run_limited(
                   kLimits, [](const ChildOutput&) -> Expected<void> { return {}; }, throws)),
               std::bad_alloc);
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "none is left";
}

}  // namespace
}  // namespace penumbra::limited_child_test
