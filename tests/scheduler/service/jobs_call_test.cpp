// Tests the calls of jobs.proto over a socket.
#include <gmock/gmock.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "jobs.grpc.pb.h"
#include "scheduler/service/jobs_client.h"
#include "scheduler/service/jobs_service.h"
#include "tests/scheduler/service/small_submission.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/xxh3_twins.h"
#include "worker/protocol/client.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class JobsCall : public ::testing::Test {
 protected:
  void SetUp() override {
    auto spool = Spool::open(folder_ / "spool");
    ASSERT_TRUE(spool) << spool.error().message;
    spool_ = std::move(*spool);
    std::vector<std::string> problems;
    queue_ = std::make_unique<JobQueue>(*spool_, problems);
    service_ = make_jobs_service(*queue_, *spool_, [this](const std::string&) { ++calls_; });
    grpc::ServerBuilder builder;
    builder.AddListeningPort(address_, grpc::InsecureServerCredentials());
    builder.RegisterService(service_.get());
    server_ = builder.BuildAndStart();
    ASSERT_NE(server_, nullptr);
    client_ = std::make_unique<JobsClient>(address_, ClientAccess{});
  }
  void TearDown() override {
    if (server_) server_->Shutdown();
  }

  const TemporaryFolder folder_;
  const std::string address_ = "unix:" + (folder_ / "s").string();
  const DeviceScene scene_ = fake_scene(40, 30, true);
  std::unique_ptr<Spool> spool_;
  std::unique_ptr<JobQueue> queue_;
  std::shared_ptr<grpc::Service> service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<JobsClient> client_;
  std::atomic<int> calls_ = 0;
};

TEST_F(JobsCall, FromSubmittingToTheResult) {
  const auto job = client_->submit(small_submission(scene_), scene_);
  ASSERT_TRUE(job) << job.error().message;
  EXPECT_EQ(calls_, 3);  // whether the scene is there, the scene, the job
  const auto second = client_->submit(small_submission(scene_), scene_);
  ASSERT_TRUE(second) << second.error().message;
  EXPECT_EQ(calls_, 5);  // the scene is there
  ASSERT_TRUE(client_->set_priority(second->job(), 3));
  const auto taken = queue_->take(1, 1);
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->job, second->job());
  EXPECT_EQ(taken->submission.record.film.width, 40);
  const std::string image(3'000'000, 'x');  // more than a message
  write_text(spool_->folder_of(second->job()) / "s.exr", image);
  queue_->end(second->job(), wire::JOB_DONE, "");
  ASSERT_TRUE(client_->cancel(job->job()));
  const auto status = client_->status({});
  ASSERT_TRUE(status) << status.error().message;
  ASSERT_EQ(status->jobs_size(), 2);
  EXPECT_EQ(status->jobs(0).state(), wire::JOB_CANCELLED);
  ASSERT_EQ(status->jobs(1).files_size(), 1);
  const auto fetched = client_->fetch(second->job(), status->jobs(1).files(0), folder_ / "there.exr");
  ASSERT_TRUE(fetched) << fetched.error().message;
  EXPECT_EQ(file_contents(folder_ / "there.exr"), image);
  ASSERT_TRUE(client_->remove(job->job()));
  ASSERT_TRUE(client_->remove(second->job()));
  EXPECT_EQ(client_->status({})->jobs_size(), 0);
}

TEST_F(JobsCall, OfTheNextSceneOnlyWhatDiffersIsSent) {
  ASSERT_TRUE(client_->submit(small_submission(scene_), scene_));
  EXPECT_EQ(client_->sent_bytes(), scene_.serialize().size());
  DeviceScene next = scene_;
  next.header.sampler.seed += 1;  // another head, the same tables
  const auto job = client_->submit(small_submission(next), next);
  ASSERT_TRUE(job) << job.error().message;
  EXPECT_EQ(client_->sent_bytes(), scene_.serialize().size() + next.head().size());
  const auto stored = spool_->read_scene(hash_of(next));
  ASSERT_TRUE(stored) << stored.error().message;
  EXPECT_EQ(stored->scene.serialize(), next.serialize());
  // A base that is not here any more.
  spool_->remove_other_scenes({});
  DeviceScene last = scene_;
  last.header.sampler.seed += 2;
  ASSERT_TRUE(client_->submit(small_submission(last), last));
  EXPECT_EQ(spool_->read_scene(hash_of(last))->scene.serialize(), last.serialize());
}

