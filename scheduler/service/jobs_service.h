// The calls of jobs.proto, as a service answers them.
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

/// Its answers; both must outlive it. `on_call` is called with the peer of each call, after the token has
/// been checked where one is required.
std::shared_ptr<grpc::Service> make_jobs_service(JobQueue& queue, Spool& spool,
                                                 std::function<void(const std::string& peer)> on_call = {});

}  // namespace penumbra
