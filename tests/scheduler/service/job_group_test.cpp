// Groups of jobs, jobs that come after others, second tries, equal shares of submitters, and what becomes of
// ends.
#include <future>

#include "tests/scheduler/service/queue_fixture.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class JobGroupTest : public JobQueueTest {
 protected:
  JobQueue::Submitted submit_with(const std::function<void(Submission&)>& change) {
    Submission submission = small_submission(scene_);
    change(submission);
    const auto submitted = queue_->submit(encode(submission));
    EXPECT_TRUE(submitted) << submitted.error().message;
    return submitted.value_or(JobQueue::Submitted{});
  }
  /// A whole group of so many jobs, of which each comes after the one before if `in_order`.
  JobId submit_group(int size, bool in_order = false) {
    JobId group = 0, before = 0;
    for (int i = 0; i < size; ++i) {
      const auto submitted = submit_with([&](Submission& s) {
        s.group = {group, "jobs.toml", std::uint32_t(size)};
        if (in_order && before > 0) s.after = {before};
      });
      group = submitted.group;
      before = submitted.job;
    }
    EXPECT_TRUE(queue_->close_group(group));
    return group;
  }
  void finish(JobId job, wire::JobState state = wire::JOB_DONE) {
    ASSERT_EQ(take(), job);
    ASSERT_TRUE(queue_->open(job));
    queue_->progress(job, {.samples_done = 1, .samples_total = 4, .elapsed_seconds = 1});
    queue_->begin_writing(job);
    queue_->end(job, state, state == wire::JOB_DONE ? "" : "a reason");
  }
  /// Whether nothing can begin now.
  bool nothing_to_take() {
    auto taken = std::async(std::launch::async, [&] { return take(); });
    const bool none = taken.wait_for(50ms) == std::future_status::timeout;
    if (none) {
      const JobId woken = submit(-1000);
      EXPECT_EQ(taken.get(), woken);
      queue_->end(woken, wire::JOB_DONE, "");
    }
    return none;
  }
};

TEST_F(JobGroupTest, GroupsAndJobsAreNumberedTogether) {
  EXPECT_EQ(submit(), 1u);
  EXPECT_EQ(submit_group(3), 2u);
  EXPECT_EQ(submit(), 6u);
  const auto reply = queue_->status({2});
  ASSERT_TRUE(reply);
  ASSERT_EQ(reply->jobs_size(), 3);
  EXPECT_EQ(reply->jobs(0).job(), 3u);
  EXPECT_EQ(reply->jobs(0).group(), 2u);
  ASSERT_EQ(reply->groups_size(), 1);
  EXPECT_EQ(reply->groups(0).name(), "jobs.toml");
  EXPECT_EQ(reply->groups(0).size(), 3u);
  EXPECT_EQ(queue_->status({3})->groups_size(), 0);  // not all of it was asked for
  open();
  EXPECT_EQ(queue_->status({})->groups_size(), 1);
  EXPECT_EQ(submit(), 7u);
}

TEST_F(JobGroupTest, AreChangedAsOne) {
  const JobId group = submit_group(3), alone = submit();
  ASSERT_TRUE(queue_->set_priority(group, 7));
  for (const JobId job : {2u, 3u, 4u}) EXPECT_EQ(status(job).priority(), 7);
  finish(2);
  ASSERT_TRUE(queue_->cancel(group));  // those that are over are passed over
  EXPECT_EQ(status(2).state(), wire::JOB_DONE);
  EXPECT_EQ(status(3).state(), wire::JOB_CANCELLED);
  const auto again = queue_->cancel(group);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, JobErrorKind::kNotNow);
  EXPECT_THAT(again.error().message, HasSubstr("none of group 1: job 4 is cancelled"));
  ASSERT_TRUE(queue_->remove(group));
  EXPECT_EQ(queue_->status({})->jobs_size(), 1);
  EXPECT_EQ(queue_->status({})->groups_size(), 0);
  EXPECT_EQ(queue_->status({group}).error().kind, JobErrorKind::kNotFound);
  EXPECT_EQ(take(), alone);
}

