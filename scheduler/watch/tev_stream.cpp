#include "scheduler/watch/tev_stream.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

namespace penumbra {
namespace {

// How often an idle stream checks whether it should end.
constexpr std::chrono::milliseconds kStopInterval{50};

const std::vector<std::string> kRadiance{"R", "G", "B"};
const std::vector<std::string> kDifference{"difference.R", "difference.G", "difference.B"};
const std::vector<std::string> kStandardError{"standard_error.Y"};

/// One image in tev.
class Picture {
 public:
  Picture(TevClient client, const WatchedJob& job)
      : client_(std::move(client)), job_(job), name_(job.title.empty() ? "penumbra" : job.title) {}

  Expected<void> show(const WatchView&) {
    std::vector<std::string> channels = kRadiance;
    if (job_.hybrid) {
      channels.insert(channels.end(), kDifference.begin(), kDifference.end());
      channels.insert(channels.end(), kStandardError.begin(), kStandardError.end());
    }
    // After the first time, do not grab the focus: the user turns the camera in another window.
    return client_.create_image(name_, job_.film_width, job_.film_height, channels,
                                !std::exchange(created_, true));
  }
  Expected<void> show(const std::shared_ptr<const TileSnapshot>& tile) {
    Expected<void> shown = update(*tile, kRadiance, tile->radiance);
    if (shown && job_.hybrid) shown = update(*tile, kDifference, tile->difference);
    if (shown && job_.hybrid) shown = update(*tile, kStandardError, tile->standard_error);
    return shown;
  }
  Expected<void> show(const std::shared_ptr<const WatchProgress>&) { return {}; }
  Expected<void> show(const std::string&) { return {}; }

 private:
  Expected<void> update(const TileSnapshot& tile, const std::vector<std::string>& channels,
                        const std::vector<float>& values) {
    return client_.update_tile(name_, tile.x, tile.y, tile.width, tile.height, channels, values);
  }

  TevClient client_;
  WatchedJob job_;
  std::string name_;
  bool created_ = false;
};

}  // namespace

TevStream::TevStream(WatchBoard& board, std::string address, std::chrono::milliseconds timeout)
    : address_(std::move(address)), timeout_(timeout) {
  watcher_.emplace(board);
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

TevStream::~TevStream() { stop(); }

void TevStream::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

std::optional<std::string> TevStream::take_problem() {
  const std::lock_guard lock(mutex_);
  return std::exchange(problem_, {});
}

void TevStream::run(const std::stop_token& stop) {
  Expected<void> streamed = stream(stop);
  if (!streamed || (stop.stop_requested() && !watcher_->at_end())) {
    const std::lock_guard lock(mutex_);
    problem_ = stop.stop_requested()
                   ? fmt::format("tev at {} was too slow to take the whole image", address_)
                   : "tev does not show this render any further: " + streamed.error().message;
  }
  watcher_.reset();  // so that the render neither waits for it nor stores tiles for it
}

Expected<void> TevStream::stream(const std::stop_token& stop) {
  Expected<TevClient> client = TevClient::connect(address_, timeout_, stop);
  if (!client) return std::unexpected(client.error());
  std::optional<WatchedJob> job;
  while (!job && !stop.stop_requested() && !watcher_->at_end()) job = watcher_->job(kStopInterval);
  if (!job) return {};
  Picture picture(std::move(*client), *job);
  while (!stop.stop_requested() && !watcher_->at_end()) {
    const std::optional<WatchItem> item = watcher_->next(kStopInterval);
    if (!item) continue;
    const Expected<void> shown =
        std::visit([&](const auto& content) { return picture.show(content); }, *item);
    if (!shown) return shown;
  }
  return {};
}

}  // namespace penumbra
