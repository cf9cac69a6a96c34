// `penumbra submit SCENE|JOBFILE…`: submits renders to a service.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "kernels/host/text.h"
#include "scheduler/cli/commands.h"
#include "scheduler/cli/service/service_address.h"
#include "scheduler/cli/service/submitted_render.h"
#include "scheduler/files/stop_signal.h"
#include "scheduler/render/option_checks.h"
#include "scheduler/run/option_hints.h"
#include "scheduler/run/render_preparation.h"
#include "scheduler/run/scene_file.h"
#include "scheduler/run/shared_scenes.h"
#include "scheduler/sets/render_arguments.h"
#include "scheduler/sets/set_plan.h"
#include "scheduler/sets/shot_denoising.h"

namespace penumbra {
namespace {

struct SubmitOptions {
  RenderOptions render;
  ServiceAddress service;
  std::optional<int> priority;
  bool lines = false;
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
            const std::vector<std::string>& command_line, SceneLoader load)
      : options_(options),
        plan_(plan),
        service_(service),
        command_line_(command_line),
        load_(std::move(load)),
        denoising_(plan, options.render.time_radius) {
    if (plan.has_job_file || plan.members.size() > 1 || !options.render.frames.empty())
      group_ = {0, plan.name, std::uint32_t(plan.members.size())};
  }

  ExitCode submit_all(const std::atomic<bool>& stop);
  /// Of the group, or of the only job. 0: nothing was submitted.
  [[nodiscard]] JobId number() const {
    if (group_) return group_->number;
    return jobs_.empty() ? 0 : jobs_.begin()->second;
  }

 private:
  Expected<void> submit(std::size_t index);

