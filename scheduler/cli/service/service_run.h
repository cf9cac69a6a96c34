// What a service does all day: takes jobs from its queue, has them rendered, and keeps what comes of them.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include "scheduler/cli/exit_code.h"

namespace penumbra {

struct ServiceOptions {
  std::string listen;           ///< where clients, viewers and foreign workers reach it
  std::filesystem::path spool;  ///< see Spool
  int workers = 1;              ///< processes here; 0: others join
  int threads = 0;              ///< of each worker; 0: all cores of this machine shared out among the workers
  double checkpoint_interval = 0;
};

/// Until `stop`, or until no worker is left. What is not done then is queued, and goes on where it was when
/// the next service has the same spool.
ExitCode run_service(const ServiceOptions& options, const std::atomic<bool>& stop);

}  // namespace penumbra
