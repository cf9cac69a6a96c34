// A real Slurm on this machine: munged, slurmctld, and three slurmd of one core each. They use a folder and
// ports of their own. Jobs of the partition "preempted" give way to those of "all", the default.
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {

class SlurmCluster {
 public:
  static constexpr int kNodes = 3;  ///< n1, n2, n3

  /// Starts it and waits until its nodes are idle, some seconds at most; `why_not` says if they are not.
  SlurmCluster();
  SlurmCluster(const SlurmCluster&) = delete;
  SlurmCluster& operator=(const SlurmCluster&) = delete;
  /// Cancels what runs, and ends all processes.
  ~SlurmCluster();

  /// Why there is none here; empty if there is one.
  [[nodiscard]] const std::string& why_not() const { return why_not_; }
  /// What a Slurm command such as "squeue -h" prints; empty if it fails.
  std::string ask(const std::string& command) const;
  /// The processes of jobs, on that node or on all, whose command line contains the word.
  [[nodiscard]] std::vector<pid_t> processes(const std::string& word, const std::string& node = "") const;
  /// Kills the node's slurmd and whatever its jobs run, as a power failure would. Slurm notices after some 15
  /// s.
  void lose_node(const std::string& node);
  /// For the environment of programs that are to use it.
  [[nodiscard]] std::string configuration() const { return (folder_ / "slurm.conf").string(); }

 private:
  void start();
  std::string log_ends() const;

  TemporaryFolder folder_;
  std::string why_not_;
  std::vector<std::unique_ptr<Program>> daemons_;
};

}  // namespace penumbra
