// A queue of jobs in a folder of its own, which can be opened again like that of a service that was killed.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scheduler/service/job_queue.h"
#include "tests/scheduler/service/small_submission.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {

class JobQueueTest : public ::testing::Test {
 protected:
  void SetUp() override {
    open();
    put_scene(*spool_, scene_);
  }
  void open(bool tells_ends = false) {
    queue_.reset();
    spool_.reset();
    auto spool = Spool::open(folder_.path());
    ASSERT_TRUE(spool) << spool.error().message;
    spool_ = std::move(*spool);
    std::vector<std::string> problems;
    queue_ = std::make_unique<JobQueue>(*spool_, problems, tells_ends);
    EXPECT_THAT(problems, ::testing::IsEmpty());
  }
  JobId submit(int priority = 0) {
    const auto job = queue_->submit(encode(small_submission(scene_, priority)));
    EXPECT_TRUE(job) << job.error().message;
    return job ? job->job : 0;
  }
  wire::JobStatus status(JobId job) {
    const auto reply = queue_->status({job});
    EXPECT_TRUE(reply) << reply.error().message;
    return reply ? reply->jobs(0) : wire::JobStatus();
  }
  JobId take(int at_once = 10, int at_most = 10) {
    const auto taken = queue_->take(at_once, at_most);
    return taken ? taken->job : 0;
  }

  const TemporaryFolder folder_;
  const DeviceScene scene_ = fake_scene(40, 30, true);
  std::unique_ptr<Spool> spool_;
  std::unique_ptr<JobQueue> queue_;
};

}  // namespace penumbra
