// The calls of penumbra.proto, as the scheduler answers them.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "penumbra.grpc.pb.h"
#include "scheduler/farm/arrivals.h"
#include "scheduler/farm/offered_asset.h"
#include "scheduler/farm/worker_connection.h"
#include "scheduler/protocol/mailbox.h"
#include "scheduler/protocol/wire.h"

namespace penumbra {

/// The state shared by all addresses on which the scheduler listens. Thread-safe.
class Farm {
 public:
  /// Locks for the thread sanitizer's sake, which does not see that all calls are over.
  ~Farm() { const std::lock_guard lock(mutex_); }

  /// Its length is bounded: a sender that is faster than the render's loop waits.
  Mailbox<Arrival> mailbox{kMostArrivals};

  /// A job that can be watched from now on; `interactive` ones take Control.
  void show(JobId job, std::shared_ptr<WatchBoard> board, bool interactive);
  /// It is over. Those who watch it see its end.
  void hide(JobId job);
  /// What is shown of the job, waiting for it at most so long; of the oldest one for 0. Nothing if there is
  /// none.
  std::shared_ptr<WatchBoard> board(JobId job, std::chrono::milliseconds patience);
  /// Nothing more will be shown.
  void close_boards();
  [[nodiscard]] bool is_closed();

  /// Equal assets are kept once, until each has been removed.
  void add_asset(OfferedAsset asset);
  void remove_asset(const std::string& hash);
  /// Nothing if there is none of this hash.
  std::shared_ptr<const OfferedAsset> asset(const std::string& hash);

  std::pair<WorkerId, std::shared_ptr<WorkerConnection>> open();
  void close(WorkerId worker);
  /// Nothing if it has gone.
  std::shared_ptr<WorkerConnection> connection(WorkerId worker);
  std::vector<std::shared_ptr<WorkerConnection>> all_connections();

  /// The job that Control means, 0 the oldest one; or why there is none to control.
  Expected<JobId> controlled(JobId job, grpc::StatusCode& code);
  /// Another view, with the job's next number.
  std::uint32_t change_view(JobId job, const View& view);
  /// Takes the job's next number for what makes it begin anew.
  std::uint32_t next_view_number(JobId job);

 private:
  static constexpr std::size_t kMostArrivals = 1024;

  struct Shown {
    std::shared_ptr<WatchBoard> board;
    bool interactive = false;
  };
  std::mutex boards_mutex_;
  std::condition_variable boards_changed_;
  std::map<JobId, Shown> boards_;
  bool closed_ = false;

  std::mutex view_mutex_;
  std::map<JobId, std::uint32_t> last_views_;
  std::mutex mutex_;
  WorkerId next_worker_ = 1;
  std::map<WorkerId, std::shared_ptr<WorkerConnection>> connections_;
  struct CountedAsset {
    std::shared_ptr<const OfferedAsset> asset;
    int users = 0;
  };
  std::map<std::string, CountedAsset> assets_;
};

/// The service at one address. `on_call` is called with the peer of each call, after the token has been
/// checked where one is required.
class FarmService final : public wire::Farm::WithCallbackMethod_Work<wire::Farm::Service> {
 public:
  explicit FarmService(Farm& farm, std::function<void(const std::string& peer)> on_call = {});

  /// Of workers there may be thousands, so no thread waits for one.
  grpc::ServerBidiReactor<wire::WorkerMessage, wire::SchedulerMessage>* Work(
      grpc::CallbackServerContext* context) override;
  grpc::Status Manifest(grpc::ServerContext* context, const wire::AssetRequest* request,
                        wire::AssetManifest* reply) override;
  grpc::Status Asset(grpc::ServerContext* context, const wire::AssetRequest* request,
                     grpc::ServerWriter<wire::AssetChunk>* writer) override;
  grpc::Status Watch(grpc::ServerContext* context, const wire::WatchRequest* request,
                     grpc::ServerWriter<wire::WatchEvent>* writer) override;
  grpc::Status Control(grpc::ServerContext* context, const wire::ControlRequest* request,
                       wire::ControlReply* reply) override;

 private:
  void called(const grpc::ServerContext& context) const {
    if (on_call_) on_call_(context.peer());
  }

  Farm& farm_;
  const std::function<void(const std::string&)> on_call_;
};

}  // namespace penumbra
