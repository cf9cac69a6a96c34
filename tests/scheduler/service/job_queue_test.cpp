// The order in which a service starts its jobs, and how clients can change and cancel them in each state.
#include "scheduler/service/job_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include "tests/scheduler/service/queue_fixture.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST_F(JobQueueTest, HighestPriorityFirstThenOldest) {
  submit(0), submit(2), submit(-1), submit(2), submit(0);
  for (const JobId expected : {2u, 4u, 1u, 5u, 3u}) EXPECT_EQ(take(), expected);
}

TEST_F(JobQueueTest, PrioritiesChangeWhileTheyWait) {
  submit(), submit(), submit();
  ASSERT_TRUE(queue_->set_priority(3, 7));
  ASSERT_TRUE(queue_->set_priority(1, -7));
  for (const JobId expected : {3u, 2u, 1u}) EXPECT_EQ(take(), expected);
}

TEST_F(JobQueueTest, OnlyWhatIsMoreUrgentComesBesideThoseUnderWay) {
  submit(0), submit(0), submit(0);
  EXPECT_EQ(take(2, 3), 1u);
  EXPECT_EQ(take(2, 3), 2u);
  auto third = std::async(std::launch::async, [&] { return take(2, 3); });
  EXPECT_EQ(third.wait_for(50ms), std::future_status::timeout);
  submit(1);
  EXPECT_EQ(third.get(), 4u);
  submit(2);
  auto fourth = std::async(std::launch::async, [&] { return take(2, 3); });
  EXPECT_EQ(fourth.wait_for(50ms), std::future_status::timeout);  // three are the most
  queue_->end(1, wire::JOB_DONE, "");
  EXPECT_EQ(fourth.get(), 5u);
  auto fifth = std::async(std::launch::async, [&] { return take(2, 3); });
  EXPECT_EQ(fifth.wait_for(50ms), std::future_status::timeout);
  queue_->close();
  EXPECT_EQ(fifth.get(), 0u);
}

TEST_F(JobQueueTest, CancelledWherever) {
  const JobId waiting = submit(), preparing = submit(), open = submit();
  ASSERT_TRUE(queue_->cancel(waiting));
  EXPECT_EQ(status(waiting).state(), wire::JOB_CANCELLED);
  EXPECT_EQ(take(), preparing);
  ASSERT_TRUE(queue_->cancel(preparing));
  EXPECT_EQ(status(preparing).state(), wire::JOB_QUEUED);
  EXPECT_FALSE(queue_->open(preparing));
  queue_->end(preparing, wire::JOB_CANCELLED, "");
  EXPECT_EQ(take(), open);
  EXPECT_TRUE(queue_->open(open));
  EXPECT_THAT(queue_->take_changes(), SizeIs(1));  // the priority that it has by now
  ASSERT_TRUE(queue_->cancel(open));
  const auto changes = queue_->take_changes();
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_EQ(std::get<CancelJob>(changes[0]).job, open);
  EXPECT_THAT(queue_->take_changes(), IsEmpty());
  EXPECT_TRUE(queue_->begin_writing(open));
  const auto late = queue_->cancel(open);
  ASSERT_FALSE(late);
  EXPECT_THAT(late.error().message, HasSubstr("files are being written"));
  queue_->end(open, wire::JOB_CANCELLED, "");
  const auto again = queue_->cancel(open);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, JobErrorKind::kNotNow);
  EXPECT_THAT(again.error().message, HasSubstr("is cancelled"));
}

