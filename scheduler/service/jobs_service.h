// The calls of jobs.proto, as a service answers them.
#pragma once

#include <functional>
#include <string>

#include "jobs.grpc.pb.h"
#include "scheduler/service/job_queue.h"
#include "scheduler/service/spool.h"

namespace penumbra {

class JobsService final : public wire::Jobs::Service {
 public:
  /// `on_call` is called with the peer of each call, after the token has been checked where one is required.
  JobsService(JobQueue& queue, Spool& spool, std::function<void(const std::string& peer)> on_call = {})
      : queue_(queue), spool_(spool), on_call_(std::move(on_call)) {}

  grpc::Status HasScene(grpc::ServerContext* context, const wire::HasSceneRequest* request,
                        wire::HasSceneReply* reply) override;
  grpc::Status PutScene(grpc::ServerContext* context, grpc::ServerReader<wire::SceneChunk>* reader,
                        wire::PutSceneReply* reply) override;
  grpc::Status Submit(grpc::ServerContext* context, const wire::SubmitRequest* request,
                      wire::SubmitReply* reply) override;
  grpc::Status Status(grpc::ServerContext* context, const wire::StatusRequest* request,
                      wire::StatusReply* reply) override;
  grpc::Status Change(grpc::ServerContext* context, const wire::ChangeRequest* request,
                      wire::ChangeReply* reply) override;
  grpc::Status Fetch(grpc::ServerContext* context, const wire::FetchRequest* request,
                     grpc::ServerWriter<wire::FetchChunk>* writer) override;

 private:
  /// What every call begins with; an error where the peer is of another version.
  template <typename Request>
  grpc::Status begin(const grpc::ServerContext& context, const Request& request) const;

  JobQueue& queue_;
  Spool& spool_;
  const std::function<void(const std::string&)> on_call_;
};

}  // namespace penumbra
