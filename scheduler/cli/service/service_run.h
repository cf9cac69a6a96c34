// The main loop of a service: takes jobs from the queue, renders them, and stores the results.
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>

#include "worker/cli/exit_code.h"

namespace penumbra {

struct ServiceOptions {
  std::string listen;           ///< address for clients, viewers and workers on other hosts
  std::string keys;             ///< folder of keys for `listen`; see listening_keys; empty: none
  std::string web;              ///< address of the page in the browser; empty: none
  std::filesystem::path spool;  ///< see Spool
  int workers = 1;              ///< local worker processes; 0: other workers join
  int threads = 0;              ///< per worker; 0: all cores of this machine, divided among the workers
  double checkpoint_interval = 0;
  std::string on_done;         ///< shell command for the end of jobs and groups; see EndHook; empty: none
  bool own_jobs = false;       ///< jobs are changed only by who submitted them
  std::optional<double> keep;  ///< seconds after which jobs that are over are removed
};

/// Runs until `stop` becomes true or no worker is left. Unfinished jobs stay in the queue, and the next
/// service with the same spool resumes them.
ExitCode run_service(const ServiceOptions& options, const std::atomic<bool>& stop);

}  // namespace penumbra
