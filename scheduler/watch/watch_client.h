// A client that watches a render from another process: keeps the connection up, receives the news, and sends
// requests.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scheduler/plan/work_unit.h"
#include "scheduler/protocol/client.h"
#include "scheduler/protocol/scene_fetch.h"
#include "scheduler/watch/watch_board.h"

namespace penumbra {

namespace watch_news {

struct Connected {  ///< the first of a connection
  WatchedJob job;
  std::shared_ptr<const DeviceScene> scene;  ///< of interactive and hybrid jobs; else nothing
};
struct Said {
  std::string text;
};
struct Lost {  ///< the connection; another one is tried
  std::string why;
};
struct Refused {  ///< by the scheduler; nothing more will come
  std::string why;
};
struct Ended {};  ///< the render is over; nothing more will come

}  // namespace watch_news

using WatchNews = std::variant<watch_news::Connected, watch_news::Said, watch_news::Lost, watch_news::Refused,
                               watch_news::Ended, WatchView, WatchProgress, TileSnapshot>;

/// Two threads: one reads, one sends what was asked for, so that nothing here ever waits for the network.
/// Members are called by one other thread.
class WatchClient {
 public:
  /// "unix:/path" or "host:port", where the token is needed, and with TLS the keys.
  /// `job`: the one to watch; 0: the oldest that is not over.
  WatchClient(std::string address, std::string token, std::shared_ptr<const Keys> keys = {}, JobId job = 0);
  WatchClient(const WatchClient&) = delete;
  WatchClient& operator=(const WatchClient&) = delete;
  ~WatchClient();

  /// What has come since the last call, in order. Nothing of views older than the last that was asked for.
  /// What follows a Connected waits for the next call: the answer to it may be another view.
  std::vector<WatchNews> take();
  /// Requests another view, without samples at first. The newest request replaces one that has not been sent
  /// yet; from here on nothing of older views is taken.
  void change_view(const View& view);
  /// Whether this view, which `take` returned, is the last one that this client requested, and not another
  /// viewer's.
  [[nodiscard]] bool is_own(const WatchView& view) const;
  /// Requests so many samples per pixel in all of the newest view.
  void want_samples(std::uint32_t spp);

 private:
  struct Item {
    std::optional<std::uint32_t> view;  // the number that it is of
    std::uint32_t connection = 0;       // likewise
    WatchNews news;
  };

  void read();
  void watch(penumbra::v1::Farm::Stub& stub, grpc::ClientContext& context);
  bool receive(penumbra::v1::Farm::Stub& stub, const penumbra::v1::WatchEvent& event,
               std::optional<WatchedJob>& job, std::optional<Error>& scene_error);
  Expected<DeviceScene> fetch(penumbra::v1::Farm::Stub& stub, const std::string& hash);
  void put(WatchNews news, std::optional<std::uint32_t> view = {});
  void send();
  void pause();
  void explain_absence();

  const std::string address_, token_;
  const std::shared_ptr<const Keys> keys_;
  const JobId wanted_job_;
  const std::shared_ptr<grpc::Channel> channel_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false, over_ = false;
  grpc::ClientContext* reading_ = nullptr;
  SceneFetch* fetching_ = nullptr;
  grpc::ClientContext* sending_ = nullptr;
  std::deque<Item> items_;
  std::optional<View> next_view_;  // to be sent
  bool view_on_its_way_ = false;   // its number is not known yet
  std::uint32_t connection_ = 0;   // each may be to another scheduler, which numbers its views anew
  std::uint32_t job_ = 0;          // of this connection
  std::uint32_t newest_view_ = 0;
  std::optional<std::uint32_t> own_view_;  // the last that was asked for from here
  std::uint32_t wanted_spp_ = 0, sent_spp_ = 0;

  std::string said_absence_;  // of the reading thread
  std::thread reader_, sender_;
};

}  // namespace penumbra
