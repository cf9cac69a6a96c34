// All jobs of a service: what its clients ask of them, and what becomes of them.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/farm/render_farm.h"
#include "scheduler/service/spool.h"
#include "scheduler/service/submission.h"

namespace penumbra {

/// Errors of what clients ask have one of these kinds.
enum class JobErrorKind { kNonsense, kNotFound, kNotNow, kFull };
struct JobError {
  JobErrorKind kind;
  std::string message;
};
template <typename T>
using JobExpected = std::expected<T, JobError>;

/// Whether nothing more will become of it.
[[nodiscard]] bool is_over(const wire::JobStatus& job);

/// Thread-safe. A job that has been accepted is on disk; one that is being rendered when the process ends is
/// queued again by the next one, which goes on with its checkpoint.
class JobQueue {
 public:
  /// Takes up what is in the spool, and removes scenes that nobody needs. `problems`: what is wrong there.
  JobQueue(Spool& spool, std::vector<std::string>& problems);

  // --- Of clients

  [[nodiscard]] bool has_scene(const std::string& hash);
  /// A scene has been put into the spool; it is kept for a while, until a job with it comes.
  void scene_came(const std::string& hash);
  JobExpected<JobId> submit(const wire::Submission& message);
  /// Of these jobs, or of all. Error: there is no such job.
  JobExpected<wire::StatusReply> status(const std::vector<JobId>& jobs);
  JobExpected<void> cancel(JobId job);
  JobExpected<void> set_priority(JobId job, int priority);
  /// With its files.
  JobExpected<void> remove(JobId job);
  /// The path of one of its files.
  JobExpected<std::filesystem::path> file(JobId job, const std::string& name);

  // --- Of the service itself

  struct Taken {
    JobId job = 0;
    Submission submission;
  };
  /// The next one to be prepared: of the queued ones that with the highest priority, then the oldest. Waits
  /// until there is one, and until no more than `at_once` are under way, or it is more urgent than those and
  /// no more than `at_most`. Nothing once the queue is closed.
  std::optional<Taken> take(int at_once, int at_most);
  /// The farm has it. False if it was cancelled before: it is to end now, with what there is of it.
  bool open(JobId job);
  void progress(JobId job, const RenderProgress& progress);
  void workers(const std::vector<FarmWorker>& workers);
  void say(const std::string& message);
  void problem(JobId job, const std::string& text);
  /// The farm is done with it; its files are being written, so that it cannot be cancelled any more. Whether
  /// it was.
  bool begin_writing(JobId job);
  /// It is over. The files are those of its folder.
  void end(JobId job, wire::JobState state, const std::string& error);
  /// It goes back to those that wait.
  void put_back(JobId job);
  /// What clients have asked of open jobs since the last call.
  [[nodiscard]] std::vector<JobChange> take_changes();
  /// take() returns nothing from here on.
  void close();

 private:
  enum class Stage { kWaiting, kPreparing, kOpen, kWriting, kOver };
  struct Entry {
    wire::StoredJob job;
    Stage stage = Stage::kWaiting;
  };
  using Entries = std::map<JobId, Entry>;

  [[nodiscard]] JobExpected<Entry*> find(JobId job);
  [[nodiscard]] Entries::iterator best();
  [[nodiscard]] bool has_checkpoint(const Entry& entry) const;
  [[nodiscard]] bool may_begin(const Entry& entry, int at_once, int at_most) const;
  void keep(const Entry& entry);
  void end(Entry& entry, wire::JobState state, const std::string& error);
  void remove_scenes();
  void tell(std::string message);

  Spool& spool_;
  const std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
  std::condition_variable changed_;
  Entries entries_;
  JobId next_ = 1;
  bool closed_ = false;
  std::vector<JobChange> changes_;
  std::vector<FarmWorker> workers_;
  std::deque<std::string> messages_;
  std::map<std::string, std::chrono::steady_clock::time_point> scenes_that_came_;
};

}  // namespace penumbra
