// `penumbra cancel` and `penumbra prioritize`: change jobs of a service.
#include <memory>

#include "scheduler/cli/commands.h"
#include "scheduler/cli/option_checks.h"
#include "scheduler/cli/service/service_address.h"

namespace penumbra {
namespace {

struct ChangeOptions {
  ServiceAddress service;
  std::vector<JobId> jobs;
  int priority = 0;
};

/// Calls `change` for each job; an error of one does not stop the others.
template <typename Change>
ExitCode change_all(const ChangeOptions& options, const Change& change) {
  const auto connected = connect_to_service(options.service);
  if (!connected) return print_error(connected.error()), kBadInput;
  JobsClient& service = **connected;
  ExitCode code = kAllDone;
  for (const JobId job : options.jobs) {
    const Expected<void> changed = change(service, job);
    if (changed) continue;
    print_error(changed.error());
    code = kIncomplete;
    if (service.is_away()) break;
  }
  return code;
}

}  // namespace

void add_change_commands(CLI::App& app, Command& chosen) {
  CLI::App* cancel = app.add_subcommand("cancel", "Cancel jobs; what is rendered of them is kept");
  const auto cancelled = std::make_shared<ChangeOptions>();
  add_jobs(*cancel, cancelled->jobs)->required();
  add_service_address(*cancel, cancelled->service);
  cancel->footer("Examples:\n  penumbra cancel 12 13 --to unix:/tmp/farm.socket");
  cancel->callback([cancelled, &chosen] {
    chosen = [cancelled] {
      return change_all(*cancelled, [](JobsClient& service, JobId job) { return service.cancel({job}); });
    };
  });

  CLI::App* prioritize = app.add_subcommand("prioritize", "Change the priority of jobs");
  const auto urgent = std::make_shared<ChangeOptions>();
  add_jobs(*prioritize, urgent->jobs)->required();
  prioritize
      ->add_option("--priority", urgent->priority,
                   "The highest priority is rendered first; jobs begin with 0")
      ->type_name("P")
      ->check(whole_number(-kMostUrgent, kMostUrgent))
      ->required()
      ->group("Jobs");
  add_service_address(*prioritize, urgent->service);
  prioritize->footer("Examples:\n  penumbra prioritize 12 --priority 5 --to unix:/tmp/farm.socket");
  prioritize->callback([urgent, &chosen] {
    chosen = [urgent] {
      return change_all(*urgent, [&](JobsClient& service, JobId job) {
        return service.set_priority({job}, urgent->priority);
      });
    };
  });
}

}  // namespace penumbra
