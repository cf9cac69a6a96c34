#include "scheduler/cli/slurm/slurm_scripts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <regex>
#include <string_view>

#include "scheduler/files/quoting.h"

namespace penumbra {
namespace {

std::string quoted_path(const std::filesystem::path& path) { return shell_quoted(path.string()); }

/// The lines for Slurm that all jobs have.
std::string directives(const SlurmJob& job, const std::string& partition) {
  // Output is appended because a requeued job continues its log.
  std::string text =
      fmt::format("#SBATCH --ntasks=1 --cpus-per-task={} --requeue --open-mode=append\n", job.cpus);
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) text += fmt::format("#SBATCH {}={}\n", option, value);
  };
  add("--time", job.time);
  add("--partition", partition);
  add("--account", job.account);
  for (const std::string& option : job.options) text += "#SBATCH " + option + "\n";
  return text;
}

}  // namespace

std::string job_name(const SlurmJob& job) {
  std::string name = job.folder.stem().string();
  for (char& c : name)
    if (std::isalnum((unsigned char)c) == 0 && std::string_view("._-").find(c) == std::string_view::npos)
      c = '_';
  return name.empty() ? "penumbra" : name;
}

std::string scheduler_script(const SlurmJob& job) {
  std::string text = fmt::format(
      "#!/bin/sh\n"
      "# The scheduler of a render, which also renders itself. After a requeue, or submitted again, it "
      "continues\n"
      "# from its checkpoint. Made by `penumbra sbatch`; {} submits it.\n"
      "#SBATCH --job-name={} --nodes=1 --output={}\n",
      slurm_files::kSubmit, job_name(job), slurm_files::kLog);
  text += directives(job, job.partition);
  text += fmt::format("cd {} || exit\nexec {} render", quoted_path(job.working_folder),
                      quoted_path(job.penumbra));
  std::vector<std::string> words = job.render;
  if (!job.has_threads) words.push_back(fmt::format("--threads={}", job.cpus));
  if (!job.has_listen) words.emplace_back("--listen=0.0.0.0:0");
  words.push_back("--keys=" + job.keys.string());
  words.push_back("--address-file=" + (job.folder / slurm_files::kAddress).string());
  for (const std::string& word : words) text += " \\\n    " + shell_quoted(word);
  return text + "\n";
}

std::string workers_script(const SlurmJob& job) {
  const std::string& partition = job.worker_partition.empty() ? job.partition : job.worker_partition;
  std::string text = fmt::format(
      "#!/bin/sh\n"
      "# Workers of a render, one a task. They find the scheduler by its address file, again when it has "
      "moved, and\n"
      "# end with the render. Made by `penumbra sbatch`; {} submits it.\n"
      "#SBATCH --job-name={}-workers --array=1-{} --output=worker-%a.log\n",
      slurm_files::kSubmit, job_name(job), job.workers);
  text += directives(job, partition);
  return text +
         fmt::format(
             "# Scenes are kept on a disk of the node.\n"
             "export PENUMBRA_CACHE=\"${{PENUMBRA_CACHE:-${{TMPDIR:-/tmp}}/penumbra-cache-$(id -u)}}\"\n"
             "exec {} --threads auto --cache-size 20G --retry-for {} \\\n"
             "    {} \\\n"
             "    {}\n",
             quoted_path(job.penumbra_worker), job.retry_for, shell_quoted("--keys=" + job.keys.string()),
             shell_quoted("--connect=file:" + (job.folder / slurm_files::kAddress).string()));
}

std::string submit_script(const SlurmJob& job) {
  constexpr const char* kText = R"sh(#!/bin/sh
# Submits the scheduler of a render and its workers, both or none. Made by `penumbra sbatch`.
cd {folder} || exit
if ! command -v sbatch >/dev/null; then
  echo "there is no sbatch here: submit on a host of the cluster" >&2
  exit 1
fi
if [ -s {jobs} ] && [ -n "$(squeue --noheader --jobs="$(tr ' ' , <{jobs})" 2>/dev/null)" ]; then
  echo "jobs $(cat {jobs}) of this render are still in the queue: let them end, or scancel $(cat {jobs})" >&2
  exit 1
fi
rm -f {address} {jobs}
scheduler=$(sbatch --parsable {scheduler}) || exit 1
scheduler=${{scheduler%%;*}}
if ! workers=$(sbatch --parsable --dependency=after:"$scheduler" {workers}); then
  scancel "$scheduler"
  exit 1
fi
workers=${{workers%%;*}}
echo "$scheduler $workers" >{jobs}
echo "submitted: scheduler $scheduler, workers $workers"
)sh";
  return fmt::format(kText, fmt::arg("folder", quoted_path(job.folder)), fmt::arg("jobs", slurm_files::kJobs),
                     fmt::arg("address", slurm_files::kAddress),
                     fmt::arg("scheduler", slurm_files::kScheduler),
                     fmt::arg("workers", slurm_files::kWorkers));
}

OptionCheck sbatch_word() {
  return {[](const std::string& word) {
            const auto is_plain = [](unsigned char c) {
              return c > ' ' && c != 127 && c != '"' && c != '\'' && c != '\\';
            };
            if (!word.empty() && std::ranges::all_of(word, is_plain)) return std::string();
            return "'" + word +
                   "' has characters that a line of sbatch options cannot have: no spaces, quotes, \\";
          },
          ""};
}

OptionCheck sbatch_time() {
  return {[](const std::string& text) {
            static const std::regex time(
                "[0-9]+(:[0-9]+(:[0-9]+)?)?|[0-9]+-[0-9]+(:[0-9]+(:[0-9]+)?)?|UNLIMITED");
            if (std::regex_match(text, time)) return std::string();
            return "'" + text +
                   "' is no time limit of Slurm: minutes, hours:minutes:seconds, days-hours, or UNLIMITED";
          },
          ""};
}

}  // namespace penumbra
