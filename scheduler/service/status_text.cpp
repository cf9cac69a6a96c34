#include "scheduler/service/status_text.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "kernels/host/console.h"
#include "kernels/host/text.h"
#include "scheduler/files/json_number.h"
#include "scheduler/render/frames.h"
#include "scheduler/run/progress.h"
#include "scheduler/service/group_summary.h"

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kWidthOfState = 11;

/// The description of a job beside its name.
std::string detail(const wire::JobStatus& job, double now) {
  switch (job.state()) {
    case wire::JOB_QUEUED:
      return fmt::format("since {}{}", clock_text(now - job.submitted()),
                         job.after_size() > 0 ? fmt::format(", after {}", fmt::join(job.after(), ", ")) : "");
    case wire::JOB_RENDERING:
      return progress_text(progress_of(job));
    case wire::JOB_DONE: {
      const std::string error = std::isfinite(job.relative_error())
                                    ? fmt::format(", error {:.2g}%", 100 * job.relative_error())
                                    : "";
      return fmt::format("in {}{}, {} ago", clock_text(job.begun() > 0 ? job.ended() - job.begun() : 0),
                         error, clock_text(now - job.ended()));
    }
    default:
      return job.error().substr(0, job.error().find('\n'));
  }
}

std::string line_of(JobId number, wire::JobState state, int priority, const std::string& name,
                    const std::string& detail) {
  return fmt::format("{:>6}  {:<{}} {:>4}  {}  {}", number, job_state_name(state), kWidthOfState, priority,
                     name, detail);
}

/// "3 of 24 done, 1 failed", or of a shot "frames 1-24: 1-3 done, 4 failed, 5-24 queued"
std::string states_text(const GroupSummary& group) {
  std::vector<int> frames;
  for (const std::vector<int>& of_state : group.frames)
    frames.insert(frames.end(), of_state.begin(), of_state.end());
  if (!frames.empty())
    return fmt::format("frames {}: {}", frames_text(std::move(frames)), frame_states_text(group.frames));
  std::string text = fmt::format("{} of {} done", group.jobs[wire::JOB_DONE], group.group.size());
  for (const wire::JobState state : {wire::JOB_INCOMPLETE, wire::JOB_FAILED, wire::JOB_CANCELLED})
    if (const std::uint32_t count = group.jobs[std::size_t(state)]; count > 0)
      text += fmt::format(", {} {}", count, job_state_name(state));
  return text;
}

/// "3 of 24 done, 1 failed   42%  12:10 left"
std::string detail(const GroupSummary& group, double now) {
  std::string text = states_text(group);
  if (group.ended > 0)
    return text + fmt::format(", in {}, {} ago", clock_text(group.begun > 0 ? group.ended - group.begun : 0),
                              clock_text(now - group.ended));
  text += fmt::format("  {}%", int(std::floor(100 * group.done)));
  if (group.seconds_left) text += fmt::format("  {} left", clock_text(*group.seconds_left));
  return text;
}

/// Lines about groups, and about jobs outside of groups or, `unfolded`, about all.
std::vector<std::string> job_lines(const wire::StatusReply& status, bool unfolded) {
  using Key = JobInterest;
  std::map<Key, std::vector<std::string>> lines;
  std::map<JobId, std::map<Key, std::string>> jobs_of_groups;
  const std::vector<GroupSummary> groups = group_summaries(status);
  const bool several = std::ranges::any_of(status.jobs(), [&](const wire::JobStatus& job) {
    return job.submitter() != status.jobs(0).submitter();
  });
  const auto name_of = [several](const std::string& name, const std::string& submitter) {
    return several && !submitter.empty() ? fmt::format("{} ({})", name, submitter) : name;
  };
  for (const wire::JobStatus& job : status.jobs()) {
    const Key key = job_interest(job.state(), job.priority(), job.ended(), job.job());
    const std::string line = line_of(job.job(), job.state(), job.priority(),
                                     name_of(job.name(), job.submitter()), detail(job, status.now()));
    if (std::ranges::binary_search(groups, job.group(), {},
                                   [](const GroupSummary& group) { return group.group.number(); }))
      jobs_of_groups[job.group()][key] = line;
    else
      lines[key] = {line};
  }
  for (const GroupSummary& group : groups) {
    const JobId number = group.group.number();
    auto& of_group = lines[job_interest(group.state, group.priority, group.ended, number)];
    of_group = {line_of(number, group.state, group.priority, name_of(group.group.name(), group.submitter),
                        detail(group, status.now()))};
    if (unfolded)
      for (const auto& [key, line] : jobs_of_groups[number]) of_group.push_back("  " + line);
  }
  std::vector<std::string> all;
  for (auto& [key, of_key] : lines) std::ranges::move(of_key, std::back_inserter(all));
  return all;
}

