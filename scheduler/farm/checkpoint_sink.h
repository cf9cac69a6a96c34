// The interface for storing a job's merged state, so that another process can resume it.
#pragma once

#include <optional>
#include <string>

#include "scheduler/plan/merge.h"
#include "scheduler/plan/plan_messages.h"

namespace penumbra {

constexpr Seconds kCheckpointInterval = 5;  ///< default interval

/// Called from the farm's thread. It must return after no more time than copying the state takes.
class CheckpointSink {
 public:
  virtual ~CheckpointSink() = default;

  /// Whether a checkpoint is due.
  [[nodiscard]] virtual bool is_due(const Merge& merge) = 0;
  /// Stores a checkpoint of the merged state and the render time so far. Results merged later are not part of
  /// it.
  virtual void keep(const Merge& merge, Seconds rendered) = 0;
  /// Stores a last checkpoint of a job that ends unfinished, whether or not one is due.
  virtual void keep_last(const Merge& merge, Seconds rendered) = 0;
  /// Removes the checkpoint because it is not trustworthy or no longer needed.
  virtual void remove() = 0;
  /// A problem with storing; each is returned once.
  [[nodiscard]] virtual std::optional<std::string> take_problem() = 0;
};

/// The state of a job that an earlier process merged.
struct ResumedState {
  Merge merge;  ///< with the job's film and grid; see merge_of_job
  Seconds rendered = 0;
};

}  // namespace penumbra
