#include "scheduler/service/job_queue.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "kernels/host/process.h"
#include "kernels/host/text.h"
#include "scheduler/record/version.h"
#include "scheduler/service/status_wire.h"
#include "worker/keys/secrets.h"
#include "worker/protocol/text.h"

namespace penumbra {
namespace {

constexpr std::size_t kMostJobs = 100'000;
constexpr std::size_t kLargestSubmission = std::size_t(1) << 20;   // without the names of its mattes
constexpr std::size_t kLargestMatteNames = std::size_t(16) << 20;  // in bytes; kept until the job is done
constexpr std::size_t kMostJobsWithProblems = 20;                  // of a reply

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

JobQueue::JobQueue(Spool& spool, std::vector<std::string>& problems, bool tells_ends)
    : spool_(spool), tells_ends_(tells_ends) {
  for (wire::StoredGroup& stored : spool.read_groups(problems)) {
    Group& group = groups_[stored.group().number()];
    group.stored = std::move(stored);
    group.stored.set_whole(true);  // who submitted it was told that this service has gone
  }
  for (wire::StoredJob& stored : spool.read_jobs(problems)) {
    const JobId number = stored.status().job();
    Entry& entry = entries_[number];
    entry.job = std::move(stored);
    wire::JobStatus& status = *entry.job.mutable_status();
    if (const auto group = groups_.find(status.group()); group != groups_.end())
      group->second.jobs.insert(number);
    else
      status.set_group(0);
    if (penumbra::is_over(status)) {
      entry.stage = Stage::kOver;
      // A killed service may have left it.
      if (status.state() == wire::JOB_DONE) spool.remove_checkpoint(number, entry.job.submission());
    } else {
      status.set_state(wire::JOB_QUEUED);
    }
  }
  std::erase_if(groups_, [&](const auto& group) {
    if (group.second.jobs.empty()) spool.remove_group(group.first);
    return group.second.jobs.empty();
  });
  next_ = spool.next_number();
  settle();                               // a service that was killed may not have come to it
  if (problems.empty()) remove_scenes();  // otherwise an unreadable job may need them
}

bool JobQueue::has_checkpoint(const Entry& entry) const {
  std::error_code ignored;
  return std::filesystem::exists(spool_.checkpoint_of(entry.job.status().job(), entry.job.submission()),
                                 ignored);
}

// --- Requests of clients

JobExpected<std::vector<JobQueue::Entry*>> JobQueue::find(JobId number) {
  if (const auto found = entries_.find(number); found != entries_.end()) return std::vector{&found->second};
  const auto group = groups_.find(number);
  if (group == groups_.end())
    return job_error(JobErrorKind::kNotFound, fmt::format("there is no job {}", number));
  std::vector<Entry*> jobs;
  for (const JobId job : group->second.jobs) jobs.push_back(&entries_.at(job));
  return jobs;
}

JobExpected<std::vector<JobQueue::Entry*>> JobQueue::find_own(JobId number, const std::string& owner) {
  auto found = find(number);
  if (!found || !own_jobs_) return found;
  for (const Entry* entry : *found)
    if (owner.empty() || !are_equal_secrets(owner, entry->job.submission().owner()))
      return job_error(
          JobErrorKind::kNotYours,
          fmt::format("job {} is {}'s, and this service lets only who submitted a job change it (--own-jobs)",
                      entry->number(), entry->job.status().submitter()));
  return found;
}

bool JobQueue::has_scene(const std::string& hash) {
  const std::lock_guard lock(mutex_);
  if (!spool_.has_scene(hash)) return false;
  scenes_that_came_.emplace(hash, std::chrono::steady_clock::now());  // a job that uses it is expected soon
  return true;
}

void JobQueue::scene_came(const std::string& hash) {
  const std::lock_guard lock(mutex_);
  scenes_that_came_.emplace(hash, std::chrono::steady_clock::now());
}

JobExpected<void> JobQueue::check(const wire::Submission& message) {
  if (own_jobs_ && message.owner().empty())
    return job_error(JobErrorKind::kNotYours,
                     "a job without the secret of its submitter, which alone could change it (--own-jobs)");
  if (!spool_.has_scene(message.scene()))
    return job_error(JobErrorKind::kNotNow,
                     fmt::format("the scene {} is not here (any more): send it first", message.scene()));
  if (entries_.size() >= kMostJobs)
    return job_error(JobErrorKind::kFull, fmt::format("there are {} already; remove some that are over",
                                                      counted(entries_.size(), "job")));
  if (const JobId group = message.group().number(); group > 0) {
    const auto found = groups_.find(group);
    if (found == groups_.end())
      return job_error(JobErrorKind::kNotFound, fmt::format("there is no group {}", group));
    if (found->second.stored.whole())
      return job_error(JobErrorKind::kNotNow,
                       fmt::format("group {} takes no more jobs: all have come, or it was cancelled", group));
    if (const auto own = find_own(group, message.owner()); !own) return std::unexpected(own.error());
  }
  for (const JobId before : message.after()) {
    if (!entries_.contains(before) && !groups_.contains(before))
      return job_error(JobErrorKind::kNotFound,
                       fmt::format("there is no job {} for this one to come after", before));
    if (before == message.group().number())
      return job_error(JobErrorKind::kNonsense, "a job cannot come after the group that it is in");
  }
  return {};
}

JobExpected<JobQueue::Submitted> JobQueue::submit(const wire::Submission& message) {
  const std::size_t names = message.mattes().ByteSizeLong();
  if (names > kLargestMatteNames)
    return job_error(JobErrorKind::kNonsense,
                     fmt::format("names of objects and materials of more than {} bytes; submit it without "
                                 "--cryptomatte",
                                 kLargestMatteNames));
  if (message.ByteSizeLong() - names > kLargestSubmission)
    return job_error(JobErrorKind::kNonsense, fmt::format("a job of more than {} bytes", kLargestSubmission));
  const auto decoded = decode(message);
  if (!decoded) return job_error(JobErrorKind::kNonsense, decoded.error().message);
  const std::lock_guard lock(mutex_);
  if (const auto checked = check(message); !checked) return std::unexpected(checked.error());
  const JobId group = !message.has_group()           ? 0
                      : message.group().number() > 0 ? message.group().number()
                                                     : next_;
  const bool is_new_group = group == next_;
  const JobId number = is_new_group ? next_ + 1 : next_;
  Entry entry;
  *entry.job.mutable_submission() = message;
  wire::JobStatus& status = *entry.job.mutable_status();
  status.set_job(number);
  status.set_name(wire_text(message.name(), kLongestName));
  status.set_priority(message.priority());
  status.set_submitted(unix_time());
  status.set_relative_error(std::numeric_limits<double>::quiet_NaN());
  status.set_group(group);
  status.set_submitter(decoded->submitter);
  *status.mutable_after() = message.after();
  status.set_folder(message.folder());
  if (decoded->frame) status.set_frame(*decoded->frame);
  Expected<void> kept = spool_.use_number(number);
  wire::StoredGroup stored_group;
  if (group > 0) {
    if (!is_new_group) stored_group = groups_.at(group).stored;
    wire::JobGroup& described = *stored_group.mutable_group();
    described.set_number(group);
    described.set_name(decoded->group->name);
    described.set_size(decoded->group->size);
    stored_group.set_latest(unix_time());
    if (kept && is_new_group) kept = spool_.keep(stored_group);
  }
  if (kept) kept = spool_.keep(entry.job);
  if (!kept) {
    spool_.remove(number);
    if (is_new_group) spool_.remove_group(group);
    return job_error(JobErrorKind::kFull, "the job cannot be kept: " + kept.error().message);
  }
  if (const auto awaited = scenes_that_came_.find(message.scene()); awaited != scenes_that_came_.end())
    scenes_that_came_.erase(awaited);
  next_ = number + 1;
  entries_.emplace(number, std::move(entry));
  if (group > 0) {
    groups_[group].stored = std::move(stored_group);
    groups_[group].jobs.insert(number);
  }
  if (message.after_size() > 0) fail_hopeless();
  changed_.notify_all();
  return Submitted{number, group};
}

void JobQueue::add(const std::vector<Entry*>& entries, wire::StatusReply& reply) const {
  std::map<JobId, std::size_t> groups;
  for (const Entry* entry : entries) {
    *reply.add_jobs() = entry->job.status();
    ++groups[entry->job.status().group()];
  }
  groups.erase(0);
  for (const auto& [number, jobs] : groups) {
    const Group& group = groups_.at(number);
    if (jobs < group.jobs.size()) continue;
    wire::JobGroup& added = *reply.add_groups();
    added = group.stored.group();
    if (is_whole(group) || jobs > added.size()) added.set_size(std::uint32_t(jobs));
  }
}

JobExpected<wire::StatusReply> JobQueue::status(const std::vector<JobId>& numbers) {
  const std::lock_guard lock(mutex_);
  wire::StatusReply reply;
  reply.set_version(std::string(kVersion));
  reply.set_up_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count());
  reply.set_now(unix_time());
  for (const FarmWorker& worker : workers_) *reply.add_workers() = encode(worker);
  for (const std::string& message : messages_) reply.add_messages(message);
  std::map<JobId, Entry*> asked;
  for (const JobId number : numbers) {
    const auto found = find(number);
    if (!found) return std::unexpected(found.error());
    for (Entry* entry : *found) asked.emplace(entry->number(), entry);
  }
  if (numbers.empty())
    for (auto& [number, entry] : entries_) asked.emplace(number, &entry);
  std::vector<Entry*> entries;
  for (const auto& [number, entry] : asked) entries.push_back(entry);
  add(entries, reply);
  // For many jobs they might exceed the size of a message.
  if (entries.size() > kMostJobsWithProblems)
    for (wire::JobStatus& job : *reply.mutable_jobs()) job.clear_problems();
  return reply;
}

/// Of a group, jobs whose state does not allow it are passed over.
template <typename Change>
JobExpected<void> JobQueue::change(JobId number, const std::string& owner, const Change& change) {
  const std::lock_guard lock(mutex_);
  const auto found = find_own(number, owner);
  if (!found) return std::unexpected(found.error());
  bool changed = false;
  std::optional<JobError> refused;
  for (Entry* entry : *found) {
    const JobExpected<void> done = change(*entry);
    changed |= done.has_value();
    if (!done) refused = done.error();
  }
  if (refused && !changed)
    return groups_.contains(number)
               ? job_error(refused->kind, fmt::format("none of group {}: {}", number, refused->message))
               : std::unexpected(*refused);
  fail_hopeless();
  changed_.notify_all();
  return {};
}

JobExpected<void> JobQueue::cancel(JobId number, const std::string& owner) {
  return change(number, owner, [this, number](Entry& entry) -> JobExpected<void> {
    if (number != entry.number() &&
        !entry.job.tried_again()) {  // of a cancelled group nothing is tried again
      entry.job.set_tried_again(true);
      keep(entry);
    }
    if (const auto group = groups_.find(number); group != groups_.end() && !group->second.stored.whole())
      make_whole(group->second);  // whoever is submitting it is refused
    if (entry.stage == Stage::kOver || entry.stage == Stage::kWriting || entry.stage == Stage::kAwaitsFrames)
      return job_error(JobErrorKind::kNotNow,
                       fmt::format("job {} is {}", entry.number(),
                                   entry.stage == Stage::kOver ? state_words(entry.job.status().state())
                                                               : "over: its files are being written"));
    entry.job.set_cancelled(true);
    if (entry.stage == Stage::kOpen) changes_.emplace_back(CancelJob{entry.number()});
    // If an earlier service has rendered a part of it, its files are written when its turn comes.
    if (entry.stage == Stage::kWaiting && !has_checkpoint(entry))
      end(entry, wire::JOB_CANCELLED, "cancelled before it began");
    else
      keep(entry);
    return {};
  });
}

JobExpected<void> JobQueue::set_priority(JobId number, int priority, const std::string& owner) {
  return change(number, owner, [this, priority](Entry& entry) -> JobExpected<void> {
    if (entry.stage == Stage::kOver)
      return job_error(JobErrorKind::kNotNow,
                       fmt::format("job {} is {}", entry.number(), state_words(entry.job.status().state())));
    entry.job.mutable_status()->set_priority(priority);
    entry.job.mutable_submission()->set_priority(priority);
    if (entry.stage == Stage::kOpen) changes_.emplace_back(PriorityChanged{entry.number(), priority});
    keep(entry);
    return {};
  });
}

JobExpected<void> JobQueue::retry(JobId number, const std::string& owner) {
  return change(number, owner, [this](Entry& entry) -> JobExpected<void> {
    const wire::JobState state = entry.job.status().state();
    if (entry.stage != Stage::kOver || state == wire::JOB_DONE)
      return job_error(JobErrorKind::kNotNow,
                       fmt::format("job {} is {}", entry.number(), state_words(state)));
    if (!spool_.has_scene(entry.job.submission().scene()))
      return job_error(
          JobErrorKind::kNotNow,
          fmt::format("the scene of job {} is not here any more: submit it again", entry.number()));
    queue_again(entry);
    return {};
  });
}

void JobQueue::queue_again(Entry& first) {
  std::vector<Entry*> again{&first};
  while (!again.empty()) {
    Entry& entry = *again.back();
    again.pop_back();
    entry.stage = Stage::kWaiting;
    entry.job.set_cancelled(false);
    entry.job.set_untold(false);
    entry.job.set_whole(false);
    wire::JobStatus& status = *entry.job.mutable_status();
    status.set_state(wire::JOB_QUEUED);
    status.clear_error();
    status.clear_ended();
    status.clear_files();
    keep(entry);
    for (auto& [number, other] : entries_) {
      const wire::JobStatus& later = other.job.status();
      const bool comes_after = std::ranges::any_of(later.after(), [&](JobId before) {
        return before == status.job() || (status.group() > 0 && before == status.group());
      });
      if (comes_after && other.stage == Stage::kOver && later.state() == wire::JOB_FAILED &&
          later.begun() == 0)
        again.push_back(&other);
    }
  }
}

JobExpected<void> JobQueue::remove(JobId number, const std::string& owner) {
  return change(number, owner, [this](Entry& entry) -> JobExpected<void> {
    if (entry.stage != Stage::kOver)
      return job_error(JobErrorKind::kNotNow,
                       fmt::format("job {} is not over; cancel it first", entry.number()));
    forget(entry.number());
    remove_scenes();
    return {};
  });
}

void JobQueue::forget(JobId job) {
  spool_.remove(job);
  const JobId number = entries_.at(job).job.status().group();
  entries_.erase(job);
  const auto group = groups_.find(number);
  if (group == groups_.end()) return;
  group->second.jobs.erase(job);
  if (!group->second.jobs.empty()) return;
  spool_.remove_group(number);
  groups_.erase(group);
}

void JobQueue::make_whole(Group& group) {
  group.stored.set_whole(true);
  keep(group);
}

JobExpected<void> JobQueue::close_group(JobId number, const std::string& owner) {
  const std::lock_guard lock(mutex_);
  const auto group = groups_.find(number);
  if (group == groups_.end())
    return job_error(JobErrorKind::kNotFound, fmt::format("there is no group {}", number));
  if (const auto own = find_own(number, owner); !own) return std::unexpected(own.error());
  make_whole(group->second);
  try_frames_again(group->second);
  changed_.notify_all();
  return {};
}

JobExpected<std::filesystem::path> JobQueue::file(JobId job, const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(job);
  if (found == entries_.end())
    return job_error(JobErrorKind::kNotFound, fmt::format("there is no job {}", job));
  for (const wire::StoredFile& file : found->second.job.status().files())
    if (file.name() == name) return spool_.folder_of(job) / name;
  return job_error(JobErrorKind::kNotFound,
                   fmt::format("job {} has no file '{}'", job, wire_text(name, kLongestName)));
}

}  // namespace penumbra
