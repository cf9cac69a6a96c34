#include "scheduler/farm/render_job.h"

#include <grpc/grpc.h>

#include "scheduler/farm/render_job_check.h"
#include "scheduler/farm/render_run.h"

namespace penumbra {

Expected<RenderOutcome> run_render(const RenderJob& job, const std::atomic<bool>& stop,
                                   const std::function<void(const RenderProgress&)>& on_progress) {
  if (const Expected<void> checked = check_render_job(job); !checked) return std::unexpected(checked.error());
  // For good: gRPC's end may wait ten seconds for a poll that is under way.
  static const bool kept = (grpc_init(), true);
  (void)kept;
  return RenderRun(job, stop, on_progress).run();
}

}  // namespace penumbra
