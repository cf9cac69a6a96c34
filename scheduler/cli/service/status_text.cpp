#include "scheduler/cli/service/status_text.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "kernels/host/console.h"
#include "kernels/host/text.h"
#include "scheduler/cli/progress.h"
#include "scheduler/files/json_number.h"

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kWidthOfState = 11;

RenderProgress progress_of(const wire::JobStatus& job) {
  return {.samples_done = job.samples_done(),
          .samples_total = job.samples_total(),
          .samples_before = job.samples_before(),
          .elapsed_seconds = job.elapsed_seconds(),
          .relative_error = job.relative_error(),
          .workers = int(job.workers())};
}

/// The description of a job beside its name.
std::string detail(const wire::JobStatus& job, double now) {
  switch (job.state()) {
    case wire::JOB_QUEUED:
      return fmt::format("since {}", clock_text(now - job.submitted()));
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

/// The jobs being rendered, then those waiting in the order in which they will be rendered, then those that
/// ended last.
std::vector<const wire::JobStatus*> by_interest(const wire::StatusReply& status) {
  std::vector<const wire::JobStatus*> jobs;
  for (const wire::JobStatus& job : status.jobs()) jobs.push_back(&job);
  const auto key = [](const wire::JobStatus* job) {
    const int group = job->state() == wire::JOB_RENDERING ? 0 : job->state() == wire::JOB_QUEUED ? 1 : 2;
    return std::tuple(group, group == 2 ? 0 : -job->priority(), group == 2 ? -job->ended() : 0.0, job->job());
  };
  std::ranges::sort(jobs, {}, key);
  return jobs;
}

std::string job_line(const wire::JobStatus& job, double now) {
  return fmt::format("{:>6}  {:<{}} {:>4}  {}  {}", job.job(), job_state_name(job.state()), kWidthOfState,
                     job.priority(), job.name(), detail(job, now));
}

std::string worker_line(const wire::FarmWorker& worker) {
  const double rate = worker.busy_seconds() > 0 ? double(worker.samples()) / worker.busy_seconds() : 0;
  const std::string job = worker.job() > 0 ? fmt::format("job {}", worker.job()) : "idle";
  return fmt::format("{:>6}  {:<{}} {}  {}, {:.2f} Msamples/s while busy, here for {}  {}", worker.number(),
                     job, kWidthOfState, worker.name(), counted(worker.units(), "unit"), rate * 1e-6,
                     clock_text(worker.since_seconds()), worker.device());
}

Json number_or_null(double value) { return value > 0 ? json_number(value) : Json(nullptr); }

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
          {"files", files},
          {"problems", std::vector<std::string>(job.problems().begin(), job.problems().end())}};
}

}  // namespace

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

std::vector<std::string> status_lines(const wire::StatusReply& status, int columns, int rows) {
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
  const std::vector<const wire::JobStatus*> jobs = by_interest(status);
  const int for_jobs = std::clamp(room - for_workers, 0, int(jobs.size()));
  if (!jobs.empty())
    lines.push_back(fmt::format("{:>6}  {:<{}} {:>4}  ", "job", "state", kWidthOfState, "prio"));
  for (int i = 0; i < for_jobs; ++i) lines.push_back(job_line(*jobs[std::size_t(i)], status.now()));
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
          {"jobs", jobs},
          {"workers", workers},
          {"messages", std::vector<std::string>(status.messages().begin(), status.messages().end())}};
}

}  // namespace penumbra
