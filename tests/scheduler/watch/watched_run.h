// A render with fake workers that runs in the background, and a watcher of it.
#pragma once

#include <gmock/gmock.h>
#include <stdlib.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "kernels/host/view.h"
#include "scheduler/watch/render_feed.h"
#include "scheduler/watch/watch_client.h"
#include "tests/support/fake_device.h"
#include "tests/support/fake_samples.h"
#include "tests/support/local_render.h"

namespace penumbra {

// For what happens on other threads and in other processes; nothing takes so long unless it hangs.
inline constexpr std::chrono::milliseconds kLong{20000};

inline constexpr int kX = 8, kY = 4, kWidth = 120, kHeight = 100, kTile = 16;
inline constexpr std::size_t kTiles = 8 * 7;
inline constexpr std::uint32_t kSpp = 10;

/// A camera whose fake samples lie in [shift, shift + 1).
inline View view_at(float shift) {
  View view{};
  view.camera.origin = make_vec3(shift, 0, 0);
  view.camera.x = make_vec3(1, 0, 0);
  view.camera.y = make_vec3(0, 1, 0);
  view.camera.z = make_vec3(0, 0, 1);
  view.camera.near_clip = 0.01f;
  view.camera.far_clip = 1e4f;
  view.adjustable.alpha = 1;
  return view;
}

/// The film that run_render must come to, without scheduler, workers and wire.
inline FilmAccumulator expected_film(std::uint32_t spp, std::uint32_t samples_per_pass, float shift = 0) {
  FilmAccumulator film(kX, kY, kWidth, kHeight, kFeatureLayers);
  for (std::uint32_t first = 0; first < spp; first += samples_per_pass) {
    const RenderUnit unit{kX, kY, kWidth, kHeight, first, std::min(samples_per_pass, spp - first)};
    film.add(kX, kY, fake_samples(unit, kFeatureLayers, shift));
  }
  return film;
}

class WatchedRunTest : public testing::Test {
 protected:
  void SetUp() override {
    char directory[] = "/tmp/penumbra-test-XXXXXX";
    ASSERT_NE(mkdtemp(directory), nullptr);
    directory_ = directory;
    setenv("XDG_RUNTIME_DIR", directory, 1);
    FakeBehaviour{}.to_environment();
  }
  void TearDown() override {
    FakeBehaviour{}.to_environment();
    std::filesystem::remove_all(directory_);
  }

  std::string address() const { return "unix:" + directory_ + "/socket"; }

  LocalRender batch_job() const {
    LocalRender job;
    job.scene = fake_scene(200, 150, true);
    job.x = kX;
    job.y = kY;
    job.width = kWidth;
    job.height = kHeight;
    job.spp = kSpp;
    job.request.plan.samples_per_pass = 4;
    job.request.plan.tile = kTile;
    job.workers = 2;
    job.worker_executable = PENUMBRA_BINARY_DIR "/fake_worker";
    job.reproduce_command = "penumbra render a.xml";
    job.title = "a.xml";
    job.listen = address();
    return job;
  }
  LocalRender interactive_job() const {
    LocalRender job = batch_job();
    job.interactive = true;
    job.request.plan.samples_per_pass = 1;
    return job;
  }

  std::string directory_;
};

/// run_render on a thread of its own, until it is done or stopped.
class BackgroundRun {
 public:
  explicit BackgroundRun(const LocalRender& job, std::function<void(const RenderProgress&)> on_progress = {})
      : job_(job), on_progress_(std::move(on_progress)) {
    outcome_ = std::async(std::launch::async, [this] { return run_render(job_, stop_, on_progress_); });
  }
  ~BackgroundRun() { stop_ = true; }

  /// The outcome once the render has ended by itself.
  RenderOutcome wait() {
    Expected<RenderOutcome> outcome = outcome_.get();
    EXPECT_TRUE(outcome) << outcome.error().message;
    return outcome ? std::move(*outcome) : RenderOutcome{};
  }
  RenderOutcome stop() {
    stop_ = true;
    return wait();
  }

