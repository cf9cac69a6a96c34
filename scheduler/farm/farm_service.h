// The scheduler's implementation of the calls of penumbra.proto.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "penumbra.grpc.pb.h"
#include "scheduler/farm/arrivals.h"
#include "scheduler/farm/offered_asset.h"
#include "scheduler/farm/result_room.h"
#include "scheduler/farm/worker_connection.h"
#include "worker/protocol/mailbox.h"
#include "worker/protocol/wire.h"

namespace penumbra {

/// The state shared by all addresses on which the scheduler listens. Thread-safe.
class Farm {
 public:
  Farm(const Farm&) = delete;
  Farm& operator=(const Farm&) = delete;
  /// Locks only for the thread sanitizer, which cannot see that all calls are over.
  ~Farm() { const std::lock_guard lock(mutex_); }

  /// `room`: bytes for results that arrive in parts.
  explicit Farm(std::size_t room) : room_(room) {}

  /// Bounded: if senders are faster than the farm's loop, they wait.
  Mailbox<Arrival> mailbox{kMostArrivals};
  /// Puts an event from a worker into the mailbox. Beats wait elsewhere, so that other events do not delay
  /// them.
  void put(Arrival arrival);
  /// A beat that waits: of each worker, at most the last one.
  std::optional<arrivals::Beat> take_beat();

  /// Makes a job visible to viewers. An `interactive` job accepts Control.
  void show(JobId job, std::shared_ptr<WatchBoard> board, bool interactive);
  /// The job is over. Its current viewers still see its end.
  void hide(JobId job);
  /// The board of the job, waiting at most `patience` for it; 0 stands for the oldest job. Null if there is
  /// none.
  std::shared_ptr<WatchBoard> board(JobId job, std::chrono::milliseconds patience);
  /// Closes all boards; nothing more will be shown.
  void close_boards();
  [[nodiscard]] bool is_closed();

  /// Adds an asset. Equal assets are stored once, until each of them has been removed.
  void add_asset(OfferedAsset asset);
  void remove_asset(const std::string& hash);
  /// Null if there is no asset of this hash.
  std::shared_ptr<const OfferedAsset> asset(const std::string& hash);

  std::pair<WorkerId, std::shared_ptr<WorkerConnection>> open();
  void close(WorkerId worker);
  /// Null if the worker has gone.
  std::shared_ptr<WorkerConnection> connection(WorkerId worker);
  std::vector<std::shared_ptr<WorkerConnection>> all_connections();

  /// The job to which Control applies; 0 stands for the oldest. Error: there is no such job, or it is not
  /// interactive; sets `code`.
  Expected<JobId> controlled(JobId job, grpc::StatusCode& code);
  /// Sets another view and returns its number, the job's next.
  std::uint32_t change_view(JobId job, const View& view);
  /// Reserves the job's next view number, for a restart without a new view.
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
  std::mutex beats_mutex_;
  std::map<WorkerId, std::uint64_t> beats_;  // their parts

  ResultRoom room_;
  std::mutex mutex_;
  WorkerId next_worker_ = 1;
  std::map<WorkerId, std::shared_ptr<WorkerConnection>> connections_;
  struct CountedAsset {
    std::shared_ptr<const OfferedAsset> asset;
    int users = 0;
  };
  std::map<std::string, CountedAsset> assets_;
};

/// The service at one address. `on_call` is called with the peer of each call, after its token (if one is
/// required) has been checked.
class FarmService final : public wire::Farm::WithCallbackMethod_Work<wire::Farm::Service> {
 public:
  explicit FarmService(Farm& farm, std::function<void(const std::string& peer)> on_call = {});

  /// There may be thousands of workers, so no thread waits for one.
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
