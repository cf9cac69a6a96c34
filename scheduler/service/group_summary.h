// What the jobs of a group amount to.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "jobs.pb.h"
#include "scheduler/farm/render_job.h"
#include "worker/protocol/wire.h"

namespace penumbra {

RenderProgress progress_of(const wire::JobStatus& job);

/// Frames of a shot by the states of their jobs.
using FramesByState = std::array<std::vector<int>, wire::JobState_ARRAYSIZE>;
void add_frame(const wire::JobStatus& job, FramesByState& frames);
/// "1-6,8-12 done, 13-14 rendering, 7 failed, 15-48 queued"; see frames_text.
std::string frame_states_text(const FramesByState& frames);

/// The jobs of one `penumbra submit`. Times are seconds since 1970; 0: not yet.
struct GroupSummary {
  wire::JobGroup group;  ///< its `size` counts also jobs that are still to be submitted
  std::string submitter;
  /// Rendering if a part of it is over or being rendered. Once all jobs are over, failed if one failed, else
  /// cancelled, else incomplete if one is.
  wire::JobState state = wire::JOB_QUEUED;
  int priority = 0;                                            ///< the highest of its jobs
  std::array<std::uint32_t, wire::JobState_ARRAYSIZE> jobs{};  ///< how many are in each state
  FramesByState frames = {};                                   ///< of a shot, ascending
  std::uint64_t samples_done = 0, samples_total = 0;           ///< of the jobs whose samples are known
  double done = 0;  ///< its finished part, from 0 to 1; all jobs count alike
  /// If the rest of its jobs take as long as those so far, and nothing else is rendered meanwhile.
  std::optional<double> seconds_left;
  double submitted = 0, begun = 0, ended = 0;
};

/// A summary of each group of the reply, in the order of their numbers.
std::vector<GroupSummary> group_summaries(const wire::StatusReply& status);

}  // namespace penumbra
