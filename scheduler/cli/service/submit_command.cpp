// `penumbra submit SCENE|JOBFILE…`: submits renders to a service.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "kernels/host/text.h"
#include "scheduler/cli/commands.h"
#include "scheduler/cli/service/service_address.h"
#include "scheduler/cli/service/submitted_render.h"
#include "scheduler/files/stop_signal.h"
#include "scheduler/render/option_checks.h"
#include "scheduler/run/option_hints.h"
#include "scheduler/run/render_preparation.h"
#include "scheduler/sets/render_arguments.h"
#include "scheduler/sets/set_plan.h"

namespace penumbra {
namespace {

struct SubmitOptions {
  RenderOptions render;
  ServiceAddress service;
  std::optional<int> priority;
};

/// Whether an option of `penumbra render` is not one of a job: the service or `penumbra fetch` determines it.
bool is_refused(const Option& option) {
  if (option.long_names().empty()) return false;
  const std::string& name = option.long_names().front();
  if (name == "out" || name == "to" || name == "priority" || name == "quiet" || name == "keys" ||
      name == "help" || name == "frames" || name == "order")
    return false;
  return name == "resume" || is_shared_option(name);
}

Expected<void> check_options(const CommandLine& command) {
  for (const Option* option : command.options())
    if (option->is_given() && is_refused(*option))
      return fail(
          fmt::format("--{} is not of a job: `penumbra serve`, or `penumbra fetch`, has what there is of it",
                      option->long_names().front()));
  return {};
}

/// Submits the renders of one command. Several, or those of a job file or a shot, are a group.
class Submitter {
 public:
  Submitter(const SubmitOptions& options, const SetPlan& plan, JobsClient& service,
            const std::vector<std::string>& command_line)
      : options_(options),
        plan_(plan),
        service_(service),
        command_line_(command_line),
        scenes_(scenes_of(plan)) {
    if (plan.has_job_file || plan.members.size() > 1 || !options.render.frames.empty())
      group_ = {0, plan.name, std::uint32_t(plan.members.size())};
  }

  struct Submitted {
    std::size_t renders = 0;
    bool is_closed = true;  ///< the service knows that no more come
  };
  Submitted submit_all(const std::atomic<bool>& stop);

 private:
  Expected<void> submit(std::size_t index);

  const SubmitOptions& options_;
  const SetPlan& plan_;
  JobsClient& service_;
  const std::vector<std::string>& command_line_;
  SharedScenes scenes_;
  std::optional<SubmittedGroup> group_;
  std::map<std::size_t, JobId> jobs_;  // of the plan's members
  std::set<std::string> told_warnings_;
};

Expected<void> Submitter::submit(std::size_t index) {
  SetMember member = plan_.members[index];
  member.options.writes_here = false;
  if (options_.priority) member.priority = *options_.priority;
  std::vector<JobId> after;
  for (const std::size_t before : member.after) {
    if (!jobs_.contains(before))
      return fail(fmt::format("it comes after {}, which was not submitted", plan_.members[before].name));
    after.push_back(jobs_.at(before));
  }
  const auto prepared = prepare_render(member.options, &scenes_);
  if (!prepared) return std::unexpected(prepared.error());
  for (const std::string& warning : prepared->scene.description.warnings)
    if (told_warnings_.insert(warning).second) print_warning(warning);
  Submission submission = submission_of(*prepared, member, command_line_);
  submission.group = group_;
  submission.after = std::move(after);
  const auto reply = service_.submit(submission, prepared->job.scene);
  if (!reply) return std::unexpected(reply.error());
  jobs_[index] = reply->job();
  const bool is_new_group = group_ && group_->number == 0;
  if (is_new_group) group_->number = reply->group();
  if (options_.render.quiet) {
    if (!group_ || is_new_group) print_answer(fmt::format("{}\n", group_ ? reply->group() : reply->job()));
    return {};
  }
  if (is_new_group)
    print_answer(
        fmt::format("group {}: {}, {}\n", reply->group(), plan_.name, counted(group_->size, "render")));
  print_answer(fmt::format("{}job {}: {}\n", group_ ? "  " : "", reply->job(), member.name));
  return {};
}

Submitter::Submitted Submitter::submit_all(const std::atomic<bool>& stop) {
  for (std::size_t i = 0; i < plan_.members.size() && !stop; ++i) {
    const auto submitted = submit(i);
    if (submitted) continue;
    print_error({fmt::format("{}: {}", plan_.members[i].name, submitted.error().message)});
    if (service_.is_away()) break;
  }
  if (group_ && group_->number > 0)
    if (const auto closed = service_.close_group(group_->number); !closed)
      return print_error(closed.error()), Submitted{jobs_.size(), false};
  return {jobs_.size()};
}

ExitCode submit(const SubmitOptions& options, const CommandLine& command,
                const std::vector<std::string>& command_line) {
  const std::atomic<bool>& stop = install_stop_signal();
  if (const auto checked = check_options(command); !checked) return print_error(checked.error()), kBadInput;
  if (const auto checked = check_no_value_is_a_scene(command, options.render.scenes); !checked)
    return print_error(checked.error()), kBadInput;
  const auto plan = plan_set(options.render, command);
  if (!plan) return print_error(plan.error()), kBadInput;
  const auto connected = connect_to_service({options.service.to, options.render.keys});
  if (!connected) return print_error(connected.error()), kBadInput;
  const auto [submitted, is_closed] = Submitter(options, *plan, **connected, command_line).submit_all(stop);
  if (submitted == plan->members.size()) return is_closed ? kAllDone : kIncomplete;
  print_error({fmt::format("{} of {} not submitted", plan->members.size() - submitted,
                           counted(plan->members.size(), "render"))});
  return kIncomplete;
}

}  // namespace

void add_submit_command(CommandLine& app, const std::vector<std::string>& command_line, Command& chosen) {
  CommandLine* command = app.add_command("submit", "Submit renders to a service");
  const auto options = std::make_shared<SubmitOptions>();
  add_render_options(*command, options->render);
  for (Option* option : command->options())
    if (is_refused(*option)) option->group("");  // not in the help
  add_service_address(*command, options->service, false);
  command->option("--keys")->description(
      "For a service at HOST:PORT with TLS: the folder that `penumbra keys` made, "
      "or its part for users");
  command
      ->add_option("--priority", options->priority,
                   "The highest priority is rendered first (default: the job file's, or 0)")
      ->type_name("P")
      ->check(whole_number(-kMostUrgent, kMostUrgent))
      ->group("Jobs");
  show_common_render_options(*command);
  command->short_help({"--to", "--priority", "--keys"});
  command->footer(
      "Takes scenes and job files with the options of `penumbra render`. Scenes are read here and sent, each "
      "once, and of the frames of a shot only what changes. Several renders, or those of a job file or a "
      "shot, "
      "are a group with a number of its own. -o names the "
      "results; "
      "`penumbra fetch` chooses their folder. With --quiet only the number of the group, or of the only job, "
      "is "
      "printed.\n\n"
      "Examples:\n"
      "  penumbra submit shot.glb --frames 1-48 --order preview\n"
      "  penumbra submit jobs.toml --to unix:/tmp/farm.socket\n"
      "  penumbra submit scene.xml --spp 4096 --priority 5 --to 127.0.0.1:7000");
  command->callback([options, command, &command_line, &chosen] {
    chosen = [options, command, &command_line] { return submit(*options, *command, command_line); };
  });
}

}  // namespace penumbra
