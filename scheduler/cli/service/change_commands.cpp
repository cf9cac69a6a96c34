// `penumbra cancel`, `prioritize` and `retry`: change jobs of a service.
#include <functional>
#include <memory>

#include "scheduler/cli/commands.h"
#include "scheduler/cli/service/chosen_jobs.h"
#include "scheduler/cli/service/service_address.h"
#include "scheduler/render/option_checks.h"
#include "scheduler/service/job_queue.h"

namespace penumbra {
namespace {

struct ChangeOptions {
  ServiceAddress service;
  std::vector<std::string> jobs;
  std::string frames;
  int priority = 0;
};
struct Change {
  std::function<Expected<void>(JobsClient& service, JobId number, const ChangeOptions& options)> make;
  bool (*is_possible)(const wire::JobStatus& job);
};

bool is_under_way(const wire::JobStatus& job) { return !is_over(job); }
bool can_be_retried(const wire::JobStatus& job) { return is_over(job) && job.state() != wire::JOB_DONE; }

/// Changes each job or group; an error of one does not stop the others.
ExitCode change_all(const ChangeOptions& options, const Change& change) {
  const auto connected = connect_to_service(options.service);
  if (!connected) return print_error(connected.error()), kBadInput;
  JobsClient& service = **connected;
  auto numbers = numbers_of(options.jobs, service);
  if (numbers && !options.frames.empty())
    numbers = jobs_of_frames(*numbers, options.frames, service, change.is_possible);
  if (!numbers) return print_error(numbers.error()), kIncomplete;
  ExitCode code = kAllDone;
  for (const JobId number : *numbers) {
    const Expected<void> changed = change.make(service, number, options);
    if (changed) continue;
    print_error(changed.error());
    code = kIncomplete;
    if (service.is_away()) break;
  }
  return code;
}

/// Adds a command that changes jobs; its options may be extended.
std::pair<CommandLine*, std::shared_ptr<ChangeOptions>> add_change(CommandLine& app, Command& chosen,
                                                                   const char* name, const char* description,
                                                                   Change change) {
  CommandLine* command = app.add_command(name, description);
  const auto options = std::make_shared<ChangeOptions>();
  add_jobs(*command, options->jobs)->required();
  add_frames(*command, options->frames);
  add_service_address(*command, options->service);
  command->callback([options, change = std::move(change), &chosen] {
    chosen = [options, change] { return change_all(*options, change); };
  });
  return {command, options};
}

}  // namespace

void add_change_commands(CommandLine& app, Command& chosen) {
  const auto [cancel, cancelled] = add_change(
      app, chosen, "cancel", "Cancel jobs; what is rendered of them is kept",
      {[](JobsClient& service, JobId number, const auto&) { return service.cancel(number); }, is_under_way});
  cancel->footer("Examples:\n  penumbra cancel 12 14-19 jobs.toml --to unix:/tmp/farm.socket");

  const auto [prioritize, urgent] =
      add_change(app, chosen, "prioritize", "Change the priority of jobs",
                 {[](JobsClient& service, JobId number, const ChangeOptions& options) {
                    return service.set_priority(number, options.priority);
                  },
                  is_under_way});
  prioritize
      ->add_option("--priority", urgent->priority,
                   "The highest priority is rendered first; jobs begin with 0")
      ->type_name("P")
      ->check(whole_number(-kMostUrgent, kMostUrgent))
      ->required()
      ->group("Jobs");
  prioritize->footer("Examples:\n  penumbra prioritize 12 --priority 5 --to unix:/tmp/farm.socket");

  const auto [retry, again] = add_change(
      app, chosen, "retry", "Queue jobs again that failed, are incomplete or were cancelled",
      {[](JobsClient& service, JobId number, const auto&) { return service.retry(number); }, can_be_retried});
  retry->footer(
      "They continue with what was rendered of them. Jobs that failed because they come after them are "
      "queued "
      "again too.\n\n"
      "Examples:\n  penumbra retry 12 --frames 80-95 --to unix:/tmp/farm.socket");
}

}  // namespace penumbra