TEST_F(JobQueueTest, ACancelledJobStaysCancelledWhateverEndsTheService) {
  const JobId open_one = submit(), with_checkpoint = submit(), over = submit();
  ASSERT_EQ(take(), open_one);
  ASSERT_TRUE(queue_->open(open_one));
  ASSERT_TRUE(queue_->cancel(open_one));
  write_text(spool_->folder_of(with_checkpoint) / "s.exr.checkpoint", "what was rendered");
  ASSERT_TRUE(queue_->cancel(with_checkpoint));
  EXPECT_EQ(status(with_checkpoint).state(), wire::JOB_QUEUED);  // its turn comes, to write that
  write_text(spool_->folder_of(over) / "s.exr.checkpoint", "left");
  ASSERT_EQ(take(), with_checkpoint);
  EXPECT_FALSE(queue_->open(with_checkpoint));
  ASSERT_EQ(take(), over);
  queue_->end(over, wire::JOB_DONE, "");
  open();
  for (const JobId job : {open_one, with_checkpoint}) {
    EXPECT_EQ(take(), job);
    EXPECT_FALSE(queue_->open(job));
  }
  EXPECT_FALSE(std::filesystem::exists(spool_->folder_of(over) / "s.exr.checkpoint"));
}

TEST_F(JobQueueTest, APriorityThatChangesWhileAJobIsPreparedReachesTheFarm) {
  const JobId job = submit();
  ASSERT_EQ(take(), job);
  ASSERT_TRUE(queue_->set_priority(job, 6));
  EXPECT_THAT(queue_->take_changes(), IsEmpty());
  ASSERT_TRUE(queue_->open(job));
  const auto changes = queue_->take_changes();
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_EQ(std::get<PriorityChanged>(changes[0]).priority, 6);
}

TEST_F(JobQueueTest, ScenesOfJobsThatCannotBeReadAreKept) {
  submit();
  write_text(spool_->folder_of(1) / "job", "\xff");
  queue_.reset();
  std::vector<std::string> problems;
  queue_ = std::make_unique<JobQueue>(*spool_, problems);
  EXPECT_THAT(problems, SizeIs(1));
  EXPECT_TRUE(spool_->has_scene(hash_of(scene_)));
}

TEST_F(JobQueueTest, ChangesOfOpenJobsAreForTheFarm) {
  const JobId job = submit();
  ASSERT_EQ(take(), job);
  ASSERT_TRUE(queue_->open(job));
  EXPECT_EQ(status(job).state(), wire::JOB_QUEUED);  // others may be before it
  queue_->progress(job, {.elapsed_seconds = 1});
  EXPECT_EQ(status(job).state(), wire::JOB_RENDERING);
  (void)queue_->take_changes();
  ASSERT_TRUE(queue_->set_priority(job, 4));
  const auto changes = queue_->take_changes();
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_EQ(std::get<PriorityChanged>(changes[0]).priority, 4);
  EXPECT_EQ(status(job).priority(), 4);
}

TEST_F(JobQueueTest, ThereAgainAfterAnyEnd) {
  const JobId waiting = submit(3), rendering = submit(5), done = submit(4);
  ASSERT_EQ(take(), rendering);
  ASSERT_TRUE(queue_->open(rendering));
  ASSERT_EQ(take(), done);
  write_text(spool_->folder_of(done) / "s.exr", "image");
  queue_->progress(done, {.samples_done = 9, .samples_total = 9, .relative_error = 0.5});
  queue_->end(done, wire::JOB_DONE, "");
  ASSERT_TRUE(queue_->set_priority(waiting, 9));
  open();
  EXPECT_EQ(status(waiting).state(), wire::JOB_QUEUED);
  EXPECT_EQ(status(rendering).state(), wire::JOB_QUEUED);
  EXPECT_EQ(status(done).state(), wire::JOB_DONE);
  EXPECT_EQ(status(done).samples_done(), 9u);
  ASSERT_EQ(status(done).files_size(), 1);
  EXPECT_EQ(status(done).files(0).bytes(), 5u);
  EXPECT_EQ(take(), waiting);
  EXPECT_EQ(take(), rendering);
  EXPECT_EQ(submit(), done + 1);
}