TEST_F(JobGroupTest, OneThatIsWholeOrCancelledTakesNoMore) {
  const JobId whole = submit_group(1);
  const JobId cancelled = submit_with([](Submission& s) { s.group = {0, "x", 5}; }).group;
  ASSERT_TRUE(queue_->cancel(cancelled));
  for (const JobId group : {whole, cancelled, 99u}) {
    Submission submission = small_submission(scene_);
    submission.group = {group, "x", 5};
    const auto refused = queue_->submit(encode(submission));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message,
                HasSubstr(group == 99 ? "there is no group 99" : "takes no more jobs"));
  }
}

TEST_F(JobGroupTest, ForeignGroupsAreNeitherChangedNorAddedTo) {
  queue_->own_jobs();
  const auto submit_as = [&](const std::string& owner, JobId group) {
    Submission submission = small_submission(scene_);
    submission.group = {group, "jobs.toml", 3};
    wire::Submission message = encode(submission);
    message.set_owner(owner);
    return queue_->submit(message);
  };
  const auto first = submit_as("one", 0);
  ASSERT_TRUE(first) << first.error().message;
  const JobId group = first->group;
  for (const char* other : {"two", "", "on", "one1"}) {
    const auto added = submit_as(other, group);
    ASSERT_FALSE(added) << other;
    EXPECT_EQ(added.error().kind, JobErrorKind::kNotYours);
    for (const JobId number : {group, first->job})
      for (const auto& changed : {queue_->cancel(number, other), queue_->set_priority(number, 5, other),
                                  queue_->retry(number, other), queue_->remove(number, other)}) {
        ASSERT_FALSE(changed) << other;
        EXPECT_EQ(changed.error().kind, JobErrorKind::kNotYours);
      }
    EXPECT_EQ(queue_->close_group(group, other).error().kind, JobErrorKind::kNotYours);
  }
  EXPECT_EQ(submit_as("", 0).error().kind, JobErrorKind::kNotYours);
  EXPECT_EQ(status(first->job).priority(), 0);
  const auto second = submit_as("one", group);  // nobody has closed it
  ASSERT_TRUE(second) << second.error().message;
  EXPECT_TRUE(queue_->close_group(group, "one"));
  EXPECT_TRUE(queue_->cancel(group, "one"));
  EXPECT_FALSE(queue_->remove(group, "two"));
  EXPECT_EQ(queue_->status({})->jobs_size(), 2);
  EXPECT_TRUE(queue_->remove(group, "one"));
}

TEST_F(JobGroupTest, JobsComeAfterThoseThatMustBeDone) {
  const JobId first = submit(-5), group = submit_group(2);
  const JobId last = submit_with([&](Submission& s) {
                       s.priority = 9;
                       s.after = {first, group};
                     }).job;
  EXPECT_EQ(take(), 3u);
  EXPECT_EQ(take(), 4u);
  queue_->end(3, wire::JOB_DONE, "");
  queue_->end(4, wire::JOB_DONE, "");
  EXPECT_EQ(take(), first);
  EXPECT_TRUE(nothing_to_take());
  open();  // killed: the first is rendered again
  EXPECT_EQ(take(), first);
  queue_->end(first, wire::JOB_DONE, "");
  EXPECT_EQ(take(), last);
}

TEST_F(JobGroupTest, AGroupIsWaitedForUntilItIsWhole) {
  const JobId group = submit_with([](Submission& s) { s.group = {0, "x", 2}; }).group;
  const JobId last = submit_with([&](Submission& s) { s.after = {group}; }).job;
  finish(2);
  EXPECT_TRUE(nothing_to_take());
  ASSERT_TRUE(queue_->close_group(group));
  EXPECT_EQ(take(), last);
}

TEST_F(JobGroupTest, WhatComesAfterAFailureFailsAndIsTriedAgainWithIt) {
  const JobId group = submit_group(4, true);
  finish(2);
  finish(3, wire::JOB_FAILED);
  for (const JobId job : {4u, 5u}) {
    EXPECT_EQ(status(job).state(), wire::JOB_FAILED);
    EXPECT_THAT(status(job).error(), HasSubstr(fmt::format("not begun, because job {}", job - 1)));
  }
  const auto refused = queue_->retry(2);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("job 2 is done"));
  ASSERT_TRUE(queue_->retry(3));
  open();
  for (const JobId job : {3u, 4u, 5u}) finish(job);
  EXPECT_EQ(queue_->status({group})->jobs(3).state(), wire::JOB_DONE);
  EXPECT_EQ(status(3).error(), "");
}

