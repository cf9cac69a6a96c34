// The scripts with which a render runs as jobs of Slurm: its scheduler, an array of workers that find it, and
// a script that submits both.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "worker/cli/command_line.h"

namespace penumbra {

/// What the scripts contain. Paths are absolute and the same on all nodes.
struct SlurmJob {
  std::filesystem::path folder;          ///< of the scripts and logs
  std::filesystem::path working_folder;  ///< from which names in `render` are meant
  std::filesystem::path keys;            ///< for scheduler and workers
  std::filesystem::path penumbra, penumbra_worker;
  std::vector<std::string> render;  ///< the words after `penumbra render`, without keys and threads
  bool has_threads = false;         ///< whether `render` says how many threads the scheduler's own worker has
  bool has_listen = false;          ///< whether `render` says where to listen
  int workers = 4;                  ///< tasks of the array
  int cpus = 4;                     ///< of each task, and of the scheduler's job
  double retry_for = 600;           ///< seconds for which a worker looks for the scheduler
  std::string time;                 ///< limit of each job, as sbatch reads it; empty: the partition's
  std::string partition, worker_partition, account;  ///< empty: Slurm's defaults, and for workers `partition`
  std::vector<std::string> options;                  ///< further options of sbatch for all jobs
};

/// Files in SlurmJob::folder.
namespace slurm_files {
inline constexpr const char *kScheduler = "scheduler.sbatch", *kWorkers = "workers.sbatch",
                            *kSubmit = "submit.sh", *kKeys = "keys", *kAddress = "address", *kJobs = "jobs",
                            *kLog = "scheduler.log";
}  // namespace slurm_files

std::string scheduler_script(const SlurmJob& job);
std::string workers_script(const SlurmJob& job);
/// For sh. Submits both, or says why not and leaves nothing in the queue; their numbers are then in the file
/// "jobs".
std::string submit_script(const SlurmJob& job);

/// A name for the queue, of the folder's name without its extension.
std::string job_name(const SlurmJob& job);

/// Checks a word for an #SBATCH line, where Slurm's own quoting would apply: not empty, no spaces, quotes,
/// backslashes or control characters.
OptionCheck sbatch_word();
/// Checks a time limit: minutes, minutes:seconds, hours:minutes:seconds, days-hours[:minutes[:seconds]], or
/// UNLIMITED.
OptionCheck sbatch_time();

}  // namespace penumbra
