// The stream of one worker, as gRPC calls it back: no thread waits for a worker.
#pragma once

#include <grpcpp/alarm.h>
#include <grpcpp/support/server_callback.h>

#include <memory>

#include "scheduler/farm/farm_service.h"

namespace penumbra {

/// Deletes itself when the call is over. Putting an arrival into a full mailbox makes gRPC's thread wait, and
/// with it whoever sends more than the scheduler takes.
class WorkStream final : public grpc::ServerBidiReactor<wire::WorkerMessage, wire::SchedulerMessage>,
                         public WorkerConnection::Stream {
 public:
  WorkStream(Farm& farm, grpc::CallbackServerContext& context);

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone() override;

  void write(const wire::SchedulerMessage& message) override { StartWrite(&message); }
  void is_final() override;
  void cancel() override { context_.TryCancel(); }

 private:
  void take_hello();
  void end(const grpc::Status& status);
  void cut_off_in(std::chrono::milliseconds time, grpc::Alarm& alarm);

  Farm& farm_;
  grpc::CallbackServerContext& context_;
  wire::WorkerMessage incoming_;
  wire::SchedulerMessage refusal_;
  WorkerId worker_ = 0;
  std::shared_ptr<WorkerConnection> connection_;  // from Hello on
  grpc::Status status_;
  std::unique_ptr<grpc::Alarm> leaving_, ending_;
};

}  // namespace penumbra
