// What the service itself asks of its queue: the next job, and what became of jobs.
#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "kernels/host/process.h"
#include "scheduler/service/job_queue.h"
#include "scheduler/service/status_wire.h"
#include "worker/protocol/text.h"

namespace penumbra {
namespace {

constexpr std::size_t kMostMessages = 20;
constexpr int kMostProblems = 20;  // per job; the most recent ones
// How long a scene is kept until a job uses it, and a group until its next job comes.
constexpr std::chrono::hours kSubmissionIsAwaited{1};
constexpr std::chrono::minutes kLongestWaitForAnEnd{1};

/// Whether the job did not get all its samples or images, though nobody cancelled it.
bool has_failed(const wire::JobStatus& job) {
  return job.state() == wire::JOB_FAILED || job.state() == wire::JOB_INCOMPLETE;
}

}  // namespace

// --- Which job is next

bool JobQueue::is_whole(const Group& group) {
  const double age = unix_time() - group.stored.latest();
  return group.stored.whole() || age > std::chrono::duration<double>(kSubmissionIsAwaited).count();
}

bool JobQueue::is_over(const Group& group) const {
  return is_whole(group) && std::ranges::all_of(group.jobs, [this](JobId job) {
           return entries_.at(job).stage == Stage::kOver;
         });
}

bool JobQueue::is_rendered(const Group& group) const {
  return is_whole(group) && std::ranges::all_of(group.jobs, [this](JobId job) {
           const Stage stage = entries_.at(job).stage;
           return stage == Stage::kAwaitsFrames || stage == Stage::kOver;
         });
}

/// A job that was removed was over; if it was not done, those that come after it have failed then.
JobQueue::Readiness JobQueue::readiness_of(JobId number) {
  const auto group = groups_.find(number);
  bool waits = group != groups_.end() && !is_whole(group->second);
  if (const auto jobs = find(number))
    for (const Entry* entry : *jobs) {
      if (entry->stage != Stage::kOver)
        waits = true;
      else if (entry->job.status().state() != wire::JOB_DONE)
        return Readiness::kNever;
    }
  return waits ? Readiness::kWaits : Readiness::kReady;
}

JobQueue::Readiness JobQueue::readiness(const Entry& entry, std::map<JobId, Readiness>& known) {
  if (entry.job.cancelled()) return Readiness::kReady;  // what is rendered of it is to be written
  Readiness worst = Readiness::kReady;
  for (const JobId before : entry.job.status().after()) {
    const auto [found, is_new] = known.try_emplace(before);
    if (is_new) found->second = readiness_of(before);
    worst = std::max(worst, found->second);
  }
  return worst;
}

/// Ends jobs that come after one that is over and not done; and those after them.
void JobQueue::fail_hopeless() {
  for (bool changed = true; changed;) {
    changed = false;
    std::map<JobId, Readiness> known;
    for (auto& [number, entry] : entries_) {
      if (entry.stage != Stage::kWaiting || readiness(entry, known) != Readiness::kNever) continue;
      const auto failed = std::ranges::find_if(
          entry.job.status().after(), [&](JobId before) { return known.at(before) == Readiness::kNever; });
      end(entry, wire::JOB_FAILED,
          fmt::format(
              "not begun, because {} {}, after which it comes, is not done; `penumbra retry {}` queues "
              "both again",
              groups_.contains(*failed) ? "group" : "job", *failed, *failed));
      changed = true;
      known.clear();
    }
  }
}

JobQueue::Entries::iterator JobQueue::best() {
  std::map<std::string, int> active;
  for (const auto& [number, entry] : entries_) active[entry.job.status().submitter()] += entry.is_active();
  const auto key = [&](const Entry& entry) {
    const wire::JobStatus& job = entry.job.status();
    return std::tuple(-std::int64_t(job.priority()), active.at(job.submitter()), turns_[job.submitter()]);
  };
  std::map<JobId, Readiness> known;
  auto best = entries_.end();
  for (auto at = entries_.begin(); at != entries_.end(); ++at)
    if (at->second.stage == Stage::kWaiting &&
        (best == entries_.end() || key(at->second) < key(best->second)) &&
        readiness(at->second, known) == Readiness::kReady)
      best = at;
  return best;
}

bool JobQueue::may_begin(const Entry& entry, int at_once, int at_most) const {
  const wire::JobStatus& job = entry.job.status();
  int under_way = 0;
  bool goes_first = true;
  for (const auto& [number, other] : entries_) {
    if (!other.is_active()) continue;
    ++under_way;
    const wire::JobStatus& status = other.job.status();
    const bool is_equal = status.priority() == job.priority() && status.submitter() == job.submitter();
    if (status.priority() > job.priority() || is_equal) goes_first = false;
  }
  return under_way < at_once || (goes_first && under_way < at_most);
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
      settle();
      continue;
    }
    found->second.stage = Stage::kPreparing;
    turns_[found->second.job.status().submitter()] = ++turn_;
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

void JobQueue::await_frames(JobId job) {
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_.at(job);
  entry.stage = Stage::kAwaitsFrames;
  entry.job.set_whole(true);
  settle();
}

std::optional<std::vector<JobQueue::FrameImage>> JobQueue::frames_beside(JobId job) {
  const std::lock_guard lock(mutex_);
  const Entry& own = entries_.at(job);
  const wire::FramesBeside& beside = own.job.submission().beside();
  const auto group = groups_.find(own.job.status().group());
  std::vector<FrameImage> images;
  for (const int frame : beside.frames()) {
    if (group == groups_.end()) break;
    const auto found = std::ranges::find_if(group->second.jobs, [&](JobId other) {
      const wire::Submission& submission = entries_.at(other).job.submission();
      return submission.has_beside() && submission.beside().shot() == beside.shot() &&
             submission.frame() == frame;
    });
    if (found == group->second.jobs.end()) {
      if (!is_whole(group->second)) return {};
      continue;
    }
    const Entry& other = entries_.at(*found);
    if (other.stage != Stage::kOver && other.stage != Stage::kAwaitsFrames) return {};
    // A frame that gets another try is queued again once the whole group is rendered.
    if (has_failed(other.job.status()) && !other.job.tried_again() && !is_rendered(group->second)) return {};
    if (!other.job.whole()) continue;
    const auto& files = other.job.submission().files();
    const auto exr =
        std::ranges::find_if(files, [](const std::string& name) { return name.ends_with(".exr"); });
    images.push_back({frame, spool_.folder_of(*found) / *exr});
  }
  return images;
}

void JobQueue::end(JobId job, wire::JobState state, const std::string& error) {
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_.at(job);
  end(entry, state, error);
  settle();
}

void JobQueue::settle() {
  const auto try_again = [this] {
    for (const auto& [number, group] : groups_) try_frames_again(group);
  };
  try_again();  // first, so that what comes after such a frame waits on
  fail_hopeless();
  try_again();  // groups that are over only now
}

/// What hindered a frame may have passed when all others are over. Where none has succeeded, another try
/// would not either.
void JobQueue::try_frames_again(const Group& group) {
  if (!is_rendered(group)) return;
  if (std::ranges::none_of(group.jobs, [this](JobId job) {
        const Entry& entry = entries_.at(job);
        return entry.job.status().state() == wire::JOB_DONE || entry.stage == Stage::kAwaitsFrames;
      }))
    return;
  for (const JobId job : group.jobs) {
    Entry& entry = entries_.at(job);
    const wire::JobStatus& status = entry.job.status();
    if (!has_failed(status) || !status.has_frame() || entry.job.tried_again()) continue;
    std::map<JobId, Readiness> known;
    if (readiness(entry, known) == Readiness::kNever) continue;  // what is before it has had its other try
    entry.job.set_tried_again(true);
    queue_again(entry);
  }
}

void JobQueue::end(Entry& entry, wire::JobState state, const std::string& error) {
  entry.stage = Stage::kOver;
  wire::JobStatus& status = *entry.job.mutable_status();
  status.set_state(state);
  status.set_error(wire_text(error, kLongestText));
  status.set_ended(unix_time());
  status.set_workers(0);
  if (state == wire::JOB_DONE) entry.job.mutable_submission()->clear_mattes();
  entry.job.set_untold(tells_ends_);
  if (const auto group = groups_.find(status.group()); group != groups_.end())
    if (group->second.stored.untold() != tells_ends_) {
      group->second.stored.set_untold(tells_ends_);
      keep(group->second);
    }
  status.clear_files();
  for (const std::string& name : entry.job.submission().files())
    add_file(spool_.folder_of(status.job()) / name, status);
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

// --- Ends

std::optional<JobQueue::Ended> JobQueue::untold_end() {
  Ended ended;
  for (auto& [number, entry] : entries_)
    if (entry.stage == Stage::kOver && entry.job.untold()) {
      ended.number = number;
      add({&entry}, ended.status);
      entry.job.set_untold(false);
      return ended;
    }
  for (auto& [number, group] : groups_)
    if (group.stored.untold() && is_over(group)) {
      ended.number = number;
      ended.is_group = true;
      add(*find(number), ended.status);
      group.stored.set_untold(false);
      return ended;
    }
  return {};
}

std::optional<JobQueue::Ended> JobQueue::wait_for_end() {
  std::unique_lock lock(mutex_);
  const auto deadline = std::chrono::steady_clock::now() + kLongestWaitForAnEnd;
  for (;;) {
    if (closed_) return {};
    if (auto ended = untold_end()) return ended;
    if (changed_.wait_until(lock, deadline) == std::cv_status::timeout) return {};
  }
}

void JobQueue::told(const Ended& ended) {
  const std::lock_guard lock(mutex_);
  if (const auto group = groups_.find(ended.number); group != groups_.end()) keep(group->second);
  if (const auto found = entries_.find(ended.number); found != entries_.end()) keep(found->second);
}

std::vector<JobId> JobQueue::remove_older_than(double seconds) {
  const std::lock_guard lock(mutex_);
  const auto has_expired = [&](JobId job) {
    const Entry& entry = entries_.at(job);
    return entry.stage == Stage::kOver && unix_time() - entry.job.status().ended() > seconds;
  };
  std::vector<JobId> expired;
  for (const auto& [number, entry] : entries_) {
    const auto group = groups_.find(entry.job.status().group());
    if (group == groups_.end()
            ? has_expired(number)
            : is_whole(group->second) && std::ranges::all_of(group->second.jobs, has_expired))
      expired.push_back(number);
  }
  for (const JobId job : expired) forget(job);
  if (!expired.empty()) remove_scenes();
  return expired;
}

// --- On disk

void JobQueue::keep(const Entry& entry) {
  if (const auto kept = spool_.keep(entry.job); !kept)
    tell(fmt::format("job {} cannot be kept on disk: {}", entry.job.status().job(), kept.error().message));
}

void JobQueue::keep(const Group& group) {
  if (const auto kept = spool_.keep(group.stored); !kept)
    tell(fmt::format("group {} cannot be kept on disk: {}", group.stored.group().number(),
                     kept.error().message));
}

/// Scenes of jobs that are not done are kept for `penumbra retry`.
void JobQueue::remove_scenes() {
  const auto present = std::chrono::steady_clock::now();
  std::erase_if(scenes_that_came_,
                [&](const auto& scene) { return present - scene.second > kSubmissionIsAwaited; });
  std::set<std::string> used;
  for (const auto& [hash, when] : scenes_that_came_) used.insert(hash);
  for (const auto& [number, entry] : entries_)
    if (entry.job.status().state() != wire::JOB_DONE) used.insert(entry.job.submission().scene());
  spool_.remove_other_scenes(used);
}

}  // namespace penumbra
