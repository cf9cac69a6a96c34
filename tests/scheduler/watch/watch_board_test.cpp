// Tests what watchers are shown, however slow and many they are.
#include "scheduler/watch/watch_board.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <map>
#include <set>
#include <thread>

namespace penumbra::watch_board_test {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;
using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using Watcher = WatchBoard::Watcher;

// What waits for something that happens on another thread; nothing takes so long unless it hangs.
constexpr auto kLong = 10s;
constexpr std::size_t kMessagesKept = 100;

TileSnapshot tile(std::uint32_t samples, std::uint32_t view = 0) {
  TileSnapshot snapshot;
  snapshot.view = view;
  snapshot.samples = samples;
  return snapshot;
}

WatchProgress progress(std::uint64_t samples) {
  WatchProgress p;
  p.samples_done = samples;
  return p;
}

/// What a watcher took, in order.
struct Taken {
  std::vector<std::uint32_t> views;
  std::vector<std::string> messages;
  std::vector<std::uint64_t> progress;
  std::vector<std::uint32_t> tile_samples;
  std::string order;  // one letter an item

  void add(const WatchItem& item) {
    if (const auto* view = std::get_if<WatchView>(&item)) {
      views.push_back(view->number);
      order += 'v';
    } else if (const auto* text = std::get_if<std::string>(&item)) {
      messages.push_back(*text);
      order += 'm';
    } else if (const auto* p = std::get_if<std::shared_ptr<const WatchProgress>>(&item)) {
      progress.push_back((*p)->samples_done);
      order += 'p';
    } else {
      tile_samples.push_back(std::get<std::shared_ptr<const TileSnapshot>>(item)->samples);
      order += 't';
    }
  }
};

/// Everything that is there now.
Taken take_all(Watcher& watcher) {
  Taken taken;
  while (const std::optional<WatchItem> item = watcher.next(0ms)) taken.add(*item);
  return taken;
}

TEST(WatchBoard, ASlowWatcherGetsTheNewestStateOnlyAndNothingPilesUp) {
  WatchBoard board(3);
  Watcher watcher(board);
  constexpr std::uint32_t kChanges = 5000;
  for (std::uint32_t i = 1; i <= kChanges; ++i) {
    board.show_progress(progress(i));
    board.show_tile(i % 3, tile(i));
    board.say(std::to_string(i));
  }
  const Taken taken = take_all(watcher);
  EXPECT_THAT(taken.progress, ElementsAre(kChanges));
  EXPECT_THAT(taken.tile_samples, testing::UnorderedElementsAre(kChanges, kChanges - 1, kChanges - 2));
  ASSERT_THAT(taken.messages, SizeIs(kMessagesKept)) << "the last ones, and no more";
  EXPECT_EQ(taken.messages.front(), std::to_string(kChanges - kMessagesKept + 1));
  EXPECT_EQ(taken.messages.back(), std::to_string(kChanges));
  EXPECT_EQ(taken.order.size(), 1 + 3 + kMessagesKept);
  EXPECT_THAT(take_all(watcher).order, IsEmpty()) << "it has seen everything";
}

TEST(WatchBoard, AReplacedTileIsFreed) {
  WatchBoard board(1);
  Watcher watcher(board);
  board.show_tile(0, tile(1));
  std::weak_ptr<const TileSnapshot> first;
  {
    const std::optional<WatchItem> item = watcher.next(0ms);
    ASSERT_TRUE(item);
    first = std::get<std::shared_ptr<const TileSnapshot>>(*item);
  }
  EXPECT_FALSE(first.expired()) << "a watcher may still come";
  board.show_tile(0, tile(2));
  EXPECT_TRUE(first.expired());
}

TEST(WatchBoard, TheOrderIsViewMessagesProgressTiles) {
  WatchBoard board(2);
  Watcher watcher(board);
  board.show_tile(1, tile(1));
  board.show_progress(progress(1));
  board.say("a");
  board.say("b");
  board.show_view({1, {}});  // forgets tile and progress
  board.show_tile(0, tile(2));
  board.show_progress(progress(2));
  const Taken taken = take_all(watcher);
  EXPECT_EQ(taken.order, "vmmpt");
  EXPECT_THAT(taken.messages, ElementsAre("a", "b"));
}

TEST(WatchBoard, AViewForgetsTilesAndProgressOfTheLast) {
  WatchBoard board(2);
  Watcher watcher(board);
  board.show_view({1, {}});
  board.show_tile(0, tile(1, 1));
  board.show_tile(1, tile(1, 1));
  board.show_progress(progress(7));
  EXPECT_EQ(take_all(watcher).order, "vptt");
  board.show_tile(1, tile(2, 1));
  board.show_view({2, {}});
  board.show_view({3, {}});
  const Taken taken = take_all(watcher);
  EXPECT_EQ(taken.order, "v") << "nothing of the old view, and of the new ones the newest";
  EXPECT_THAT(taken.views, ElementsAre(3));
  Watcher late(board);
  EXPECT_EQ(take_all(late).order, "v");
}

TEST(WatchBoard, WantedLayersAreThoseOfTheJobUntilTheLastWatcherGoes) {
  WatchBoard board(1);
  WatchedJob job;
  job.layers = {"albedo", "depth"};
  board.describe(job);
  {
    Watcher first(board);
    EXPECT_TRUE(board.take_request_for_all_tiles());
    board.want_layers({"depth", "nonsense"});
    EXPECT_THAT(board.wanted_layers(), ElementsAre("depth"));
    EXPECT_TRUE(board.take_request_for_all_tiles()) << "tiles without the layer have been shown";
    board.want_layers({"depth"});
    EXPECT_FALSE(board.take_request_for_all_tiles()) << "nothing new is wanted";
    Watcher second(board);
    board.want_layers({"albedo"});
    EXPECT_THAT(board.wanted_layers(), ElementsAre("albedo", "depth"));
  }
  EXPECT_THAT(board.wanted_layers(), IsEmpty());
}

TEST(WatchBoard, SeveralWatchersEachSeeEverything) {
  WatchBoard board(4);
  constexpr int kWatchers = 4;
  std::vector<std::future<Taken>> all;
  std::atomic<int> there = 0;
  for (int i = 0; i < kWatchers; ++i) {
    all.push_back(std::async(std::launch::async, [&, i] {
      Watcher watcher(board);
      ++there;
      Taken taken;
      while (!watcher.at_end()) {
        if (const auto item = watcher.next(kLong)) taken.add(*item);
        std::this_thread::sleep_for(std::chrono::microseconds(300 * i));  // some are slower
      }
      return taken;
    }));
  }
  while (there < kWatchers) std::this_thread::yield();
  constexpr std::uint32_t kChanges = 400;
  for (std::uint32_t i = 0; i < kChanges; ++i) {
    board.show_tile(i % 4, tile(i));
    if (i % 8 == 0) board.say(std::to_string(i));
    board.show_progress(progress(i));
    std::this_thread::sleep_for(100us);
  }
  board.close();
  std::vector<std::string> said;
  for (std::uint32_t i = 0; i < kChanges; i += 8) said.push_back(std::to_string(i));
  for (auto& future : all) {
    const Taken taken = future.get();
    EXPECT_EQ(taken.messages, said) << "fewer than are kept, so none is missed";
    EXPECT_EQ(taken.progress.back(), kChanges - 1);
    EXPECT_TRUE(std::ranges::is_sorted(taken.progress));
    std::map<std::uint32_t, std::uint32_t> last;
    for (const std::uint32_t samples : taken.tile_samples) {
      EXPECT_TRUE(!last.contains(samples % 4) || last[samples % 4] < samples) << "an older state came later";
      last[samples % 4] = samples;
    }
    EXPECT_THAT(last, SizeIs(4));
    for (const auto& [at, samples] : last) EXPECT_GE(samples, kChanges - 4);
  }
}

TEST(WatchBoard, NoTileStarvesBehindBusierOnes) {
  constexpr std::uint32_t kTiles = 8;
  WatchBoard board(kTiles);
  Watcher watcher(board);
  for (std::uint32_t i = 0; i < kTiles; ++i) board.show_tile(i, tile(100 + i));
  // All but the last change between any two looks.
  std::vector<std::uint32_t> seen;
  for (std::uint32_t look = 0; look < kTiles; ++look) {
    const std::optional<WatchItem> item = watcher.next(0ms);
    ASSERT_TRUE(item);
    seen.push_back(std::get<std::shared_ptr<const TileSnapshot>>(*item)->samples);
    for (std::uint32_t i = 0; i + 1 < kTiles; ++i) board.show_tile(i, tile(1000 + i));
  }
  EXPECT_THAT(seen, testing::Contains(100 + kTiles - 1)) << "the quiet tile has had its turn";
}

TEST(WatchBoard, AWatcherThatFindsNoTilesRequestsAll) {
  WatchBoard board(2);
  EXPECT_FALSE(board.is_watched());
  EXPECT_FALSE(board.take_request_for_all_tiles());
  board.show_tile(0, tile(1));
  {
    Watcher first(board);
    EXPECT_TRUE(board.is_watched());
    EXPECT_THAT(take_all(first).tile_samples, IsEmpty()) << "without watchers no tiles are kept";
    EXPECT_TRUE(board.take_request_for_all_tiles());
    EXPECT_FALSE(board.take_request_for_all_tiles()) << "once";
    board.show_tile(0, tile(2));
    board.show_tile(1, tile(3));
    Watcher second(board);
    EXPECT_FALSE(board.take_request_for_all_tiles()) << "the tiles are here";
    EXPECT_THAT(take_all(second).tile_samples, ElementsAre(2, 3));
    EXPECT_THAT(take_all(first).tile_samples, ElementsAre(2, 3));
  }
  EXPECT_FALSE(board.is_watched());
  Watcher third(board);
  EXPECT_TRUE(board.take_request_for_all_tiles())
      << "the earlier watchers have gone, and the tiles with them";
  EXPECT_THAT(take_all(third).tile_samples, IsEmpty());
}

TEST(WatchBoard, ALateWatcherHearsWhatWasSaid) {
  WatchBoard board(1);
  board.say("before");
  board.show_progress(progress(5));
  Watcher watcher(board);
  const Taken taken = take_all(watcher);
  EXPECT_THAT(taken.messages, ElementsAre("before"));
  EXPECT_THAT(taken.progress, ElementsAre(5));
}

TEST(WatchBoard, TheJobCanBeWaitedFor) {
  WatchBoard board(1);
  Watcher watcher(board);
  EXPECT_FALSE(watcher.job(1ms));
  std::thread describes([&] {
    std::this_thread::sleep_for(20ms);
    WatchedJob job;
    job.title = "here";
    board.describe(std::move(job));
  });
  const std::optional<WatchedJob> job = watcher.job(kLong);
  describes.join();
  ASSERT_TRUE(job);
  EXPECT_EQ(job->title, "here");
  WatchBoard closed(1);
  Watcher hopeless(closed);
  closed.close();
  const auto begin = steady_clock::now();
  EXPECT_FALSE(hopeless.job(kLong));
  EXPECT_LT(steady_clock::now() - begin, kLong) << "a closed board describes nothing any more";
  EXPECT_TRUE(hopeless.at_end());
}

TEST(WatchBoard, TheEndIsAfterTheLastItem) {
  WatchBoard board(1);
  Watcher watcher(board);
  EXPECT_FALSE(watcher.at_end());
  board.say("last");
  board.close();
  EXPECT_FALSE(watcher.at_end()) << "there is something to see";
  EXPECT_EQ(take_all(watcher).order, "m");
  EXPECT_TRUE(watcher.at_end());
  const auto begin = steady_clock::now();
  EXPECT_FALSE(watcher.next(kLong));
  EXPECT_LT(steady_clock::now() - begin, kLong) << "nothing will come, so nothing is waited for";
}

/// How long wait_for_watchers takes.
std::chrono::milliseconds time_to_wait(WatchBoard& board, std::chrono::milliseconds patience) {
  const auto begin = steady_clock::now();
  board.wait_for_watchers(patience);
  return std::chrono::duration_cast<std::chrono::milliseconds>(steady_clock::now() - begin);
}

TEST(WaitForWatchers, ReturnsAtOnceWhenAllHaveSeenAll) {
  WatchBoard unwatched(1);
  unwatched.say("unread");
  EXPECT_LT(time_to_wait(unwatched, kLong), kLong / 2);
  WatchBoard board(1);
  Watcher a(board), b(board);
  board.say("to both");
  take_all(a);
  take_all(b);
  EXPECT_LT(time_to_wait(board, kLong), kLong / 2);
}

TEST(WaitForWatchers, ReturnsWhenTheLastOneHasSeenAllOrHasGone) {
  for (const bool goes : {false, true}) {
    WatchBoard board(1);
    auto watcher = std::make_unique<Watcher>(board);
    board.say("wait");
    board.close();
    std::atomic<bool> was_free = false;
    std::thread looks([&] {
      std::this_thread::sleep_for(30ms);
      was_free = true;
      if (goes) return watcher.reset();
      take_all(*watcher);
    });
    EXPECT_LT(time_to_wait(board, kLong), kLong / 2);
    EXPECT_TRUE(was_free) << "it did not wait";
    looks.join();
  }
}

TEST(WaitForWatchers, GoesOnWaitingWhileAWatcherMakesProgress) {
  WatchBoard board(20);
  Watcher watcher(board);
  for (std::uint32_t i = 0; i < 20; ++i) board.show_tile(i, tile(1));
  board.close();
  constexpr auto kPatience = 1000ms, kPace = 100ms;  // two seconds in all, twice the patience
  std::thread reads([&] {
    while (watcher.next(0ms)) std::this_thread::sleep_for(kPace);
  });
  EXPECT_GE(time_to_wait(board, kPatience), 19 * kPace);
  EXPECT_TRUE(watcher.at_end()) << "it was given up";
  reads.join();
}

TEST(WaitForWatchers, GivesUpOnOneThatHangs) {
  WatchBoard board(1);
  Watcher hangs(board), quick(board);
  board.say("look");
  board.close();
  take_all(quick);
  constexpr auto kPatience = 100ms;
  const auto taken = time_to_wait(board, kPatience);
  EXPECT_GE(taken, kPatience);
  EXPECT_LT(taken, kLong);
  EXPECT_FALSE(hangs.at_end());
}

}  // namespace
}  // namespace penumbra::watch_board_test
