#include "scheduler/service/group_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "scheduler/render/frames.h"
#include "scheduler/service/job_queue.h"
#include "scheduler/service/status_text.h"

namespace penumbra {
namespace {

double share(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? std::min(1.0, double(part) / double(whole)) : 0.0;
}

wire::JobState state_of(const GroupSummary& summary) {
  const auto count = [&](wire::JobState state) { return summary.jobs[std::size_t(state)]; };
  if (count(wire::JOB_RENDERING) > 0) return wire::JOB_RENDERING;
  if (count(wire::JOB_QUEUED) == summary.group.size()) return wire::JOB_QUEUED;
  if (count(wire::JOB_QUEUED) > 0) return wire::JOB_RENDERING;
  for (const wire::JobState state : {wire::JOB_FAILED, wire::JOB_CANCELLED, wire::JOB_INCOMPLETE})
    if (count(state) > 0) return state;
  return wire::JOB_DONE;
}

}  // namespace

RenderProgress progress_of(const wire::JobStatus& job) {
  return {.samples_done = job.samples_done(),
          .samples_total = job.samples_total(),
          .samples_before = job.samples_before(),
          .elapsed_seconds = job.elapsed_seconds(),
          .relative_error = job.relative_error(),
          .workers = int(job.workers())};
}

void add_frame(const wire::JobStatus& job, FramesByState& frames) {
  if (job.has_frame()) frames[std::size_t(job.state())].push_back(job.frame());
}

std::string frame_states_text(const FramesByState& frames) {
  std::string text;
  for (const wire::JobState state : {wire::JOB_DONE, wire::JOB_RENDERING, wire::JOB_INCOMPLETE,
                                     wire::JOB_FAILED, wire::JOB_CANCELLED, wire::JOB_QUEUED})
    if (const std::vector<int>& of_state = frames[std::size_t(state)]; !of_state.empty())
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", frames_text(of_state), job_state_name(state));
  return text;
}

std::vector<GroupSummary> group_summaries(const wire::StatusReply& status) {
  struct Work {
    double seconds = 0, done = 0, left = 0;  // work is in units of whole jobs
    std::uint32_t jobs = 0;
  };
  std::map<JobId, GroupSummary> summaries;
  std::map<JobId, Work> works;
  for (const wire::JobGroup& group : status.groups()) summaries[group.number()].group = group;
  for (const wire::JobStatus& job : status.jobs()) {
    const auto found = summaries.find(job.group());
    if (found == summaries.end()) continue;
    GroupSummary& summary = found->second;
    Work& work = works[job.group()];
    const bool is_first = work.jobs++ == 0;
    summary.submitter = job.submitter();
    summary.priority = is_first ? job.priority() : std::max(summary.priority, job.priority());
    ++summary.jobs[std::size_t(job.state())];
    add_frame(job, summary.frames);
    summary.samples_done += job.samples_done();
    summary.samples_total += job.samples_total();
    summary.submitted = is_first ? job.submitted() : std::min(summary.submitted, job.submitted());
    if (job.begun() > 0)
      summary.begun = summary.begun > 0 ? std::min(summary.begun, job.begun()) : job.begun();
    summary.ended = std::max(summary.ended, job.ended());
    const double done = is_over(job) ? 1 : share(job.samples_done(), job.samples_total());
    summary.done += done;
    work.left += 1 - done;
    work.seconds += job.elapsed_seconds();
    work.done += share(job.samples_done() - job.samples_before(), job.samples_total());
  }
  std::vector<GroupSummary> result;
  for (auto& [number, summary] : summaries) {
    const Work& work = works[number];
    for (std::vector<int>& frames : summary.frames) std::ranges::sort(frames);
    const std::uint32_t to_come = std::max(summary.group.size(), work.jobs) - work.jobs;
    summary.group.set_size(work.jobs + to_come);
    summary.jobs[wire::JOB_QUEUED] += to_come;
    summary.done /= std::max(1u, summary.group.size());
    summary.state = state_of(summary);
    const double left = work.left + to_come;
    if (left == 0)
      summary.seconds_left = 0;
    else if (work.done > 0 && work.seconds > 0)
      summary.seconds_left = work.seconds / work.done * left;
    if (left > 0) summary.ended = 0;
    result.push_back(std::move(summary));
  }
  return result;
}

}  // namespace penumbra
