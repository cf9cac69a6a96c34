// `penumbra sbatch`: writes the scripts for a render as jobs of Slurm, and submits them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <sstream>

#include "kernels/host/atomic_file.h"
#include "kernels/host/text.h"
#include "scheduler/cli/commands.h"
#include "scheduler/cli/slurm/slurm_scripts.h"
#include "scheduler/files/program_path.h"
#include "scheduler/files/quoting.h"
#include "scheduler/files/run_program.h"
#include "scheduler/render/option_checks.h"
#include "scheduler/run/render_preparation.h"
#include "scheduler/sets/job_file.h"
#include "scheduler/sets/render_arguments.h"
#include "scheduler/sets/set_plan.h"
#include "worker/device.h"
#include "worker/keys/certificate.h"
#include "worker/keys/host_names.h"
#include "worker/keys/key_folder.h"
#include "worker/keys/make_keys.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

struct SbatchOptions {
  RenderOptions render;
  SlurmJob job;
  std::string folder;
  bool submit = false;
};

/// What the scripts decide themselves, each with its reason.
constexpr std::array<std::pair<const char*, const char*>, 5> kNotForJobs{
    {{"--launch", "the workers are an array of jobs"},
     {"--address-file", "it is in --folder"},
     {"--estimate", "run `penumbra render … --estimate` here"},
     {"--pixel", "run `penumbra render … --pixel` here"},
     {"--restart", "each requeue would begin anew; remove IMAGE.checkpoint instead"}}};

fs::path absolute_path(const fs::path& path) { return fs::absolute(path).lexically_normal(); }

/// NAME.slurm beside the first scene or job file, or in the present folder where nothing can be written
/// there.
fs::path default_folder(const fs::path& scene) {
  const std::string name = scene.stem().string() + ".slurm";
  fs::path beside = scene.parent_path() / name;
  return check_writable(beside / slurm_files::kSubmit) ? beside : fs::path(name);
}

/// Finds here what would otherwise be found when the job has waited in the queue.
Expected<void> check_render(const RenderOptions& options, const CommandLine& command) {
  RenderOptions checked = options;
  checked.listen.clear();  // its keys may not be there yet
  checked.keys.clear();
  if (options.scenes.size() > 1 || !options.frames.empty() || is_job_file(options.scenes.front())) {
    const auto plan = plan_set(checked, command);
    if (!plan) return std::unexpected(plan.error());
    std::error_code ignored;
    for (const SetMember& member : plan->members)
      if (!fs::exists(member.options.scene.file, ignored))
        return fail(fmt::format("{}: there is no file {}", member.name, member.options.scene.file));
    if (const auto writable = check_writable(plan->summary); !writable) return writable;
    std::set<fs::path> folders;
    for (const SetMember& member : plan->members)
      for (const fs::path& file : member.files.all())
        if (folders.insert(file.parent_path()).second)
          if (const auto writable = check_writable(file); !writable)
            return fail(fmt::format("{}: {}", member.name, writable.error().message));
    return {};
  }
  checked.scene.file = options.scenes.front();
  const auto prepared = prepare_render(checked);
  if (!prepared) return std::unexpected(prepared.error());
  for (const std::string& warning : prepared->scene.description.warnings) print_warning(warning);
  return {};
}

/// The names under which workers may reach a scheduler on any node of the partition (empty: of all). Error:
/// there is no Slurm here.
Expected<std::vector<std::string>> names_of_nodes(const std::string& partition) {
  const auto sinfo = find_program("sinfo");
  if (!sinfo) return std::unexpected(sinfo.error());
  std::vector<std::string> arguments{"--noheader", "--Node", "--format=%N %n %o"};
  if (!partition.empty()) arguments.push_back("--partition=" + partition);
  const auto listed = run_program(sinfo->string(), arguments, {.errors_too = true});
  if (!listed) return std::unexpected(listed.error());
  if (!listed->succeeded) return fail(listed->output);
  std::vector<std::string> names = host_names();
  const auto add = [&](const std::string& name) {
    if (is_certificate_name(name) && std::ranges::find(names, name) == names.end()) names.push_back(name);
  };
  // A node may call itself by its full name, which Slurm need not know; it is in the domain of this host.
  std::string domain;
  for (const std::string& name : host_names())
    if (name.contains('.') && std::ranges::any_of(name, [](unsigned char c) { return std::isalpha(c) != 0; }))
      domain = name.substr(name.find('.'));
  std::istringstream words(listed->output);
  for (std::string word; words >> word;) {
    add(word);
    if (!domain.empty() && !word.contains('.')) add(word + domain);
  }
  for (const std::string& name : loopback_names()) add(name);
  return names;
}