std::string worker_line(const wire::FarmWorker& worker) {
  const double rate = worker.busy_seconds() > 0 ? double(worker.samples()) / worker.busy_seconds() : 0;
  const std::string job = worker.job() > 0 ? fmt::format("job {}", worker.job()) : "idle";
  return fmt::format("{:>6}  {:<{}} {}  {}, {:.2f} Msamples/s while busy, here for {}  {}", worker.number(),
                     job, kWidthOfState, worker.name(), counted(worker.units(), "unit"), rate * 1e-6,
                     clock_text(worker.since_seconds()), worker.device());
}

Json number_or_null(double value) { return value > 0 ? json_number(value) : Json(nullptr); }

Json json_or_null(std::optional<double> value) { return value ? json_number(*value) : Json(nullptr); }

Json frames_json(const FramesByState& frames) {
  if (std::ranges::all_of(frames, [](const std::vector<int>& of_state) { return of_state.empty(); }))
    return nullptr;
  Json json;
  for (int state = 0; state < int(frames.size()); ++state)
    json[std::string(job_state_name(wire::JobState(state)))] = frames[std::size_t(state)];
  return json;
}

Json group_json(const GroupSummary& group) {
  Json jobs;
  for (int state = 0; state < int(group.jobs.size()); ++state)
    jobs[std::string(job_state_name(wire::JobState(state)))] = group.jobs[std::size_t(state)];
  return {{"group", group.group.number()},
          {"name", group.group.name()},
          {"state", job_state_name(group.state)},
          {"priority", group.priority},
          {"submitter", group.submitter},
          {"size", group.group.size()},
          {"jobs", jobs},
          {"frames", frames_json(group.frames)},
          {"samples_done", group.samples_done},
          {"samples_total", group.samples_total},
          {"done", group.done},
          {"seconds_left", json_or_null(group.seconds_left)},
          {"submitted", number_or_null(group.submitted)},
          {"begun", number_or_null(group.begun)},
          {"ended", number_or_null(group.ended)}};
}

Json job_json(const wire::JobStatus& job) {
  Json files = Json::array();
  for (const wire::StoredFile& file : job.files())
    files.push_back({{"name", file.name()}, {"bytes", file.bytes()}});
  return {{"job", job.job()},
          {"name", job.name()},
          {"state", job_state_name(job.state())},
          {"priority", job.priority()},
          {"error", job.error().empty() ? Json(nullptr) : Json(job.error())},
          {"submitted", number_or_null(job.submitted())},
          {"begun", number_or_null(job.begun())},
          {"ended", number_or_null(job.ended())},
          {"samples_done", job.samples_done()},
          {"samples_total", job.samples_total()},
          {"samples_before", job.samples_before()},
          {"elapsed_seconds", json_number(job.elapsed_seconds())},
          {"relative_error", json_number(job.relative_error())},
          {"seconds_left",
           json_or_null(job.state() == wire::JOB_RENDERING ? seconds_left(progress_of(job)) : std::nullopt)},
          {"group", job.group() > 0 ? Json(job.group()) : Json(nullptr)},
          {"frame", job.has_frame() ? Json(job.frame()) : Json(nullptr)},
          {"submitter", job.submitter()},
          {"after", std::vector<JobId>(job.after().begin(), job.after().end())},
          {"folder", job.folder()},
          {"files", files},
          {"problems", std::vector<std::string>(job.problems().begin(), job.problems().end())}};
}

}  // namespace

JobInterest job_interest(wire::JobState state, int priority, double ended, JobId number) {
  const int bucket = state == wire::JOB_RENDERING ? 0 : state == wire::JOB_QUEUED ? 1 : 2;
  return {bucket, bucket == 2 ? 0 : -priority, bucket == 2 ? -ended : 0.0, number};
}

