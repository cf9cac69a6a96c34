// A worker that speaks the protocol and renders nothing. It has its own connection, but no thread.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/client_callback.h>

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "penumbra.grpc.pb.h"
#include "tests/load/load_board.h"
#include "worker/protocol/unit_result.h"

namespace penumbra {

class SimulatedWorker final : public grpc::ClientBidiReactor<wire::WorkerMessage, wire::SchedulerMessage> {
 public:
  using Clock = std::chrono::steady_clock;

  /// What a worker needs of the others. Called from any thread.
  struct Crew {
    LoadBoard& board;
    /// `finish_unit` is to be called at that time.
    std::function<void(SimulatedWorker&, Clock::time_point)> finish_at;
    /// An order for the unit has come.
    std::function<void(const UnitId&)> ordered;
    /// The stream is over.
    std::function<void()> over;
  };

  /// `key`: of the one that the scheduler started.
  SimulatedWorker(Crew& crew, const std::string& address, const std::string& key, int number);

  void start();
  /// A sign of life.
  void beat();
  /// The unit in hand is done.
  void finish_unit();
  /// Breaks the connection; the units that it held.
  std::deque<UnitId> die();

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

 private:
  struct Held {
    UnitId id;
    std::uint32_t view;
    RenderUnit unit;
  };

  void say(wire::WorkerMessage message);  // the lock is held
  void take(const wire::Unit& unit);
  void begin_unit();  // the lock is held

  Crew& crew_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<wire::Farm::Stub> stub_;
  grpc::ClientContext context_;
  std::mutex mutex_;
  wire::SchedulerMessage incoming_;
  std::deque<wire::WorkerMessage> outgoing_;  // the first is being written
  std::deque<Held> held_;                     // the first is in hand
  std::deque<Clock::time_point> answered_;    // results for which no order has come yet
  std::uint64_t parts_ = 0;
  bool over_ = false;
};

}  // namespace penumbra
