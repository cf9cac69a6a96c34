// A client that watches a render from another process: keeps the connection up, receives updates, and sends
// requests.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scheduler/watch/watch_board.h"
#include "worker/protocol/client.h"
#include "worker/protocol/scene_fetch.h"
#include "worker/work_unit.h"

namespace penumbra {

namespace watch_news {

struct Connected {  ///< the first news of a connection
  WatchedJob job;
  std::shared_ptr<const DeviceScene> scene;  ///< only of interactive and hybrid jobs; else null
};
struct Said {
  std::string text;
};
struct Lost {  ///< the connection was lost; the client tries to reconnect
  std::string why;
};
struct Refused {  ///< by the scheduler; no more news will come
  std::string why;
};
struct Ended {};  ///< the render is over; no more news will come

}  // namespace watch_news

using WatchNews = std::variant<watch_news::Connected, watch_news::Said, watch_news::Lost, watch_news::Refused,
                               watch_news::Ended, WatchView, WatchProgress, TileSnapshot>;

/// Uses two threads, one that reads and one that sends requests, so that no call waits for the network.
/// Members must be called by one other thread.
class WatchClient {
 public:
  /// `address`: "unix:/path" or "host:port". The latter needs the token, and with TLS the keys. `job`: the
  /// one to watch; 0: the oldest that is not over. `on_news` is called on another thread when `take` has
  /// something. `is_starting`: the scheduler is expected to take its time; its absence is not explained.
  WatchClient(std::string address, std::string token, std::shared_ptr<const Keys> keys = {}, JobId job = 0,
              std::function<void()> on_news = {}, bool is_starting = false);
  WatchClient(const WatchClient&) = delete;
  WatchClient& operator=(const WatchClient&) = delete;
  ~WatchClient();

  /// The news since the last call, in order, except those of views older than the last one requested. News
  /// after a Connected are left for the next call, because the caller may answer by requesting another view.
  std::vector<WatchNews> take();
  /// Requests another view, initially without samples. The newest request replaces one that has not been sent
  /// yet. From now on, news of older views are dropped.
  void change_view(const View& view);
  /// Whether this view, which `take` returned, is the last one that this client requested, and not another
  /// viewer's.
  [[nodiscard]] bool is_own(const WatchView& view) const;
  /// Requests a total number of samples per pixel of the newest view.
  void want_samples(std::uint32_t spp);
  /// Requests a further layer in the tiles of this connection's job, one of WatchedJob::layers.
  void want_layer(const std::string& name);

 private:
  struct Item {
    std::optional<std::uint32_t> view;  // the number of the view that the request is for
    std::uint32_t connection = 0;       // the connection that the request is for
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
  const std::function<void()> on_news_;
  const bool is_starting_;
  const std::shared_ptr<grpc::Channel> channel_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false, over_ = false;
  grpc::ClientContext* reading_ = nullptr;
  SceneFetch* fetching_ = nullptr;
  grpc::ClientContext* sending_ = nullptr;
  std::deque<Item> items_;
  std::optional<View> next_view_;  // the next view to be sent
  bool view_on_its_way_ = false;   // the view has been sent, but its number is not known yet
  // Counts connections: each may be to another scheduler with its own view numbers.
  std::uint32_t connection_ = 0;
  std::uint32_t job_ = 0;  // the job on this connection
  std::uint32_t newest_view_ = 0;
  std::optional<std::uint32_t> own_view_;  // the last view requested by this client
  std::uint32_t wanted_spp_ = 0, sent_spp_ = 0;
  std::vector<std::string> wanted_layers_;  // not sent yet

  std::string said_absence_;  // the last message about an absent scheduler; used by the reading thread
  std::thread reader_, sender_;
};

}  // namespace penumbra
