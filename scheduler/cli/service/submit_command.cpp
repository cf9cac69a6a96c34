// `penumbra submit SCENE|JOBFILE…`: submits renders to a service.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "kernels/host/text.h"
#include "scheduler/cli/commands.h"
#include "scheduler/cli/option_checks.h"
#include "scheduler/cli/render_preparation.h"
#include "scheduler/cli/service/service_address.h"
#include "scheduler/cli/service/submitted_render.h"
#include "scheduler/cli/sets/render_arguments.h"
#include "scheduler/cli/sets/set_plan.h"
#include "scheduler/cli/stop_signal.h"

namespace penumbra {
namespace {

struct SubmitOptions {
  RenderOptions render;
  ServiceAddress service;
  std::optional<int> priority;
};

/// Rejects options that the service or `penumbra fetch` determines.
Expected<void> check_options(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0 || option->get_lnames().empty()) continue;
    const std::string& name = option->get_lnames().front();
    if (name == "out" || name == "to" || name == "priority" || name == "quiet" || name == "keys") continue;
    if (name == "resume" || is_shared_option(name))
      return fail(fmt::format(
          "--{} is not of a job: `penumbra serve`, or `penumbra fetch`, has what there is of it", name));
  }
  return {};
}

ExitCode submit(const SubmitOptions& options, const CLI::App& command,
                const std::vector<std::string>& command_line) {
  const std::atomic<bool>& stop = install_stop_signal();
  if (const auto checked = check_options(command); !checked) return print_error(checked.error()), kBadInput;
  const auto plan = plan_set(options.render, command);
  if (!plan) return print_error(plan.error()), kBadInput;
  const auto connected = connect_to_service({options.service.to, options.render.keys});
  if (!connected) return print_error(connected.error()), kBadInput;
  JobsClient& service = **connected;
  SharedScenes scenes(scenes_of(*plan));
  std::size_t submitted = 0;
  for (SetMember member : plan->members) {
    if (stop) break;
    if (options.priority) member.priority = *options.priority;
    const auto complain = [&](const Error& error) {
      print_error({fmt::format("{}: {}", member.name, error.message)});
    };
    const auto prepared = prepare_render(member.options, &scenes);
    if (!prepared) {
      complain(prepared.error());
      continue;
    }
    for (const std::string& warning : prepared->scene.description.warnings) print_warning(warning);
    const auto job = service.submit(submission_of(*prepared, member, command_line), prepared->job.scene);
    if (!job) {
      complain(job.error());
      if (service.is_away()) break;
      continue;
    }
    ++submitted;
    print_answer(options.render.quiet ? fmt::format("{}\n", *job)
                                      : fmt::format("job {}: {}\n", *job, member.name));
  }
  if (submitted == plan->members.size()) return kAllDone;
  print_error({fmt::format("{} of {} not submitted", plan->members.size() - submitted,
                           counted(plan->members.size(), "render"))});
  return kIncomplete;
}

}  // namespace

void add_submit_command(CLI::App& app, const std::vector<std::string>& command_line, Command& chosen) {
  CLI::App* command = app.add_subcommand("submit", "Submit renders to a service");
  const auto options = std::make_shared<SubmitOptions>();
  add_render_options(*command, options->render);
  add_service_address(*command, options->service, false);
  command->get_option("--keys")->description(
      "For a service at HOST:PORT with TLS: the folder that `penumbra keys` made, "
      "or its part for users");
  command
      ->add_option("--priority", options->priority,
                   "The highest priority is rendered first (default: the job file's, or 0)")
      ->type_name("P")
      ->check(whole_number(-kMostUrgent, kMostUrgent))
      ->group("Jobs");
  command->footer(
      "Takes scenes and job files with the options of `penumbra render`. Scenes are read here and sent, each "
      "once. -o names the results; `penumbra fetch` chooses their folder. With --quiet only the number of "
      "each job is printed.\n\n"
      "Examples:\n"
      "  penumbra submit jobs.toml --to unix:/tmp/farm.socket\n"
      "  penumbra submit scene.xml --spp 4096 --priority 5 --to 127.0.0.1:7000");
  command->callback([options, command, &command_line, &chosen] {
    chosen = [options, command, &command_line] { return submit(*options, *command, command_line); };
  });
}

}  // namespace penumbra