TEST_F(JobGroupTest, NothingComesAfterItselfOrAfterNothing) {
  const JobId group = submit_with([](Submission& s) { s.group = {0, "x", 2}; }).group;
  Submission submission = small_submission(scene_);
  submission.group = {group, "x", 2};
  submission.after = {group};
  EXPECT_THAT(queue_->submit(encode(submission)).error().message, HasSubstr("after the group that it is in"));
  submission.after = {77};
  EXPECT_THAT(queue_->submit(encode(submission)).error().message, HasSubstr("there is no job 77"));
}

TEST_F(JobGroupTest, ASecondTryKeepsSceneAndCheckpoint) {
  const JobId job = submit();
  ASSERT_EQ(take(), job);
  ASSERT_TRUE(queue_->open(job));
  queue_->end(job, wire::JOB_CANCELLED, "");
  write_text(spool_->folder_of(job) / "s.exr.checkpoint", "what was rendered");
  open();
  ASSERT_TRUE(queue_->retry(job));
  EXPECT_TRUE(spool_->has_scene(hash_of(scene_)));
  EXPECT_TRUE(std::filesystem::exists(spool_->folder_of(job) / "s.exr.checkpoint"));
  EXPECT_EQ(take(), job);
  EXPECT_TRUE(queue_->open(job));  // not cancelled any more
}

TEST_F(JobGroupTest, AFrameThatFailedGetsAnotherTryAtTheEndAndOnlyOne) {
  JobId group = 0;
  for (const int frame : {11, 12, 13})
    group = submit_with([&](Submission& s) { s.group = {group, "shot.glb", 3}, s.frame = frame; }).group;
  finish(2);
  finish(3, wire::JOB_FAILED);
  finish(4, wire::JOB_INCOMPLETE);
  EXPECT_EQ(status(3).state(), wire::JOB_FAILED) << "more frames may come";
  EXPECT_EQ(status(3).frame(), 12);
  ASSERT_TRUE(queue_->close_group(group));
  EXPECT_EQ(status(3).state(), wire::JOB_QUEUED);
  EXPECT_EQ(status(4).state(), wire::JOB_QUEUED);
  open();
  EXPECT_EQ(status(3).frame(), 12);
  finish(3);
  finish(4, wire::JOB_FAILED);
  EXPECT_EQ(status(4).state(), wire::JOB_FAILED);
  ASSERT_TRUE(queue_->retry(4));
  finish(4, wire::JOB_FAILED);
  EXPECT_EQ(status(4).state(), wire::JOB_FAILED);
}

TEST_F(JobGroupTest, AFrameIsTriedAgainBeforeWhatComesAfterIt) {
  const JobId group = submit_with([](Submission& s) { s.group = {0, "x", 3}, s.frame = 11; }).group;
  submit_with([&](Submission& s) { s.group = {group, "x", 3}, s.frame = 12; });
  submit_with([&](Submission& s) { s.group = {group, "x", 3}, s.after = {3}, s.frame = 1; });
  ASSERT_TRUE(queue_->close_group(group));
  finish(2);
  finish(3, wire::JOB_FAILED);
  EXPECT_EQ(status(3).state(), wire::JOB_QUEUED);
  EXPECT_EQ(status(4).state(), wire::JOB_QUEUED);
  finish(3, wire::JOB_FAILED);
  EXPECT_EQ(status(3).state(), wire::JOB_FAILED);
  EXPECT_EQ(status(4).state(), wire::JOB_FAILED) << "it would wait for ever";
}

TEST_F(JobGroupTest, AFrameIsTriedAgainAfterAKillBeforeThat) {
  const JobId group = submit_with([](Submission& s) { s.group = {0, "x", 2}, s.frame = 11; }).group;
  submit_with([&](Submission& s) { s.group = {group, "x", 2}, s.frame = 12; });
  finish(2);
  finish(3, wire::JOB_FAILED);
  EXPECT_EQ(status(3).state(), wire::JOB_FAILED) << "more frames may come";
  open();  // none will
  EXPECT_EQ(status(3).state(), wire::JOB_QUEUED);
}

