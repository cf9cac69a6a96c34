// The command that a service calls as jobs and groups end, to send mail or to start what comes next.
#pragma once

#include <atomic>
#include <chrono>
#include <string>

#include "kernels/host/error.h"
#include "scheduler/service/job_queue.h"

namespace penumbra {

/// A command for a shell. Its fields stand for single words, inside quotes or outside:
///   {job}        the number of the job or group
///   {kind}       "job"; "frame" for a job of a group; "group"
///   {group}      the number of its group, or 0
///   {name}, {submitter}, {error}
///   {state}      see job_state_name
/// They become environment variables, PENUMBRA_NAME for {name}. So no text of a client is ever executed.
class EndHook {
 public:
  /// How long a command may take.
  static constexpr std::chrono::minutes kLimit{10};

  /// Error: an unknown field.
  static Expected<EndHook> make(const std::string& command);

  /// Runs the command and waits for its end. Errors: it fails, takes longer than kLimit, or is killed because
  /// `stop` becomes true.
  [[nodiscard]] Expected<void> call(const JobQueue::Ended& ended, const std::atomic<bool>& stop) const;

 private:
  explicit EndHook(std::string script) : script_(std::move(script)) {}

  std::string script_;
};

}  // namespace penumbra
