#include "scheduler/service/jobs_service.h"

#include <fmt/format.h>

#include <fstream>

#include "jobs.grpc.pb.h"
#include "kernels/host/atomic_file.h"
#include "worker/protocol/wire.h"

namespace penumbra {
namespace {

grpc::Status status_of(const JobError& error) {
  switch (error.kind) {
    case JobErrorKind::kNotFound:
      return {grpc::StatusCode::NOT_FOUND, error.message};
    case JobErrorKind::kNotNow:
      return {grpc::StatusCode::FAILED_PRECONDITION, error.message};
    case JobErrorKind::kNotYours:
      return {grpc::StatusCode::PERMISSION_DENIED, error.message};
    case JobErrorKind::kFull:
      return {grpc::StatusCode::RESOURCE_EXHAUSTED, error.message};
    case JobErrorKind::kNonsense:
      break;
  }
  return {grpc::StatusCode::INVALID_ARGUMENT, error.message};
}

class JobsService final : public wire::Jobs::Service {
 public:
  JobsService(JobQueue& queue, Spool& spool, std::function<void(const std::string& peer)> on_call)
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
  /// Common checks at the beginning of every call. Error: the peer has another version.
  template <typename Request>
  grpc::Status begin(const grpc::ServerContext& context, const Request& request) const;

  JobQueue& queue_;
  Spool& spool_;
  const std::function<void(const std::string&)> on_call_;
};

template <typename Request>
grpc::Status JobsService::begin(const grpc::ServerContext& context, const Request& request) const {
  if (on_call_) on_call_(context.peer());
  const std::string mismatch = version_mismatch(request.protocol_version(), "client");
  return mismatch.empty() ? grpc::Status::OK : grpc::Status(grpc::StatusCode::FAILED_PRECONDITION, mismatch);
}

grpc::Status JobsService::HasScene(grpc::ServerContext* context, const wire::HasSceneRequest* request,
                                   wire::HasSceneReply* reply) {
  if (grpc::Status begun = begin(*context, *request); !begun.ok()) return begun;
  reply->set_known(queue_.has_scene(request->hash()));
  return grpc::Status::OK;
}

grpc::Status JobsService::PutScene(grpc::ServerContext* context, grpc::ServerReader<wire::SceneChunk>* reader,
                                   wire::PutSceneReply*) {
  wire::SceneChunk chunk;
  if (!reader->Read(&chunk)) return {grpc::StatusCode::INVALID_ARGUMENT, "a scene without any data"};
  if (grpc::Status begun = begin(*context, chunk); !begun.ok()) return begun;
  const std::string hash = chunk.hash();
  if (!chunk.base().empty() && !queue_.has_scene(chunk.base()))
    return {grpc::StatusCode::NOT_FOUND, "the base of this scene is not here (any more)"};
  auto scene = spool_.receive_scene(hash, chunk.base());
  if (!scene) {
    // The base may have been removed just now.
    const bool is_gone = !chunk.base().empty() && !spool_.has_scene(chunk.base());
    return {is_gone ? grpc::StatusCode::NOT_FOUND : grpc::StatusCode::INVALID_ARGUMENT,
            scene.error().message};
  }
  do {
    const auto added = chunk.copy_bytes() > 0 ? scene->add_of_base(chunk.copy_from(), chunk.copy_bytes())
                                              : scene->add(bytes_of(chunk.data()));
    if (!added) return {grpc::StatusCode::RESOURCE_EXHAUSTED, added.error().message};
  } while (reader->Read(&chunk));
  if (context->IsCancelled()) return grpc::Status::CANCELLED;
  queue_.scene_came(hash);  // before it is stored, so that a job that ends does not remove it as unused
  if (const auto finished = scene->finish(); !finished)
    return {grpc::StatusCode::INVALID_ARGUMENT, finished.error().message};
  return grpc::Status::OK;
}

grpc::Status JobsService::Submit(grpc::ServerContext* context, const wire::SubmitRequest* request,
                                 wire::SubmitReply* reply) {
  if (grpc::Status begun = begin(*context, *request); !begun.ok()) return begun;
  const auto job = queue_.submit(request->submission());
  if (!job) return status_of(job.error());
  reply->set_job(job->job);
  reply->set_group(job->group);
  return grpc::Status::OK;
}

grpc::Status JobsService::Status(grpc::ServerContext* context, const wire::StatusRequest* request,
                                 wire::StatusReply* reply) {
  if (grpc::Status begun = begin(*context, *request); !begun.ok()) return begun;
  auto status = queue_.status({request->jobs().begin(), request->jobs().end()});
  if (!status) return status_of(status.error());
  *reply = std::move(*status);
  return grpc::Status::OK;
}

grpc::Status JobsService::Change(grpc::ServerContext* context, const wire::ChangeRequest* request,
                                 wire::ChangeReply*) {
  if (grpc::Status begun = begin(*context, *request); !begun.ok()) return begun;
  for (const JobId job : request->jobs()) {
    JobExpected<void> changed;
    switch (request->change_case()) {
      case wire::ChangeRequest::kCancel:
        changed = queue_.cancel(job, request->owner());
        break;
      case wire::ChangeRequest::kPriority:
        changed = queue_.set_priority(job, request->priority(), request->owner());
        break;
      case wire::ChangeRequest::kRemove:
        changed = queue_.remove(job, request->owner());
        break;
      case wire::ChangeRequest::kRetry:
        changed = queue_.retry(job, request->owner());
        break;
      case wire::ChangeRequest::kWhole:
        changed = queue_.close_group(job, request->owner());
        break;
      case wire::ChangeRequest::CHANGE_NOT_SET:
        return {grpc::StatusCode::INVALID_ARGUMENT, "a change that this service does not know"};
    }
    if (!changed) return status_of(changed.error());
  }
  return grpc::Status::OK;
}

grpc::Status JobsService::Fetch(grpc::ServerContext* context, const wire::FetchRequest* request,
                                grpc::ServerWriter<wire::FetchChunk>* writer) {
  if (grpc::Status begun = begin(*context, *request); !begun.ok()) return begun;
  const auto path = queue_.file(request->job(), request->name());
  if (!path) return status_of(path.error());
  std::ifstream file(*path, std::ios::binary);
  wire::FetchChunk chunk;
  std::string part(kAssetChunkBytes, '\0');
  while (file.read(part.data(), std::streamsize(part.size())), file.gcount() > 0) {
    chunk.set_data(part.data(), std::size_t(file.gcount()));
    if (!writer->Write(chunk)) return grpc::Status::CANCELLED;
  }
  if (!file.eof())
    return {grpc::StatusCode::DATA_LOSS, fmt::format("the file '{}' cannot be read", request->name())};
  return grpc::Status::OK;
}

}  // namespace

std::shared_ptr<grpc::Service> make_jobs_service(JobQueue& queue, Spool& spool,
                                                 std::function<void(const std::string& peer)> on_call) {
  return std::make_shared<JobsService>(queue, spool, std::move(on_call));
}

}  // namespace penumbra
