// The service's implementation of the calls of jobs.proto.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "scheduler/service/job_queue.h"
#include "scheduler/service/spool.h"

namespace grpc {
class Service;
}

namespace penumbra {

/// Makes the service. `queue` and `spool` must outlive it. `on_call` is called with the peer of each call,
/// after its token (if one is required) has been checked.
std::shared_ptr<grpc::Service> make_jobs_service(JobQueue& queue, Spool& spool,
                                                 std::function<void(const std::string& peer)> on_call = {});

}  // namespace penumbra
