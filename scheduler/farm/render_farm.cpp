#include "scheduler/farm/render_farm.h"

#include <absl/synchronization/mutex.h>

#include <fmt/format.h>

#include <utility>

#include "scheduler/farm/farm_run.h"
#include "scheduler/farm/render_job_check.h"
#include "worker/protocol/grpc_log.h"

namespace penumbra {
namespace {

class SingleJob final : public JobSource {
 public:
  SingleJob(const RenderJob& job, const std::function<void(const RenderProgress&)>& on_progress)
      // Without ownership, because the caller waits in run_render.
      : job_(std::shared_ptr<const RenderJob>(), &job), on_progress_(on_progress) {}

  std::shared_ptr<const RenderJob> next() override { return std::exchange(job_, nullptr); }
  bool is_exhausted() override { return job_ == nullptr; }
  void progress(JobId, const RenderProgress& progress) override {
    if (!on_progress_) return;
    RenderProgress with_notices = progress;
    with_notices.notices.insert(with_notices.notices.begin(), notices_.begin(), notices_.end());
    notices_.clear();
    on_progress_(with_notices);
  }
  void notice(const std::string& text) override { notices_.push_back(text); }
  void done(JobId, Expected<RenderOutcome> outcome) override { outcome_ = std::move(outcome); }

  Expected<RenderOutcome> take_outcome() && { return std::move(outcome_); }

 private:
  std::shared_ptr<const RenderJob> job_;
  const std::function<void(const RenderProgress&)>& on_progress_;
  std::vector<std::string> notices_;
  Expected<RenderOutcome> outcome_ = fail("the render was not begun");
};

}  // namespace

Expected<void> run_farm(const FarmOptions& options, JobSource& source, const std::atomic<bool>& stop) {
  if (options.workers < (options.listen.empty() ? 1 : 0))
    return fail(fmt::format("{} workers; at least 1 is needed", options.workers));
  keep_grpc_running();
  // In Debian's build of absl, gRPC's mutexes detect deadlocks, which takes a tenth of its time.
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
  return FarmRun(options, source, stop).run();
}

Expected<RenderOutcome> run_render(const RenderJob& job, const FarmOptions& options,
                                   const std::atomic<bool>& stop,
                                   const std::function<void(const RenderProgress&)>& on_progress) {
  if (const Expected<void> checked = check_render_job(job); !checked) return std::unexpected(checked.error());
  SingleJob source(job, on_progress);
  if (const Expected<void> ran = run_farm(options, source, stop); !ran) return std::unexpected(ran.error());
  return std::move(source).take_outcome();
}

}  // namespace penumbra