TEST_F(JobQueueTest, FilesAreThoseOfTheJobAlone) {
  const JobId job = submit();
  EXPECT_FALSE(queue_->file(job, "s.exr"));  // not there yet
  take();
  write_text(spool_->folder_of(job) / "s.exr", "image");
  write_text(spool_->folder_of(job) / "secret.exr", "image");
  queue_->end(job, wire::JOB_DONE, "");
  EXPECT_TRUE(queue_->file(job, "s.exr"));
  for (const char* name : {"job", "secret.exr", "../1/s.exr", "/etc/passwd", ""}) {
    const auto file = queue_->file(job, name);
    ASSERT_FALSE(file) << name;
    EXPECT_EQ(file.error().kind, JobErrorKind::kNotFound);
  }
  EXPECT_EQ(queue_->file(77, "s.exr").error().message, "there is no job 77");
}

TEST_F(JobQueueTest, WhatIsRemovedIsGone) {
  const JobId job = submit();
  EXPECT_THAT(queue_->remove(job).error().message, HasSubstr("cancel it first"));
  ASSERT_TRUE(queue_->cancel(job));
  ASSERT_TRUE(queue_->remove(job));
  EXPECT_FALSE(queue_->status({job}));
  EXPECT_FALSE(std::filesystem::exists(spool_->folder_of(job)));
  open();
  EXPECT_FALSE(queue_->status({job}));
  put_scene(*spool_, scene_);
  EXPECT_EQ(submit(), job + 1);
}

TEST_F(JobQueueTest, ScenesAreKeptAsLongAsAJobNeedsThem) {
  const JobId first = submit(), second = submit();
  take(), take();
  queue_->end(first, wire::JOB_DONE, "");
  EXPECT_TRUE(spool_->has_scene(hash_of(scene_)));
  queue_->end(second, wire::JOB_FAILED, "why");
  EXPECT_TRUE(spool_->has_scene(hash_of(scene_))) << "for a second try";
  ASSERT_TRUE(queue_->remove(second));
  EXPECT_FALSE(spool_->has_scene(hash_of(scene_)));
  const auto late = queue_->submit(encode(small_submission(scene_)));
  ASSERT_FALSE(late);
  EXPECT_THAT(late.error().message, HasSubstr("send it first"));
}

TEST_F(JobQueueTest, AScenesThatHasJustComeIsKeptForItsJob) {
  const JobId job = submit();
  const DeviceScene other = fake_scene(20, 10, true);
  put_scene(*spool_, other);
  queue_->scene_came(hash_of(other));
  take();
  queue_->end(job, wire::JOB_DONE, "");  // which looks for scenes that nobody needs
  EXPECT_TRUE(spool_->has_scene(hash_of(other)));
  EXPECT_TRUE(queue_->has_scene(hash_of(other))) << "another client asks";
  for (const bool is_awaited : {true, false}) {
    const auto awaited = queue_->submit(encode(small_submission(other)));
    ASSERT_TRUE(awaited);
    take();
    queue_->end(awaited->job, wire::JOB_DONE, "");
    EXPECT_EQ(spool_->has_scene(hash_of(other)), is_awaited) << "each job was awaited once";
  }
}

TEST_F(JobQueueTest, NonsenseIsRefusedAndLeavesNothing) {
  Submission wrong = small_submission(scene_);
  wrong.files = {"../../x.exr"};
  const auto job = queue_->submit(encode(wrong));
  ASSERT_FALSE(job);
  EXPECT_EQ(job.error().kind, JobErrorKind::kNonsense);
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "jobs"));
}

TEST_F(JobQueueTest, AFullOrReadOnlyDiskRefusesTheJob) {
  // A file where the job's folder would be stands for every disk that takes nothing.
  write_text(folder_ / "jobs" / "1", "");
  const auto job = queue_->submit(encode(small_submission(scene_)));
  ASSERT_FALSE(job);
  EXPECT_EQ(job.error().kind, JobErrorKind::kFull);
  EXPECT_THAT(job.error().message, HasSubstr("cannot be kept"));
}

}  // namespace
}  // namespace penumbra