TEST_F(JobGroupTest, NoFrameOfACancelledGroupIsTriedAgain) {
  JobId group = 0;
  for (const int frame : {11, 12, 13})
    group = submit_with([&](Submission& s) { s.group = {group, "x", 3}, s.frame = frame; }).group;
  ASSERT_TRUE(queue_->close_group(group));
  finish(2);
  finish(3, wire::JOB_FAILED);
  ASSERT_TRUE(queue_->cancel(group));
  open();
  EXPECT_EQ(status(3).state(), wire::JOB_FAILED);
}

TEST_F(JobGroupTest, NoFrameIsTriedAgainWhereNoneSucceeds) {
  JobId group = 0;
  for (const int frame : {1, 2})
    group = submit_with([&](Submission& s) { s.group = {group, "shot.glb", 2}, s.frame = frame; }).group;
  ASSERT_TRUE(queue_->close_group(group));
  finish(2, wire::JOB_FAILED);
  finish(3, wire::JOB_FAILED);
  EXPECT_EQ(status(2).state(), wire::JOB_FAILED);
  EXPECT_EQ(status(3).state(), wire::JOB_FAILED);
}

TEST_F(JobGroupTest, SubmittersTakeTurns) {
  const auto of = [this](const char* who, int priority = 0) {
    return submit_with([&](Submission& s) { s.submitter = who, s.priority = priority; }).job;
  };
  const JobId a1 = of("a"), a2 = of("a"), a3 = of("a"), b1 = of("b"), b2 = of("b"), a9 = of("a", 9);
  EXPECT_EQ(take(2, 4), a9);  // priority counts more
  EXPECT_EQ(take(2, 4), b1);  // a has one under way
  queue_->end(a9, wire::JOB_DONE, "");
  EXPECT_EQ(take(2, 4), a1);
  queue_->end(b1, wire::JOB_DONE, "");
  EXPECT_EQ(take(2, 4), b2);
  queue_->end(b2, wire::JOB_DONE, "");
  EXPECT_EQ(take(2, 4), a2);
  const JobId c1 = of("c");
  EXPECT_EQ(take(2, 4), c1);  // beside two of a, as it has none
  queue_->end(a1, wire::JOB_DONE, "");
  of("c"), of("b");
  EXPECT_EQ(status(take(3, 4)).submitter(), "b");  // a and c have one each
  EXPECT_EQ(status(a3).state(), wire::JOB_QUEUED);
}

TEST_F(JobGroupTest, EndsAreToldOnceEvenIfAServiceIsKilled) {
  open(true);
  put_scene(*spool_, scene_);
  const JobId group = submit_group(2);
  finish(2);
  auto ended = queue_->wait_for_end();
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->number, 2u);
  EXPECT_FALSE(ended->is_group);
  open(true);  // killed before told()
  ended = queue_->wait_for_end();
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->number, 2u);
  queue_->told(*ended);
  open(true);
  finish(3, wire::JOB_FAILED);
  ended = queue_->wait_for_end();
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->number, 3u);
  queue_->told(*ended);
  ended = queue_->wait_for_end();
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->number, group);
  EXPECT_TRUE(ended->is_group);
  EXPECT_EQ(ended->status.jobs_size(), 2);
  ASSERT_TRUE(queue_->retry(3));  // before the command for the group has ended
  queue_->told(*ended);
  finish(3);
  for (const JobId expected : {JobId(3), group}) {
    ended = queue_->wait_for_end();
    ASSERT_TRUE(ended);
    EXPECT_EQ(ended->number, expected);
    queue_->told(*ended);
  }
  queue_->close();
  EXPECT_FALSE(queue_->wait_for_end());
}

TEST_F(JobGroupTest, WithoutACommandThereIsNothingToTell) {
  finish(submit());
  open(true);
  queue_->close();
  EXPECT_FALSE(queue_->wait_for_end());
}