std::string one_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// Makes the keys if there are none, and checks that they can be read.
Expected<void> provide_keys(const fs::path& folder, const std::string& partition) {
  std::error_code ignored;
  if (!fs::exists(folder, ignored)) {
    const auto names = names_of_nodes(partition);
    if (!names)
      return fail(
          fmt::format("the names of the nodes for new keys are not known; `penumbra keys {} --name NODE,...` "
                      "makes keys:\n  {}",
                      shell_quoted_file(folder.string()), one_line(names.error().message)));
    if (const auto made = make_keys({.folder = folder, .names = *names}); !made) return made;
  }
  for (const KeyRole role : {KeyRole::kScheduler, KeyRole::kWorker})
    if (const auto keys = read_keys(folder, role); !keys) return fail("--keys: " + keys.error().message);
  return {};
}

Expected<void> write_scripts(const SlurmJob& job) {
  const std::pair<const char*, std::string> files[] = {{slurm_files::kScheduler, scheduler_script(job)},
                                                       {slurm_files::kWorkers, workers_script(job)},
                                                       {slurm_files::kSubmit, submit_script(job)}};
  for (const auto& [name, text] : files)
    if (const auto written = write_output(job.folder / name, bytes_of(text)); !written) return written;
  return {};
}

/// Completes the job by what the command says. `command` is that which was parsed.
Expected<SlurmJob> job_of(const SbatchOptions& options, const CommandLine& command) {
  for (const auto& [name, why] : kNotForJobs)
    if (command.option(name)->is_given())
      return fail(fmt::format("{} is not for `penumbra sbatch`: {}", name, why));
  if (const auto checked = check_render(options.render, command); !checked)
    return std::unexpected(checked.error());
  SlurmJob job = options.job;
  job.workers = options.render.workers;
  job.folder = absolute_path(options.folder.empty() ? default_folder(options.render.scenes.front())
                                                    : fs::path(options.folder));
  if (!job.folder.has_filename()) job.folder = job.folder.parent_path();
  job.working_folder = fs::current_path();
  job.keys =
      options.render.keys.empty() ? job.folder / slurm_files::kKeys : absolute_path(options.render.keys);
  for (const auto& [name, path] :
       {std::pair("penumbra", &job.penumbra), {"penumbra-worker", &job.penumbra_worker}}) {
    const auto found = find_program(name);
    if (!found) return std::unexpected(found.error());
    *path = *found;
  }
  job.render = render_words(command, std::array<std::string_view, 2>{"workers", "keys"});
  job.has_threads = command.option("--threads")->is_given();
  job.has_listen = command.option("--listen")->is_given();
  return job;
}

void print_what_to_do(const SlurmJob& job, bool submitted) {
  const auto file = [&](const char* name) { return shell_quoted((job.folder / name).string()); };
  std::string text = fmt::format("wrote {}: {}, {}, {}\n", job.folder.string(), slurm_files::kScheduler,
                                 slurm_files::kWorkers, slurm_files::kSubmit);
  if (!submitted) text += fmt::format("  submit  sh {}\n", file(slurm_files::kSubmit));
  text += fmt::format(
      "  watch   squeue --me; tail -F {}\n"
      "  window  penumbra view --connect \"$(cat {})\" --keys {}\n"
      "  cancel  scancel $(cat {})\n",
      file(slurm_files::kLog), file(slurm_files::kAddress), shell_quoted(job.keys.string()),
      file(slurm_files::kJobs));
  print_remark(text);
}

