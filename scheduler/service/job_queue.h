// The jobs of a service: requests of its clients, and the state of each job.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <expected>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "scheduler/farm/render_farm.h"
#include "scheduler/service/spool.h"
#include "scheduler/service/submission.h"

namespace penumbra {

/// The kind of an error of a client's request.
enum class JobErrorKind { kNonsense, kNotFound, kNotNow, kFull, kNotYours };
struct JobError {
  JobErrorKind kind;
  std::string message;
};
template <typename T>
using JobExpected = std::expected<T, JobError>;

/// Whether the job's state is final.
[[nodiscard]] bool is_over(const wire::JobStatus& job);

/// The queue of jobs. Thread-safe. An accepted job is on disk. A job that is being rendered when the process
/// ends is queued again by the next process, which resumes from its checkpoint. Jobs and groups of jobs are
/// numbered together; where a request takes a number, that of a group stands for all its jobs.
class JobQueue {
 public:
  /// Reads the jobs in the spool and removes scenes that no job needs. `problems` receives what is wrong with
  /// the spool. `tells_ends`: see wait_for_end().
  JobQueue(Spool& spool, std::vector<std::string>& problems, bool tells_ends = false);

  // --- Requests of clients
  /// Whether the scene is stored. If it is, it is kept until a job that is submitted soon uses it.
  bool has_scene(const std::string& hash);
  /// A scene has been received; a job that uses it is expected soon.
  void scene_came(const std::string& hash);
  struct Submitted {
    JobId job = 0, group = 0;  ///< group 0: none
  };
  /// Errors: an invalid submission, a scene that is not stored, an unknown, cancelled or foreign group, an
  /// unknown job or group to come after, too many jobs, a full disk, no owner (see own_jobs).
  JobExpected<Submitted> submit(const wire::Submission& message);
  /// The status of these jobs, or of all if the list is empty. Error: there is no such job.
  JobExpected<wire::StatusReply> status(const std::vector<JobId>& numbers);
  // Of a group, these change the jobs that can be changed. `owner`: the secret of who asks. Errors: none can
  // be changed; it is not the owner's (see own_jobs).
  JobExpected<void> cancel(JobId number, const std::string& owner = {});
  JobExpected<void> set_priority(JobId number, int priority, const std::string& owner = {});
  /// Queues jobs again that are over but not done, and those that failed because they come after them. They
  /// continue from their checkpoints.
  JobExpected<void> retry(JobId number, const std::string& owner = {});
  /// Removes jobs that are over, and their files.
  JobExpected<void> remove(JobId number, const std::string& owner = {});
  /// All jobs of the group have been submitted.
  JobExpected<void> close_group(JobId group, const std::string& owner = {});
  /// From now on jobs are changed, and groups get more jobs, only by who shows the secret that they, or all
  /// jobs of the group, were submitted with; and jobs without a secret are refused.
  void own_jobs() { own_jobs_ = true; }
  /// The path of a job's file.
  JobExpected<std::filesystem::path> file(JobId job, const std::string& name);

  // --- For the service itself, in job_queue_run.cpp

  struct Taken {
    JobId job = 0;
    Submission submission;
  };
  /// The next job to be prepared: of those that wait for no other job the one with the highest priority;
  /// among equals one of the submitter with the fewest active jobs, whose turn was the longest ago; then the
  /// oldest. Waits until there is one, and until at most `at_once` jobs are active, or, if it has a higher
  /// priority than those or is the only one of its submitter, at most `at_most`. Nothing once the queue is
  /// closed.
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
  /// The job is rendered, and its image has all its samples; it is a frame that is denoised once those beside
  /// it are there.
  void await_frames(JobId job);
  struct FrameImage {
    int frame = 0;
    std::filesystem::path exr;
  };
  /// The images with which such a frame is denoised: of the frames beside it that have one. Nothing while
  /// more may come.
  [[nodiscard]] std::optional<std::vector<FrameImage>> frames_beside(JobId job);
  /// The job is over. Its files are those in its folder. Jobs that come after it can begin, or fail too.
  void end(JobId job, wire::JobState state, const std::string& error);
  /// Queues the job again.
  void put_back(JobId job);
  /// The changes that clients requested for open jobs since the last call.
  [[nodiscard]] std::vector<JobChange> take_changes();
  /// From now on take() and wait_for_end() return nothing.
  void close();