  const SubmitOptions& options_;
  const SetPlan& plan_;
  JobsClient& service_;
  const std::vector<std::string>& command_line_;
  SceneLoader load_;
  const ShotDenoising denoising_;  // only to know which frames are beside each other
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
  const auto prepared = prepare_render(member.options, load_);
  if (!prepared) return std::unexpected(prepared.error());
  for (const std::string& warning : prepared->scene.description.warnings)
    if (told_warnings_.insert(warning).second) print_warning(warning);
  Submission submission = submission_of(*prepared, member, command_line_);
  submission.group = group_;
  submission.after = std::move(after);
  if (denoising_.has(index))
    submission.beside = {std::uint32_t(denoising_.shot_of(index)), denoising_.numbers_beside(index)};
  const auto reply = service_.submit(submission, prepared->job.scene);
  if (!reply) return std::unexpected(reply.error());
  jobs_[index] = reply->job();
  const bool is_new_group = group_ && group_->number == 0;
  if (is_new_group) group_->number = reply->group();
  if (options_.lines) return {};
  if (options_.render.quiet) {
    if (!group_ || is_new_group) print_answer(fmt::format("{}\n", number()));
    return {};
  }
  if (is_new_group)
    print_answer(
        fmt::format("group {}: {}, {}\n", reply->group(), plan_.name, counted(group_->size, "render")));
  print_answer(fmt::format("{}job {}: {}\n", group_ ? "  " : "", reply->job(), member.name));
  return {};
}

ExitCode Submitter::submit_all(const std::atomic<bool>& stop) {
  for (std::size_t i = 0; i < plan_.members.size() && !stop; ++i) {
    const auto submitted = submit(i);
    if (submitted) continue;
    print_error({fmt::format("{}: {}", plan_.members[i].name, submitted.error().message)});
    if (service_.is_away()) break;
  }
  ExitCode code = kAllDone;
  if (group_ && group_->number > 0)
    if (const auto closed = service_.close_group(group_->number); !closed)
      print_error(closed.error()), code = kIncomplete;
  if (jobs_.size() == plan_.members.size()) return code;
  print_error({fmt::format("{} of {} not submitted", plan_.members.size() - jobs_.size(),
                           counted(plan_.members.size(), "render"))});
  return kIncomplete;
}

Expected<SetPlan> plan_of(const SubmitOptions& options, const CommandLine& command) {
  if (options.render.scenes.empty()) return fail("say which SCENE to submit, or --lines");
  if (const auto checked = check_options(command); !checked) return std::unexpected(checked.error());
  if (const auto checked = check_no_value_is_a_scene(command, options.render.scenes); !checked)
    return std::unexpected(checked.error());
  return plan_set(options.render, command);
}

void add_options(CommandLine& command, SubmitOptions& options) {
  add_render_options(command, options.render);
  command
      .add_option("--priority", options.priority,
                  "The highest priority is rendered first (default: the job file's, or 0)")
      ->type_name("P")
      ->check(whole_number(-kMostUrgent, kMostUrgent))
      ->group("Jobs");
}

/// Submits what a line asks for. Its number is 0 where nothing was submitted.
std::pair<JobId, ExitCode> submit_line(const std::string& line, JobsClient& service, const SceneLoader& load,
                                       const std::atomic<bool>& stop) {
  const auto refused = [](const Error& error) { return print_error(error), std::pair{JobId{0}, kBadInput}; };
  const auto json = nlohmann::json::parse(line, nullptr, false);
  const auto is_text = [](const nlohmann::json& word) { return word.is_string(); };
  if (!json.is_array() || !std::ranges::all_of(json, is_text))
    return refused({"a line is a JSON array of words, such as [\"scene.xml\", \"--spp\", \"64\"]"});
  const auto words = json.get<std::vector<std::string>>();
  CommandLine command("submit", "submit");
  SubmitOptions options;
  options.lines = true;
  add_options(command, options);
  if (const auto parsed = command.parse(words); !parsed) return refused(parsed.error());
  const auto plan = plan_of(options, command);
  if (!plan) return refused(plan.error());
  std::vector<std::string> command_line = {"penumbra", "submit"};
  command_line.insert(command_line.end(), words.begin(), words.end());
  Submitter submitter(options, *plan, service, command_line, load);
  const ExitCode code = submitter.submit_all(stop);
  return {submitter.number(), code};
}

/// Answers each line of standard input with one of standard output.
ExitCode submit_lines(JobsClient& service, const std::atomic<bool>& stop) {
  KeptSceneFiles scenes(kMostSharedBytes);
  const SceneLoader load = std::bind_front(&KeptSceneFiles::load, &scenes);
  std::string line;
  while (!stop && std::getline(std::cin, line)) {
    const CapturedMessages messages;
    const auto [number, code] = submit_line(line, service, load, stop);
    const nlohmann::json answer = {{"number", number}, {"exit_code", code}, {"messages", messages.text()}};
    print_answer(answer.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  }
  return kAllDone;
}

ExitCode submit(const SubmitOptions& options, const CommandLine& command,
                const std::vector<std::string>& command_line) {
  const std::atomic<bool>& stop = install_stop_signal();
  if (options.lines && !options.render.scenes.empty())
    return print_error({"--lines: the scenes are on the lines of standard input"}), kBadInput;
  const auto plan = options.lines ? Expected<SetPlan>() : plan_of(options, command);
  if (!plan) return print_error(plan.error()), kBadInput;
  const auto connected = connect_to_service({options.service.to, options.render.keys});
  if (!connected) return print_error(connected.error()), kBadInput;
  if (options.lines) return submit_lines(**connected, stop);
  SharedScenes scenes(scenes_of(*plan));
  return Submitter(options, *plan, **connected, command_line, std::bind_front(&SharedScenes::load, &scenes))
      .submit_all(stop);
}

}  // namespace

void add_submit_command(CommandLine& app, const std::vector<std::string>& command_line, Command& chosen) {
  CommandLine* command = app.add_command("submit", "Submit renders to a service");
  const auto options = std::make_shared<SubmitOptions>();
  add_options(*command, *options);
  for (Option* option : command->options())
    if (is_refused(*option)) option->group("");  // not in the help
  command->option("SCENE")->required(false);
  command
      ->add_flag("--lines", options->lines,
                 "Read submissions from standard input, a JSON array of words on each line, and answer each "
                 "with a line of JSON. Scenes stay in memory while their files do not change")
      ->group("Jobs");
  add_service_address(*command, options->service, false);
  command->option("--keys")->description(
      "For a service at HOST:PORT with TLS: the folder that `penumbra keys` made, "
      "or its part for users");
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