ExitCode sbatch(const SbatchOptions& options, const CommandLine& command) {
  const auto job = job_of(options, command);
  if (!job) return print_error(job.error()), kBadInput;
  auto made = check_writable(job->folder / slurm_files::kSubmit);
  if (made) made = make_folders(job->folder / slurm_files::kSubmit);
  if (!made) return print_error({fmt::format("--folder: {}", made.error().message)}), kBadInput;
  if (const auto keys = provide_keys(job->keys, job->partition); !keys)
    return print_error(keys.error()), kBadInput;
  if (const auto written = write_scripts(*job); !written) return print_error(written.error()), kBadInput;
  if (options.submit) {
    const auto ran =
        run_program("/bin/sh", {(job->folder / slurm_files::kSubmit).string()}, {.errors_too = true});
    if (!ran) return print_error(ran.error()), kIncomplete;
    if (!ran->succeeded) return print_error({"not submitted:\n" + ran->output}), kIncomplete;
    print_remark(ran->output);
  }
  print_what_to_do(*job, options.submit);
  return kAllDone;
}

}  // namespace

void add_sbatch_command(CommandLine& app, Command& chosen) {
  CommandLine* command = app.add_command("sbatch", "Write, and submit, a render as jobs of a Slurm cluster");
  const auto options = std::make_shared<SbatchOptions>();
  SlurmJob& job = options->job;
  options->render.workers = job.workers;
  add_render_options(*command, options->render);
  command->option("--workers")->description("Tasks of the array of workers")->group("Slurm");
  command->option("--keys")->description(
      "Keys for scheduler and workers, which `penumbra keys` has made; if the folder does not exist they are "
      "made, "
      "for all nodes of the partition (default: keys in --folder)");
  command->option("--listen")
      ->description("Where the scheduler listens, as in 0.0.0.0:7000 (default: a free port)");
  command->default_group("Slurm");
  command->add_option("--cpus", job.cpus, "Cores of each worker, and of the scheduler, which also renders")
      ->type_name("N")
      ->check(whole_number(1, kMaxThreads))
      ->capture_default_str();
  command->add_option("--time", job.time, "Time limit of each job, as in 12:00:00 (default: the partition's)")
      ->type_name("TEXT")
      ->check(sbatch_time());
  command->add_option("--partition", job.partition, "Partition of both jobs")
      ->type_name("NAME")
      ->check(sbatch_word());
  command
      ->add_option("--worker-partition", job.worker_partition,
                   "Partition of the workers, such as one whose jobs are preempted (default: --partition)")
      ->type_name("NAME")
      ->check(sbatch_word());
  command->add_option("--account", job.account, "Account of both jobs")
      ->type_name("NAME")
      ->check(sbatch_word());
  command
      ->add_option("--option", job.options,
                   "A further option of sbatch for both jobs, as in --option=--mem=8G; repeatable")
      ->type_name("TEXT")
      ->allow_extra_args(false)
      ->check(sbatch_word());
  command
      ->add_option("--retry-for", job.retry_for,
                   "Time for which workers wait for a scheduler that is not there yet, or is requeued")
      ->type_name("SECONDS")
      ->transform(seconds())
      ->check(number_from_zero())
      ->capture_default_str();
  command
      ->add_option(
          "--folder", options->folder,
          "Folder of scripts, keys and logs, which all nodes see (default: NAME.slurm beside the first scene "
          "or job file, or in the present folder if nothing can be written there)")
      ->type_name("FOLDER")
      ->check(some_text());
  command->add_flag("--submit", options->submit, "Submit the jobs, too");
  show_common_render_options(*command);
  command->short_help({"--workers", "--cpus", "--time", "--partition", "--worker-partition", "--account",
                       "--option", "--keys", "--folder", "--submit"});
  command->footer(
      "Takes the scenes, job files and options of `penumbra render`, and writes three scripts: "
      "scheduler.sbatch, "
      "which renders and waits for workers; workers.sbatch, an array of workers; and submit.sh, which "
      "submits both. "
      "Installation, scenes and the present folder must have the same paths on all nodes.\n\n"
      "Jobs are requeued when a node fails or they are preempted. The scheduler goes on from its checkpoint, "
      "on any "
      "node, and its workers find it again. Submit again after a time limit.\n\n"
      "Examples:\n"
      "  penumbra sbatch scene.xml --spp 4096 -o out/a.exr --workers 32 --submit\n"
      "  penumbra sbatch shot.glb --frames 1-250 --workers 32 --submit\n"
      "  penumbra sbatch jobs.toml --workers 100 --cpus 8 --time 12:00:00 --partition long\n"
      "  sh jobs.slurm/submit.sh");
  command->callback(
      [options, command, &chosen] { chosen = [options, command] { return sbatch(*options, *command); }; });
}

}  // namespace penumbra
