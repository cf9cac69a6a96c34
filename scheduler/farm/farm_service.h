// The calls of penumbra.proto, as the scheduler answers them.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "scheduler/farm/arrivals.h"
#include "scheduler/farm/worker_connection.h"
#include "scheduler/protocol/mailbox.h"
#include "scheduler/protocol/wire.h"

namespace penumbra {

/// The state shared by all addresses on which the scheduler listens. Thread-safe.
class Farm {
 public:
  Farm(WatchBoard& shown, bool takes_control) : board(shown), interactive(takes_control) {}

  /// Its length is bounded: a sender that is faster than the render's loop waits.
  Mailbox<Arrival> mailbox{kMostArrivals};
  WatchBoard& board;
  const bool interactive;

  void add_asset(std::string hash, std::vector<std::uint8_t> bytes);
  /// Nothing if there is none of this hash.
  std::shared_ptr<const std::vector<std::uint8_t>> asset(const std::string& hash);

  std::pair<WorkerId, std::shared_ptr<WorkerConnection>> open();
  void close(WorkerId worker);
  /// Nothing if it has gone.
  std::shared_ptr<WorkerConnection> connection(WorkerId worker);
  std::vector<std::shared_ptr<WorkerConnection>> all_connections();

  /// Another view, with the next number.
  std::uint32_t change_view(const View& view);

 private:
  static constexpr std::size_t kMostArrivals = 1024;

  std::mutex view_mutex_;
  std::uint32_t last_view_ = 0;
  std::mutex mutex_;
  WorkerId next_worker_ = 1;
  std::map<WorkerId, std::shared_ptr<WorkerConnection>> connections_;
  std::map<std::string, std::shared_ptr<const std::vector<std::uint8_t>>> assets_;
};

/// The service at one address. `on_call` is called with the peer of each call, after the token has been
/// checked where one is required.
class FarmService final : public wire::Farm::Service {
 public:
  explicit FarmService(Farm& farm, std::function<void(const std::string& peer)> on_call = {})
      : farm_(farm), on_call_(std::move(on_call)) {}

  grpc::Status Work(grpc::ServerContext* context, WorkerConnection::Stream* stream) override;
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
