// The stream of one worker, driven by gRPC's callbacks: no thread waits for a worker.
#pragma once

#include <grpcpp/alarm.h>
#include <grpcpp/support/server_callback.h>

#include <memory>

#include "scheduler/farm/farm_service.h"

namespace penumbra {

/// Deletes itself when the call is over. If the mailbox is full, putting an event into it blocks gRPC's
/// thread, which slows down workers that send faster than the scheduler consumes. While there is no room for
/// a large result, nothing more is read.
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
  void take_message();
  void wait_for_room();
  void end(const grpc::Status& status);
  void cut_off_in(std::chrono::milliseconds time, grpc::Alarm& alarm);

  Farm& farm_;
  grpc::CallbackServerContext& context_;
  wire::WorkerMessage incoming_;
  wire::SchedulerMessage refusal_;
  WorkerId worker_ = 0;
  std::shared_ptr<WorkerConnection> connection_;  // set when Hello has arrived
  grpc::Status status_;
  std::unique_ptr<grpc::Alarm> leaving_, ending_, waiting_;
};

}  // namespace penumbra