std::string_view job_state_name(wire::JobState state) {
  switch (state) {
    case wire::JOB_QUEUED:
      return "queued";
    case wire::JOB_RENDERING:
      return "rendering";
    case wire::JOB_DONE:
      return "done";
    case wire::JOB_INCOMPLETE:
      return "incomplete";
    case wire::JOB_FAILED:
      return "failed";
    case wire::JOB_CANCELLED:
      return "cancelled";
    default:
      return "unknown";
  }
}

std::string fitted_line(std::string_view text, int columns) {
  std::string visible = visible_text(text);
  std::ranges::replace_if(
      visible, [](char c) { return c == '\n' || c == '\t'; }, ' ');
  std::size_t bytes = 0;
  int characters = 0;
  while (bytes < visible.size()) {
    const std::size_t begin = bytes++;
    while (bytes < visible.size() && (static_cast<unsigned char>(visible[bytes]) & 0xC0u) == 0x80u) ++bytes;
    if (++characters > columns) return visible.substr(0, begin);
  }
  return visible;
}

std::vector<std::string> status_lines(const wire::StatusReply& status, int columns, int rows, bool unfolded) {
  const auto count = [&](wire::JobState state) {
    return std::ranges::count_if(status.jobs(), [&](const auto& job) { return job.state() == state; });
  };
  std::vector<std::string> lines;
  lines.push_back(fmt::format("penumbra {}, up {}: {}, {} rendering, {} queued, {}", status.version(),
                              clock_text(status.up_seconds()), counted(status.jobs_size(), "job"),
                              count(wire::JOB_RENDERING), count(wire::JOB_QUEUED),
                              counted(status.workers_size(), "worker")));
  std::vector<std::string> workers;
  for (const wire::FarmWorker& worker : status.workers()) workers.push_back(worker_line(worker));
  // Workers get at most half of the room.
  const int room = std::max(0, rows - 4), for_workers = std::min(int(workers.size()), std::max(1, room / 2));
  const std::vector<std::string> jobs = job_lines(status, unfolded);
  const int for_jobs = std::clamp(room - for_workers, 0, int(jobs.size()));
  if (!jobs.empty())
    lines.push_back(fmt::format("{:>6}  {:<{}} {:>4}  ", "job", "state", kWidthOfState, "prio"));
  std::copy_n(jobs.begin(), for_jobs, std::back_inserter(lines));
  if (for_jobs < int(jobs.size()))
    lines.push_back(fmt::format("        {} more", int(jobs.size()) - for_jobs));
  if (!workers.empty()) lines.push_back("worker");
  for (int i = 0; i < for_workers; ++i) lines.push_back(workers[std::size_t(i)]);
  if (for_workers < int(workers.size()))
    lines.push_back(fmt::format("        {} more", int(workers.size()) - for_workers));
  for (std::string& line : lines) line = fitted_line(line, columns);
  if (int(lines.size()) > rows) lines.resize(std::size_t(std::max(0, rows)));
  return lines;
}

Json groups_json(const wire::StatusReply& status) {
  Json groups = Json::array();
  for (const GroupSummary& group : group_summaries(status)) groups.push_back(group_json(group));
  return groups;
}

Json status_json(const wire::StatusReply& status) {
  Json jobs = Json::array(), workers = Json::array();
  for (const wire::JobStatus& job : status.jobs()) jobs.push_back(job_json(job));
  for (const wire::FarmWorker& worker : status.workers())
    workers.push_back({{"worker", worker.number()},
                       {"name", worker.name()},
                       {"device", worker.device()},
                       {"units", worker.units()},
                       {"samples", worker.samples()},
                       {"busy_seconds", json_number(worker.busy_seconds())},
                       {"job", worker.job() > 0 ? Json(worker.job()) : Json(nullptr)},
                       {"since_seconds", json_number(worker.since_seconds())}});
  return {{"penumbra", status.version()},
          {"up_seconds", status.up_seconds()},
          {"now", status.now()},
          {"groups", groups_json(status)},
          {"jobs", jobs},
          {"workers", workers},
          {"messages", std::vector<std::string>(status.messages().begin(), status.messages().end())}};
}

}  // namespace penumbra
