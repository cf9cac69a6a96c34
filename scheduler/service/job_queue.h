// The jobs of a service: requests of its clients, and the state of each job.
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

/// The kind of an error of a client's request.
enum class JobErrorKind { kNonsense, kNotFound, kNotNow, kFull };
struct JobError {
  JobErrorKind kind;
  std::string message;
};
template <typename T>
using JobExpected = std::expected<T, JobError>;

/// Whether the job's state is final.
[[nodiscard]] bool is_over(const wire::JobStatus& job);

/// The queue of jobs. Thread-safe. An accepted job is on disk. A job that is being rendered when the process
/// ends is queued again by the next process, which resumes from its checkpoint.
class JobQueue {
 public:
  /// Reads the jobs in the spool and removes scenes that no job needs. `problems` receives what is wrong with
  /// the spool.
  JobQueue(Spool& spool, std::vector<std::string>& problems);

  // --- Requests of clients

  [[nodiscard]] bool has_scene(const std::string& hash);
  /// A scene was added to the spool. It is kept for a while, until a job that uses it arrives.
  void scene_came(const std::string& hash);
  JobExpected<JobId> submit(const wire::Submission& message);
  /// The status of these jobs, or of all if the list is empty. Error: there is no such job.
  JobExpected<wire::StatusReply> status(const std::vector<JobId>& jobs);
  JobExpected<void> cancel(JobId job);
  JobExpected<void> set_priority(JobId job, int priority);
  /// Removes a job and its files.
  JobExpected<void> remove(JobId job);
  /// The path of a job's file.
  JobExpected<std::filesystem::path> file(JobId job, const std::string& name);

  // --- For the service itself

  struct Taken {
    JobId job = 0;
    Submission submission;
  };
  /// The next job to be prepared: the queued one with the highest priority, then the oldest. Waits until
  /// there is one, and until at most `at_once` jobs are active, or, if it has a higher priority than those,
  /// at most `at_most`. Nothing once the queue is closed.
  std::optional<Taken> take(int at_once, int at_most);
  /// The farm has taken the job. Returns false if it was cancelled before; it must then end with what has
  /// been rendered.
  bool open(JobId job);
  void progress(JobId job, const RenderProgress& progress);
  void workers(const std::vector<FarmWorker>& workers);
  void say(const std::string& message);
  void problem(JobId job, const std::string& text);
  /// The farm is done with the job and its files are being written, so it cannot be cancelled any more.
  /// Returns whether it was cancelled.
  bool begin_writing(JobId job);
  /// The job is over. Its files are those in its folder.
  void end(JobId job, wire::JobState state, const std::string& error);
  /// Queues the job again.
  void put_back(JobId job);
  /// The changes that clients requested for open jobs since the last call.
  [[nodiscard]] std::vector<JobChange> take_changes();
  /// From now on take() returns nothing.
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
