// `penumbra fetch JOB…`: downloads results from a service.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <set>
#include <thread>

#include "scheduler/cli/commands.h"
#include "scheduler/cli/service/chosen_jobs.h"
#include "scheduler/cli/service/service_address.h"
#include "scheduler/files/stop_signal.h"
#include "scheduler/service/job_queue.h"
#include "scheduler/service/status_text.h"
#include "worker/cli/help_text.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

// Between two status requests: a short job is noticed soon, a long one is not asked for often.
constexpr std::chrono::milliseconds kFirstWait{5}, kLongestWait{1000}, kLongestSleep{100};

struct FetchOptions {
  ServiceAddress service;
  std::string out = ".";
  std::vector<std::string> jobs;
  std::string frames;
  bool all = false, wait = false, remove = false, quiet = false;
};

/// The status of the requested jobs, immediately or when all of them are over. Also waits for a service that
/// is away.
Expected<wire::StatusReply> wait_for_jobs(JobsClient& service, const FetchOptions& options,
                                          const std::vector<JobId>& jobs, const std::atomic<bool>& stop) {
  bool was_reached = false, said = false;
  for (std::chrono::milliseconds wait = kFirstWait;; wait = std::min(wait * 3 / 2, kLongestWait)) {
    auto status = service.status(jobs);
    if (!status && !(options.wait && was_reached && service.is_away() && !stop)) return status;
    if (status) {
      was_reached = true;
      said = false;
      const bool over = std::ranges::all_of(status->jobs(), is_over);
      if (over || !options.wait || stop) return status;
    } else if (!std::exchange(said, true)) {
      print_message(status.error().message + "; trying again");
    }
    for (auto left = wait; left > left.zero() && !stop; left -= kLongestSleep)
      std::this_thread::sleep_for(std::min(left, kLongestSleep));
  }
}

/// The path for a file: below the chosen folder, as the job file had it. If two jobs have the same path, the
/// job's number is added.
fs::path place_of(const fs::path& folder, JobId job, const std::string& name, std::set<fs::path>& taken) {
  const fs::path path(name);
  fs::path place = folder / path;
  for (std::string stem = path.stem().string(); !taken.insert(place).second;) {
    stem += fmt::format("-{}", job);
    place = folder / (stem + path.extension().string());
  }
  return place;
}

/// Makes the job's folder below the chosen one. Errors: it is not below it, because of a symbolic link; it
/// cannot be made.
Expected<fs::path> make_folder(const FetchOptions& options, const wire::JobStatus& job) {
  // A correct service has no other folders.
  const fs::path folder =
      is_result_folder(job.folder()) ? fs::path(options.out) / job.folder() : fs::path(options.out);
  std::error_code error;
  const fs::path root = fs::weakly_canonical(options.out, error),
                 target = fs::weakly_canonical(folder, error);
  if (error) return fail(fmt::format("cannot use the folder {}: {}", folder.string(), error.message()));
  if (std::ranges::mismatch(root, target).in1 != root.end())
    return fail(fmt::format("{} leads out of {} through a link; fetch to another folder (-o)",
                            folder.string(), options.out));
  fs::create_directories(target, error);
  if (error) return fail(fmt::format("cannot make the folder {}: {}", folder.string(), error.message()));
  return folder;
}

ExitCode fetch(const FetchOptions& options) {
  if (options.all == !options.jobs.empty())
    return print_error({"say which jobs to fetch: numbers of jobs or groups, or --all"}), kBadInput;
  const std::atomic<bool>& stop = install_stop_signal();
  const auto connected = connect_to_service(options.service);
  if (!connected) return print_error(connected.error()), kBadInput;
  JobsClient& service = **connected;
  auto jobs = numbers_of(options.jobs, service);
  if (jobs && !options.frames.empty())
    jobs = jobs_of_frames(*jobs, options.frames, service, [](const wire::JobStatus&) { return true; });
  if (!jobs) return print_error(jobs.error()), kIncomplete;
  const auto status = wait_for_jobs(service, options, *jobs, stop);
  if (!status) return print_error(status.error()), kIncomplete;
  ExitCode code = kAllDone;
  std::set<fs::path> taken;
  for (const wire::JobStatus& job : status->jobs()) {
    const std::string what = fmt::format("job {}, {}", job.job(), job.name());
    if (!is_over(job)) {
      if (!options.all) {
        print_error(
            {fmt::format("{}: it is {}; --wait waits for its end", what, job_state_name(job.state()))});
        code = kIncomplete;
      }
      continue;
    }
    if (job.state() != wire::JOB_DONE) {
      print_error({fmt::format("{}: {}: {}", what, job_state_name(job.state()), job.error())});
      code = kIncomplete;
    }
    const auto folder = make_folder(options, job);
    if (!folder) {
      print_error({fmt::format("{}: {}", what, folder.error().message)});
      code = kIncomplete;
      continue;
    }
    bool fetched = true;
    for (const wire::StoredFile& file : job.files()) {
      if (!is_result_name(file.name())) continue;  // a correct service has no such files
      const fs::path place = place_of(*folder, job.job(), file.name(), taken);
      const auto written = service.fetch(job.job(), file, place);
      if (!written) {
        print_error({fmt::format("{}: {}", what, written.error().message)});
        fetched = false;
        code = kIncomplete;
      } else if (!options.quiet) {
        print_answer(fmt::format("{}\n", place.string()));
      }
    }
    if (fetched && options.remove)
      if (const auto removed = service.remove(job.job()); !removed) {
        print_error(removed.error());
        code = kIncomplete;
      }
  }
  return code;
}

}  // namespace

void add_fetch_command(CommandLine& app, Command& chosen) {
  CommandLine* command = app.add_command("fetch", "Fetch the images of jobs");
  const auto options = std::make_shared<FetchOptions>();
  Option* jobs = add_jobs(*command, options->jobs);
  Option* frames = add_frames(*command, options->frames);
  command->add_flag("--all", options->all, "Every job that is over")
      ->excludes(jobs)
      ->excludes(frames)
      ->group("Jobs");
  command->add_option("-o,--out", options->out, "Folder for the files, made if it is missing")
      ->type_name("FOLDER")
      ->capture_default_str()
      ->group(group::kOutput);
  command
      ->add_flag("--wait", options->wait,
                 "Wait until the jobs are over, also while the service is not running")
      ->group("Jobs");
  command->add_flag("--remove", options->remove, "Then remove the jobs and their files from the service")
      ->group("Jobs");
  command->add_flag("-q,--quiet", options->quiet, "Do not list the files")->group(group::kGeneral);
  add_service_address(*command, options->service);
  command->footer(
      "Images of a job file get the paths that it gives them, below the folder. The exit code is 0 only if "
      "every "
      "job was done. What there is of jobs that were cancelled or are incomplete is fetched too.\n\n"
      "Examples:\n"
      "  penumbra fetch 12 13 --wait -o out/ --to unix:/tmp/farm.socket");
  command->callback([options, &chosen] { chosen = [options] { return fetch(*options); }; });
}

}  // namespace penumbra