TEST_F(JobsCall, PartsThatABaseHasNotAreRefused) {
  put_scene(*spool_, scene_);
  auto incoming = spool_->receive_scene(hash_of(fake_scene(1, 1, true)), hash_of(scene_));
  ASSERT_TRUE(incoming) << incoming.error().message;
  const std::uint64_t size = scene_.serialize().size();
  EXPECT_FALSE(incoming->add_of_base(size - 1, 2));
  EXPECT_FALSE(incoming->add_of_base(std::numeric_limits<std::uint64_t>::max(), 1));
  EXPECT_FALSE(spool_->receive_scene(hash_of(scene_), "../next"));
}

TEST_F(JobsCall, ErrorsAreTextsThatNameTheAddress) {
  const auto status = client_->status({5});
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, AllOf(HasSubstr(address_), HasSubstr("there is no job 5")));
  EXPECT_FALSE(client_->is_away());
  Submission wrong = small_submission(scene_);
  wrong.files = {"a/b.exr"};
  EXPECT_THAT(client_->submit(wrong, scene_).error().message, HasSubstr("no name of a result"));
  wrong = small_submission(scene_);
  wrong.scene = hash_of(fake_scene(1, 1, true));  // another one's hash
  EXPECT_THAT(client_->submit(wrong, scene_).error().message, HasSubstr("damaged"));
  EXPECT_FALSE(spool_->has_scene(wrong.scene));
  const auto [one, twin] = xxh3_twins();
  EXPECT_THAT(client_->submit(small_submission(one), twin).error().message, HasSubstr("damaged"));
  EXPECT_FALSE(spool_->has_scene(hash_of(one)));
  wire::StoredFile file;
  file.set_name("../../s");
  file.set_bytes(10);
  EXPECT_FALSE(client_->fetch(1, file, folder_ / "x.exr"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.exr"));
  server_->Shutdown();
  server_.reset();
  EXPECT_THAT(
      client_->status({}).error().message,
      AllOf(HasSubstr("no service answers at"), HasSubstr("nobody listens there; `penumbra serve --listen")));
  EXPECT_TRUE(client_->is_away());
}

TEST_F(JobsCall, OtherVersionsAreRefusedByName) {
  const auto stub = wire::Jobs::NewStub(open_channel(address_));
  wire::StatusRequest request;
  request.set_protocol_version(kProtocolVersion + 1);
  grpc::ClientContext context;
  wire::StatusReply reply;
  const grpc::Status status = stub->Status(&context, request, &reply);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(), AllOf(HasSubstr(std::to_string(kProtocolVersion)),
                                            HasSubstr(std::to_string(kProtocolVersion + 1))));
}

TEST_F(JobsCall, ASceneThatBreaksOffLeavesNothing) {
  const auto stub = wire::Jobs::NewStub(open_channel(address_));
  for (const bool cancelled : {false, true}) {
    grpc::ClientContext context;
    wire::PutSceneReply reply;
    const auto writer = stub->PutScene(&context, &reply);
    wire::SceneChunk chunk;
    chunk.set_protocol_version(kProtocolVersion);
    chunk.set_hash(hash_of(scene_));
    chunk.set_data(scene_.head().data(), 10);
    writer->Write(chunk);
    if (cancelled) context.TryCancel();
    writer->WritesDone();
    EXPECT_FALSE(writer->Finish().ok());
  }
  server_->Shutdown();
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "spool" / "scenes"));
}

}  // namespace
}  // namespace penumbra
