#include "scheduler/cli/service/chosen_jobs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "scenes/number.h"
#include "scheduler/render/option_checks.h"

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
