#include "scheduler/service/job_queue.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "kernels/host/text.h"
#include "scheduler/protocol/text.h"
#include "scheduler/record/version.h"
#include "scheduler/service/status_wire.h"

namespace penumbra {
namespace {

constexpr std::size_t kMostJobs = 100'000;
constexpr std::size_t kLargestSubmission = std::size_t(1) << 20;   // without the names of its mattes
constexpr std::size_t kLargestMatteNames = std::size_t(16) << 20;  // in bytes; kept until the job is over
constexpr std::size_t kMostMessages = 20;
constexpr int kMostProblems = 20;                 // per job; the most recent ones
constexpr std::chrono::hours kSceneIsAwaited{1};  // how long a scene is kept until a job uses it

double seconds_since_1970() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

std::unexpected<JobError> job_error(JobErrorKind kind, std::string message) {
  return std::unexpected(JobError{kind, std::move(message)});
}

std::string_view state_words(wire::JobState state) {
  switch (state) {
    case wire::JOB_DONE:
      return "done";
    case wire::JOB_INCOMPLETE:
      return "over and incomplete";
    case wire::JOB_FAILED:
      return "over: it failed";
    case wire::JOB_CANCELLED:
      return "cancelled";
    default:
      return "not over";
  }
}

}  // namespace

bool is_over(const wire::JobStatus& job) {
  return job.state() != wire::JOB_QUEUED && job.state() != wire::JOB_RENDERING;
}

JobQueue::JobQueue(Spool& spool, std::vector<std::string>& problems) : spool_(spool) {
  for (wire::StoredJob& stored : spool.read_jobs(problems)) {
    const JobId number = stored.status().job();
    Entry& entry = entries_[number];
    entry.job = std::move(stored);
    wire::JobStatus& status = *entry.job.mutable_status();
    if (is_over(status)) {
      entry.stage = Stage::kOver;
      spool.remove_checkpoint(number, entry.job.submission());  // a killed service may have left it
    } else {
      status.set_state(wire::JOB_QUEUED);
    }
  }
  next_ = spool.next_number();
  if (problems.empty()) remove_scenes();  // otherwise an unreadable job may need them
}

bool JobQueue::has_checkpoint(const Entry& entry) const {
  std::error_code ignored;
  return std::filesystem::exists(spool_.checkpoint_of(entry.job.status().job(), entry.job.submission()),
                                 ignored);
}

// --- Requests of clients

JobExpected<JobQueue::Entry*> JobQueue::find(JobId job) {
  const auto found = entries_.find(job);
  if (found == entries_.end())
    return job_error(JobErrorKind::kNotFound, fmt::format("there is no job {}", job));
  return &found->second;
}

bool JobQueue::has_scene(const std::string& hash) {
  const std::lock_guard lock(mutex_);
  if (!spool_.has_scene(hash)) return false;
  scenes_that_came_[hash] = std::chrono::steady_clock::now();  // a job that uses it is expected soon
  return true;
}

void JobQueue::scene_came(const std::string& hash) {
  const std::lock_guard lock(mutex_);
  scenes_that_came_[hash] = std::chrono::steady_clock::now();
}

JobExpected<JobId> JobQueue::submit(const wire::Submission& message) {
  const std::size_t names = message.mattes().ByteSizeLong();
  if (names > kLargestMatteNames)
    return job_error(JobErrorKind::kNonsense,
                     fmt::format("names of objects and materials of more than {} bytes; submit it without "
                                 "--cryptomatte",
                                 kLargestMatteNames));
  if (message.ByteSizeLong() - names > kLargestSubmission)
    return job_error(JobErrorKind::kNonsense, fmt::format("a job of more than {} bytes", kLargestSubmission));
  if (const auto decoded = decode(message); !decoded)
    return job_error(JobErrorKind::kNonsense, decoded.error().message);
  const std::lock_guard lock(mutex_);
  if (!spool_.has_scene(message.scene()))
    return job_error(JobErrorKind::kNotNow,
                     fmt::format("the scene {} is not here (any more): send it first", message.scene()));
  if (entries_.size() >= kMostJobs)
    return job_error(JobErrorKind::kFull, fmt::format("there are {} already; remove some that are over",
                                                      counted(entries_.size(), "job")));
  const JobId number = next_;
  Entry entry;
  *entry.job.mutable_submission() = message;
  wire::JobStatus& status = *entry.job.mutable_status();
  status.set_job(number);
  status.set_name(wire_text(message.name(), kLongestName));
  status.set_priority(message.priority());
  status.set_submitted(seconds_since_1970());
  status.set_relative_error(std::numeric_limits<double>::quiet_NaN());
  Expected<void> kept = spool_.use_number(number);
  if (kept) kept = spool_.keep(entry.job);
  if (!kept) {
    spool_.remove(number);
    return job_error(JobErrorKind::kFull, "the job cannot be kept: " + kept.error().message);
  }
  ++next_;
  entries_.emplace(number, std::move(entry));
  changed_.notify_all();
  return number;
}

JobExpected<wire::StatusReply> JobQueue::status(const std::vector<JobId>& jobs) {
  const std::lock_guard lock(mutex_);
  wire::StatusReply reply;
  reply.set_version(std::string(kVersion));
  reply.set_up_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count());
  reply.set_now(seconds_since_1970());
  for (const FarmWorker& worker : workers_) *reply.add_workers() = encode(worker);
  for (const std::string& message : messages_) reply.add_messages(message);
  if (jobs.empty())
    for (const auto& [number, entry] : entries_) {
      *reply.add_jobs() = entry.job.status();
      // For many jobs they might exceed the size of a message.
      reply.mutable_jobs()->rbegin()->clear_problems();
    }
  for (const JobId job : std::set<JobId>(jobs.begin(), jobs.end())) {
    const auto found = find(job);
    if (!found) return std::unexpected(found.error());
    *reply.add_jobs() = (*found)->job.status();
  }
  return reply;
}