  /// A job, or a group of which all jobs are over, whose end has not been told yet. Nothing after a minute,
  /// or once the queue is closed. The next process returns it again, unless told() was called.
  struct Ended {
    JobId number = 0;
    bool is_group = false;
    wire::StatusReply status;  ///< of it alone
  };
  [[nodiscard]] std::optional<Ended> wait_for_end();
  void told(const Ended& ended);
  /// Removes jobs that have been over for so long, those of a group together. Returns their numbers.
  std::vector<JobId> remove_older_than(double seconds);

 private:
  enum class Stage {
    kWaiting,
    kPreparing,
    kOpen,
    kWriting,
    kAwaitsFrames,  ///< see await_frames()
    kOver
  };
  struct Entry {
    wire::StoredJob job;
    Stage stage = Stage::kWaiting;

    [[nodiscard]] JobId number() const { return job.status().job(); }
    [[nodiscard]] bool is_active() const { return stage == Stage::kPreparing || stage == Stage::kOpen; }
  };
  using Entries = std::map<JobId, Entry>;
  struct Group {
    wire::StoredGroup stored;
    std::set<JobId> jobs;
  };
  /// Whether what a job comes after is done; whether it never will be.
  enum class Readiness { kReady, kWaits, kNever };

  [[nodiscard]] JobExpected<std::vector<Entry*>> find(JobId number);
  /// Error also if they are not this owner's and must be.
  [[nodiscard]] JobExpected<std::vector<Entry*>> find_own(JobId number, const std::string& owner);
  template <typename Change>
  JobExpected<void> change(JobId number, const std::string& owner, const Change& change);
  [[nodiscard]] JobExpected<void> check(const wire::Submission& message);
  void add(const std::vector<Entry*>& entries, wire::StatusReply& reply) const;
  [[nodiscard]] static bool is_whole(const Group& group);
  [[nodiscard]] bool is_over(const Group& group) const;
  /// Whether all its jobs are rendered or over.
  [[nodiscard]] bool is_rendered(const Group& group) const;
  [[nodiscard]] Readiness readiness_of(JobId number);
  /// `known`: what readiness_of() has answered so far.
  [[nodiscard]] Readiness readiness(const Entry& entry, std::map<JobId, Readiness>& known);
  void fail_hopeless();
  /// After jobs have ended: ends those that are hopeless, and queues frames again.
  void settle();
  void queue_again(Entry& entry);
  /// Once all jobs of the group are rendered or over, queues those frames again that failed, each once.
  void try_frames_again(const Group& group);
  void forget(JobId job);
  [[nodiscard]] std::optional<Ended> untold_end();

  [[nodiscard]] Entries::iterator best();
  [[nodiscard]] bool has_checkpoint(const Entry& entry) const;
  [[nodiscard]] bool may_begin(const Entry& entry, int at_once, int at_most) const;
  void keep(const Entry& entry);
  void keep(const Group& group);
  void make_whole(Group& group);
  void end(Entry& entry, wire::JobState state, const std::string& error);
  void remove_scenes();
  void tell(std::string message);

  Spool& spool_;
  const bool tells_ends_;
  bool own_jobs_ = false;  // set before clients connect
  const std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
  std::condition_variable changed_;
  Entries entries_;
  std::map<JobId, Group> groups_;
  JobId next_ = 1;
  bool closed_ = false;
  std::uint64_t turn_ = 0;
  std::map<std::string, std::uint64_t> turns_;  // of each submitter the turn in which a job of it was taken
  std::vector<JobChange> changes_;
  std::vector<FarmWorker> workers_;
  std::deque<std::string> messages_;
  /// By hash, once for each job that is expected.
  std::multimap<std::string, std::chrono::steady_clock::time_point> scenes_that_came_;
};

}  // namespace penumbra
