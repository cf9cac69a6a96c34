// Where what is merged of a job is kept, so that another process can go on with it.
#pragma once

#include <optional>
#include <string>

#include "scheduler/plan/merge.h"
#include "scheduler/plan/plan_messages.h"

namespace penumbra {

constexpr Seconds kCheckpointInterval = 5;  ///< where nothing else is asked for

/// Called from the farm's thread, which it keeps no longer than a copy takes.
class CheckpointSink {
 public:
  virtual ~CheckpointSink() = default;

  /// Whether it is time to keep what is merged.
  [[nodiscard]] virtual bool is_due(const Merge& merge) = 0;
  /// Keeps it, and how long has been rendered for it; what is merged meanwhile has no part in that.
  virtual void keep(const Merge& merge, Seconds rendered) = 0;
  /// The job ends unfinished: likewise, whether it is time or not.
  virtual void keep_last(const Merge& merge, Seconds rendered) = 0;
  /// What was kept is not to be trusted, or not needed any longer.
  virtual void remove() = 0;
  /// Why it could not be kept, once.
  [[nodiscard]] virtual std::optional<std::string> take_problem() = 0;
};

/// What an earlier process has merged of a job.
struct ResumedState {
  Merge merge;  ///< of the job's film and grid, see merge_of_job
  Seconds rendered = 0;
};

}  // namespace penumbra
