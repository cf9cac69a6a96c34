#include "scheduler/cli/service/chosen_jobs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <set>

#include "scenes/number.h"
#include "scheduler/render/frames.h"
#include "scheduler/render/option_checks.h"
#include "scheduler/service/group_summary.h"

namespace penumbra {
namespace {

constexpr std::int64_t kLastNumber = std::numeric_limits<JobId>::max();

std::optional<JobId> number_of(std::string_view text) {
  const auto number = parse_integer(text, 1, kLastNumber);
  return number ? std::optional(JobId(*number)) : std::nullopt;
}

/// The jobs and groups from FIRST to LAST; a group stands for its jobs.
Expected<std::vector<JobId>> of_range(const std::string& text, JobId first, JobId last,
                                      const wire::StatusReply& status) {
  std::vector<JobId> numbers;
  const auto is_within = [&](JobId number) { return number >= first && number <= last; };
  for (const wire::JobGroup& group : status.groups())
    if (is_within(group.number())) numbers.push_back(group.number());
  for (const wire::JobStatus& job : status.jobs())
    if (is_within(job.job()) && !(job.group() > 0 && is_within(job.group()))) numbers.push_back(job.job());
  std::ranges::sort(numbers);
  if (numbers.empty()) return fail(fmt::format("there is no job from {} to {} ('{}')", first, last, text));
  return numbers;
}

Expected<std::vector<JobId>> of_name(const std::string& name, const wire::StatusReply& status) {
  std::vector<JobId> numbers;
  for (const wire::JobGroup& group : status.groups())
    if (group.name() == name) numbers.push_back(group.number());
  if (numbers.empty())
    return fail(fmt::format(
        "there is no group '{}'; name jobs and groups by their numbers, as in 14 or 14-19", name));
  if (numbers.size() > 1)
    return fail(fmt::format("the groups {} are all called '{}'; give the number of one",
                            fmt::join(numbers, ", "), name));
  return numbers;
}

}  // namespace

Option* add_jobs(CommandLine& command, std::vector<std::string>& jobs) {
  return command
      .add_option(
          "JOB", jobs,
          "Numbers of jobs or groups, as `penumbra submit` and `penumbra status` print them; ranges as in "
          "14-19; names of groups")
      ->type_name("JOB")
      ->check(some_text())
      ->group("Jobs");
}

Option* add_frames(CommandLine& command, std::string& frames) {
  return command.add_option("--frames", frames, "Only these frames of shots, as in 80-95 or 1-250x2")
      ->type_name("LIST")
      ->check({[](const std::string& text) {
                 const auto list = frames_of(text);
                 return list ? std::string() : list.error().message;
               },
               ""})
      ->group("Jobs");
}

Expected<std::vector<JobId>> jobs_of_frames(const std::vector<JobId>& numbers, const std::string& frames,
                                            JobsClient& service,
                                            const std::function<bool(const wire::JobStatus&)>& is_meant) {
  const auto texts = frames_of(frames);
  if (!texts) return std::unexpected(texts.error());
  std::set<int> asked;
  for (const std::string& text : *texts) asked.insert(int(*parse_integer(text, 0, kLastFrame)));
  std::vector<JobId> jobs;
  for (const JobId number : numbers) {
    const auto status = service.status({number});
    if (!status) return std::unexpected(status.error());
    const std::string what = fmt::format("{} {}", status->groups_size() > 0 ? "group" : "job", number);
    std::set<int> present;
    FramesByState chosen;
    const std::size_t before = jobs.size();
    for (const wire::JobStatus& job : status->jobs()) {
      if (!job.has_frame()) continue;
      present.insert(job.frame());
      if (!asked.contains(job.frame())) continue;
      add_frame(job, chosen);
      if (is_meant(job)) jobs.push_back(job.job());
    }
    if (present.empty()) return fail(fmt::format("{} has no frames: it is no shot", what));
    std::vector<int> missing;
    std::ranges::set_difference(asked, present, std::back_inserter(missing));
    if (!missing.empty())
      return fail(fmt::format("{} has no {} {}; it has {}", what, missing.size() == 1 ? "frame" : "frames",
                              frames_text(std::move(missing)),
                              frames_text({present.begin(), present.end()})));
    if (jobs.size() == before)
      return fail(fmt::format("nothing to do for these frames of {}: {}", what, frame_states_text(chosen)));
  }
  return jobs;
}

Expected<std::vector<JobId>> numbers_of(const std::vector<std::string>& jobs, JobsClient& service) {
  std::optional<wire::StatusReply> status;
  std::vector<JobId> numbers;
  for (const std::string& text : jobs) {
    if (const auto number = number_of(text)) {
      numbers.push_back(*number);
      continue;
    }
    if (!status) {
      auto reply = service.status({});
      if (!reply) return std::unexpected(reply.error());
      status = std::move(*reply);
    }
    const std::size_t dash = text.find('-');
    const auto first = number_of(std::string_view(text).substr(0, dash));
    const auto last =
        dash == std::string::npos ? std::nullopt : number_of(std::string_view(text).substr(dash + 1));
    auto found = first && last ? of_range(text, *first, *last, *status) : of_name(text, *status);
    if (!found) return std::unexpected(found.error());
    numbers.insert(numbers.end(), found->begin(), found->end());
  }
  std::vector<JobId> unique;
  for (const JobId number : numbers)
    if (std::ranges::find(unique, number) == unique.end()) unique.push_back(number);
  return unique;
}

}  // namespace penumbra
