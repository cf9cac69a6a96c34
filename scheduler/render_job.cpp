#include "scheduler/render_job.h"

#include "scheduler/render_job_check.h"
#include "scheduler/render_run.h"

namespace penumbra {

Expected<RenderOutcome> run_render(const RenderJob& job, const std::atomic<bool>& stop,
                                   const std::function<void(const RenderProgress&)>& on_progress) {
  if (const Expected<void> checked = check_render_job(job); !checked) return std::unexpected(checked.error());
  return RenderRun(job, stop, on_progress).run();
}

}  // namespace penumbra