TEST_F(JobGroupTest, OldJobsAreRemovedGroupsAsOne) {
  submit_group(2);
  const JobId alone = submit(), waiting = submit();
  finish(2);
  EXPECT_THAT(queue_->remove_older_than(0), IsEmpty());  // the group is not over
  finish(3);
  finish(alone, wire::JOB_FAILED);
  EXPECT_THAT(queue_->remove_older_than(3600), IsEmpty());
  EXPECT_THAT(queue_->remove_older_than(-1), ElementsAre(2, 3, alone));
  EXPECT_FALSE(std::filesystem::exists(spool_->folder_of(2)));
  EXPECT_TRUE(spool_->has_scene(hash_of(scene_)));  // of the job that waits
  open();
  EXPECT_EQ(take(), waiting);
  EXPECT_EQ(submit(), waiting + 1);
}

// --- Frames that are denoised with those beside them

class FramesBesideTest : public JobGroupTest {
 protected:
  /// Frames 1 to 4 of a shot.
  void submit_shot() {
    for (int frame = 1; frame <= 4; ++frame) {
      const auto submitted = submit_with([&](Submission& s) {
        s.group = {group_, "shot.xml", 4};
        s.frame = frame;
        s.record.film.denoise = Denoise::kNfor;
        s.files = {"s.exr", "s-denoised.exr"};
        s.beside = NumbersBeside{};
        for (const int other : {frame - 1, frame + 1})
          if (other >= 1 && other <= 4) s.beside->frames.push_back(other);
      });
      group_ = submitted.group;
      jobs_.push_back(submitted.job);
    }
    EXPECT_TRUE(queue_->close_group(group_));
  }
  [[nodiscard]] JobId job_of(int frame) const { return jobs_[std::size_t(frame - 1)]; }
  void render(int frame) {
    const JobId job = take();
    ASSERT_EQ(job, job_of(frame));
    ASSERT_TRUE(queue_->open(job));
    queue_->begin_writing(job);
    queue_->await_frames(job);
  }
  /// The frames that a frame is denoised with; -1: it is to wait.
  std::vector<int> beside(int frame) {
    const auto images = queue_->frames_beside(job_of(frame));
    if (!images) return {-1};
    std::vector<int> numbers;
    for (const auto& image : *images) {
      EXPECT_EQ(image.exr, spool_->folder_of(job_of(image.frame)) / "s.exr");
      numbers.push_back(image.frame);
    }
    return numbers;
  }
  JobId group_ = 0;
  std::vector<JobId> jobs_;
};

TEST_F(FramesBesideTest, AreAwaitedAndFoundAlsoAfterTheirEnd) {
  submit_shot();
  render(1);
  EXPECT_THAT(beside(1), ElementsAre(-1));
  EXPECT_FALSE(queue_->cancel(job_of(1)));
  render(2);
  EXPECT_THAT(beside(1), ElementsAre(2));
  EXPECT_THAT(beside(2), ElementsAre(-1));
  queue_->end(job_of(1), wire::JOB_DONE, "");
  render(3);
  EXPECT_THAT(beside(2), ElementsAre(1, 3));
  EXPECT_TRUE(queue_->cancel(job_of(4)));
  EXPECT_THAT(beside(3), ElementsAre(2));
}

TEST_F(FramesBesideTest, AFrameThatFailedIsAwaitedForItsOtherTry) {
  submit_shot();
  finish(job_of(1), wire::JOB_FAILED);
  for (const int frame : {2, 3, 4}) render(frame);
  // The others are rendered, so it is queued again though none is over.
  EXPECT_THAT(beside(2), ElementsAre(-1));
  EXPECT_THAT(beside(3), ElementsAre(2, 4));
  finish(job_of(1), wire::JOB_FAILED);
  EXPECT_THAT(beside(2), ElementsAre(3));
}

TEST_F(FramesBesideTest, WhoIsNotSubmittedIsAwaitedUntilTheGroupIsWhole) {
  const auto first = submit_with([&](Submission& s) {
    s.group = {0, "shot.xml", 2};
    s.frame = 1;
    s.record.film.denoise = Denoise::kNfor;
    s.files = {"s.exr", "s-denoised.exr"};
    s.beside = NumbersBeside{.shot = 0, .frames = {2}};
  });
  jobs_ = {first.job};
  render(1);
  EXPECT_THAT(beside(1), ElementsAre(-1));
  EXPECT_TRUE(queue_->close_group(first.group));
  EXPECT_THAT(beside(1), IsEmpty());
}

}  // namespace
}  // namespace penumbra