JobExpected<void> JobQueue::cancel(JobId job) {
  const std::lock_guard lock(mutex_);
  const auto found = find(job);
  if (!found) return std::unexpected(found.error());
  Entry& entry = **found;
  if (entry.stage == Stage::kOver || entry.stage == Stage::kWriting)
    return job_error(JobErrorKind::kNotNow,
                     fmt::format("job {} is {}", job,
                                 entry.stage == Stage::kWriting ? "over: its files are being written"
                                                                : state_words(entry.job.status().state())));
  entry.job.set_cancelled(true);
  if (entry.stage == Stage::kOpen) changes_.emplace_back(CancelJob{job});
  // If an earlier service has rendered a part of it, its files are written when its turn comes.
  if (entry.stage == Stage::kWaiting && !has_checkpoint(entry))
    end(entry, wire::JOB_CANCELLED, "cancelled before it began");
  else
    keep(entry);
  return {};
}

JobExpected<void> JobQueue::set_priority(JobId job, int priority) {
  const std::lock_guard lock(mutex_);
  const auto found = find(job);
  if (!found) return std::unexpected(found.error());
  Entry& entry = **found;
  if (entry.stage == Stage::kOver)
    return job_error(JobErrorKind::kNotNow,
                     fmt::format("job {} is {}", job, state_words(entry.job.status().state())));
  entry.job.mutable_status()->set_priority(priority);
  entry.job.mutable_submission()->set_priority(priority);
  if (entry.stage == Stage::kOpen) changes_.emplace_back(PriorityChanged{job, priority});
  keep(entry);
  changed_.notify_all();
  return {};
}

JobExpected<void> JobQueue::remove(JobId job) {
  const std::lock_guard lock(mutex_);
  const auto found = find(job);
  if (!found) return std::unexpected(found.error());
  if ((*found)->stage != Stage::kOver)
    return job_error(JobErrorKind::kNotNow, fmt::format("job {} is not over; cancel it first", job));
  spool_.remove(job);
  entries_.erase(job);
  return {};
}

JobExpected<std::filesystem::path> JobQueue::file(JobId job, const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto found = find(job);
  if (!found) return std::unexpected(found.error());
  for (const wire::StoredFile& file : (*found)->job.status().files())
    if (file.name() == name) return spool_.folder_of(job) / name;
  return job_error(JobErrorKind::kNotFound,
                   fmt::format("job {} has no file '{}'", job, wire_text(name, kLongestName)));
}

// --- For the service itself

JobQueue::Entries::iterator JobQueue::best() {
  auto best = entries_.end();
  for (auto at = entries_.begin(); at != entries_.end(); ++at)
    if (at->second.stage == Stage::kWaiting &&
        (best == entries_.end() || at->second.job.status().priority() > best->second.job.status().priority()))
      best = at;
  return best;
}

bool JobQueue::may_begin(const Entry& entry, int at_once, int at_most) const {
  int under_way = 0;
  bool is_most_urgent = true;
  for (const auto& [number, other] : entries_) {
    if (other.stage != Stage::kPreparing && other.stage != Stage::kOpen) continue;
    ++under_way;
    if (other.job.status().priority() >= entry.job.status().priority()) is_most_urgent = false;
  }
  return under_way < at_once || (is_most_urgent && under_way < at_most);
}