 private:
  LocalRender job_;
  std::function<void(const RenderProgress&)> on_progress_;
  std::atomic<bool> stop_ = false;
  std::future<Expected<RenderOutcome>> outcome_;  // the last: its end waits for the render's
};

/// A watcher that records what it has seen. Each tile must be of the view that was seen last, and must have
/// samples, never fewer than before.
class Onlooker {
 public:
  explicit Onlooker(const std::string& address, const std::string& token = "") : client(address, token) {}

  void look() {
    for (WatchNews& item : client.take()) std::visit([this](auto& news) { see(news); }, item);
  }
  /// Looks until the condition holds.
  bool sees(const std::function<bool()>& condition, std::chrono::milliseconds patience = kLong) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    for (look(); !condition(); look()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
  }
  bool sees_end() {
    return sees([&] { return ended; });
  }
  bool sees_connection() {
    return sees([&] { return connections > 0; });
  }
  bool sees_workers(std::size_t count) {
    return sees([&] { return progress.workers.size() == count; });
  }
  /// So many samples in every tile.
  bool sees_samples(std::uint32_t spp) {
    return sees([&] {
      return tiles.size() == kTiles &&
             std::ranges::all_of(tiles, [&](const auto& tile) { return tile.second.samples == spp; });
    });
  }
  void change_view(float shift) {
    client.change_view(view_at(shift));
    // What is taken from here on must be of it.
    awaited_shift = shift;
    tiles.clear();
  }
  void expect_tiles_of(const FilmAccumulator& film) const {
    EXPECT_EQ(tiles.size(), kTiles);
    for (const auto& [corner, tile] : tiles) {
      const RenderUnit area{tile.x, tile.y, tile.width, tile.height, 0, 0};
      const TileSnapshot expected = snapshot_of(film, area, false, 1);
      EXPECT_EQ(tile.samples, expected.samples);
      EXPECT_EQ(tile.radiance, expected.radiance) << "the tile at " << tile.x << ", " << tile.y;
    }
  }

  WatchClient client;
  int connections = 0, losses = 0;
  bool ended = false;
  std::optional<WatchedJob> job;
  std::shared_ptr<const DeviceScene> scene;
  std::optional<WatchView> view;
  WatchProgress progress;
  std::map<std::pair<int, int>, TileSnapshot> tiles;
  std::vector<std::string> said;
  std::string refused;
  std::optional<float> awaited_shift;

 private:
  void see(watch_news::Connected& news) {
    ++connections;
    job = news.job;
    scene = news.scene;
    view.reset();
    tiles.clear();
    progress = {};
  }
  void see(watch_news::Said& news) { said.push_back(news.text); }
  void see(watch_news::Lost&) { ++losses; }
  void see(watch_news::Refused& news) { refused = news.why; }
  void see(watch_news::Ended&) { ended = true; }
  void see(WatchView& news) {
    if (view) {
      EXPECT_GT(news.number, view->number);
    }
    view = news;
    tiles.clear();
    progress = {};
  }
  void see(WatchProgress& news) {
    ASSERT_TRUE(view);
    EXPECT_EQ(news.view, view->number);
    EXPECT_GE(news.samples_done, progress.samples_done);
    progress = news;
  }
  void see(TileSnapshot& news) {
    ASSERT_TRUE(view);
    EXPECT_EQ(news.view, view->number);
    if (awaited_shift) {
      EXPECT_GE(news.radiance[0], *awaited_shift) << "a tile of an older view";
      EXPECT_LT(news.radiance[0], *awaited_shift + 1) << "a tile of another view";
    }
    TileSnapshot& seen = tiles[{news.x, news.y}];
    EXPECT_GT(news.samples, 0u);
    EXPECT_GE(news.samples, seen.samples);
    seen = std::move(news);
  }
};

}  // namespace penumbra
