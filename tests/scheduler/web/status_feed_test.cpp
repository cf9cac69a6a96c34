// Tests what is sent of a state that changes.
#include "scheduler/web/status_feed.h"

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

namespace penumbra::status_feed_test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;

constexpr auto kLong = 60s;

TEST(StatusFeed, TheFirstStateComesAtOnceAndOthersWithChanges) {
  std::atomic<int> value = 1, time = 0;
  StatusFeed feed([&] { return Json{{"now", ++time}, {"value", int(value)}}; }, 1ms);
  const auto first = feed.next(0, kLong);
  ASSERT_TRUE(first);
  EXPECT_NE(first->json->find("\"value\":1"), std::string::npos);
  EXPECT_FALSE(feed.next(first->number, 50ms)) << "the time of day is no change";
  EXPECT_GT(time, 1) << "it has looked";
  value = 2;
  const auto second = feed.next(first->number, kLong);
  ASSERT_TRUE(second);
  EXPECT_GT(second->number, first->number);
  EXPECT_NE(second->json->find("\"value\":2"), std::string::npos);
}

TEST(StatusFeed, ReadersShareOneLook) {
  std::atomic<int> looks = 0;
  StatusFeed feed([&] { return Json{{"looks", int(++looks)}}; }, std::chrono::hours(1));
  std::vector<std::thread> readers;
  std::atomic<int> got = 0;
  for (int i = 0; i < 8; ++i) readers.emplace_back([&] { got += feed.next(0, kLong).has_value(); });
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(got, 8);
  EXPECT_EQ(looks, 1);
}

TEST(StatusFeed, NobodyLooksWhileNobodyWaits) {
  std::atomic<int> looks = 0;
  StatusFeed feed([&] { return Json{{"looks", int(++looks)}}; }, 1ms);
  std::this_thread::sleep_for(20ms);
  EXPECT_EQ(looks, 0);
  feed.close();
  EXPECT_EQ(looks, 0);
}

TEST(StatusFeed, TheLastStateIsSentWhenItIsClosed) {
  std::atomic<int> value = 1;
  StatusFeed feed([&] { return Json{{"value", int(value)}}; }, std::chrono::hours(1));
  const auto first = feed.next(0, kLong);
  ASSERT_TRUE(first);
  value = 2;
  feed.close();
  const auto last = feed.next(first->number, kLong);
  ASSERT_TRUE(last);
  EXPECT_NE(last->json->find("\"value\":2"), std::string::npos);
  EXPECT_FALSE(feed.next(last->number, kLong));
}

TEST(StatusFeed, AStateThatCannotBeMadeIsTriedAgain) {
  std::atomic<bool> fails = true;
  StatusFeed feed(
      [&]() -> Json {
        if (fails.exchange(false)) throw std::bad_alloc();
        return {{"value", 1}};
      },
      1ms);
  EXPECT_TRUE(feed.next(0, kLong));
}

}  // namespace
}  // namespace penumbra::status_feed_test