std::optional<JobQueue::Taken> JobQueue::take(int at_once, int at_most) {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (closed_) return {};
    const auto found = best();
    if (found == entries_.end() || !may_begin(found->second, at_once, at_most)) {
      changed_.wait(lock);
      continue;
    }
    auto submission = decode(found->second.job.submission());
    if (!submission) {  // written by another version of this program
      end(found->second, wire::JOB_FAILED, submission.error().message);
      continue;
    }
    found->second.stage = Stage::kPreparing;
    return Taken{found->first, std::move(*submission)};
  }
}

bool JobQueue::open(JobId job) {
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_.at(job);
  if (entry.job.cancelled()) return false;
  entry.stage = Stage::kOpen;
  // The priority may have changed since the farm got its copy.
  changes_.emplace_back(PriorityChanged{job, entry.job.status().priority()});
  return true;
}

void JobQueue::progress(JobId job, const RenderProgress& progress) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(job);
  if (found == entries_.end()) return;
  wire::JobStatus& status = *found->second.job.mutable_status();
  if (status.state() == wire::JOB_QUEUED && progress.elapsed_seconds > 0) {  // its first unit has been issued
    status.set_state(wire::JOB_RENDERING);
    if (status.begun() == 0) status.set_begun(seconds_since_1970() - progress.elapsed_seconds);
  }
  put_progress(progress, status);
}

void JobQueue::workers(const std::vector<FarmWorker>& workers) {
  const std::lock_guard lock(mutex_);
  workers_ = workers;
}

void JobQueue::say(const std::string& message) {
  const std::lock_guard lock(mutex_);
  tell(message);
}

void JobQueue::tell(std::string message) {
  messages_.push_back(wire_text(message, kLongestText));
  if (messages_.size() > kMostMessages) messages_.pop_front();
}

void JobQueue::problem(JobId job, const std::string& text) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(job);
  if (found == entries_.end()) return;
  auto& problems = *found->second.job.mutable_status()->mutable_problems();
  if (problems.size() >= kMostProblems) problems.erase(problems.begin());
  *problems.Add() = wire_text(text, kLongestText);
}

bool JobQueue::begin_writing(JobId job) {
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_.at(job);
  entry.stage = Stage::kWriting;
  changed_.notify_all();
  return entry.job.cancelled();
}

void JobQueue::end(JobId job, wire::JobState state, const std::string& error) {
  const std::lock_guard lock(mutex_);
  end(entries_.at(job), state, error);
}

void JobQueue::end(Entry& entry, wire::JobState state, const std::string& error) {
  entry.stage = Stage::kOver;
  wire::JobStatus& status = *entry.job.mutable_status();
  status.set_state(state);
  status.set_error(wire_text(error, kLongestText));
  status.set_ended(seconds_since_1970());
  status.set_workers(0);
  entry.job.mutable_submission()->clear_mattes();
  status.clear_files();
  for (const std::string& name : entry.job.submission().files()) {
    std::error_code missing;
    const std::uintmax_t bytes = std::filesystem::file_size(spool_.folder_of(status.job()) / name, missing);
    if (missing) continue;
    status.add_files()->set_name(name);
    status.mutable_files()->rbegin()->set_bytes(bytes);
  }
  keep(entry);
  remove_scenes();
  changed_.notify_all();
}

void JobQueue::put_back(JobId job) {
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_.at(job);
  entry.stage = Stage::kWaiting;
  entry.job.mutable_status()->set_state(wire::JOB_QUEUED);
  keep(entry);
  changed_.notify_all();
}

std::vector<JobChange> JobQueue::take_changes() {
  const std::lock_guard lock(mutex_);
  return std::exchange(changes_, {});
}

void JobQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

void JobQueue::keep(const Entry& entry) {
  if (const auto kept = spool_.keep(entry.job); !kept)
    tell(fmt::format("job {} cannot be kept on disk: {}", entry.job.status().job(), kept.error().message));
}

void JobQueue::remove_scenes() {
  const auto now = std::chrono::steady_clock::now();
  std::erase_if(scenes_that_came_, [&](const auto& scene) { return now - scene.second > kSceneIsAwaited; });
  std::set<std::string> used;
  for (const auto& [hash, when] : scenes_that_came_) used.insert(hash);
  for (const auto& [number, entry] : entries_)
    if (entry.stage != Stage::kOver) used.insert(entry.job.submission().scene());
  spool_.remove_other_scenes(used);
}

}  // namespace penumbra
