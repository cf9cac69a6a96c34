// Tests the files that a service keeps on disk.
#include "scheduler/service/spool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/scheduler/service/small_submission.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/xxh3_twins.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::unique_ptr<Spool> open_spool(const std::filesystem::path& path) {
  auto spool = Spool::open(path);
  if (!spool) throw std::runtime_error(spool.error().message);
  return std::move(*spool);
}

wire::StoredJob stored_job(JobId number) {
  wire::StoredJob job;
  job.mutable_status()->set_job(number);
  job.mutable_status()->set_name("of " + std::to_string(number));
  return job;
}

TEST(Spool, BelongsToOneServiceAtATime) {
  const TemporaryFolder folder;
  {
    const auto first = open_spool(folder / "a/b");
    const auto second = Spool::open(folder / "a/b");
    ASSERT_FALSE(second);
    EXPECT_THAT(second.error().message, HasSubstr("belongs to another service"));
  }
  EXPECT_TRUE(Spool::open(folder / "a/b"));
  struct stat about {};
  ASSERT_EQ(stat((folder / "a/b").c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 0777u, 0700u);
  write_text(folder / "file", "");
  const auto none = Spool::open(folder / "file");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("file"));
}

TEST(Spool, KeepsJobs) {
  const TemporaryFolder folder;
  std::vector<std::string> problems;
  {
    const auto spool = open_spool(folder.path());
    EXPECT_THAT(spool->read_jobs(problems), IsEmpty());
    for (const JobId number : {2u, 11u, 3u}) ASSERT_TRUE(spool->keep(stored_job(number)));
    wire::StoredJob changed = stored_job(3);
    changed.mutable_status()->set_error("changed");
    ASSERT_TRUE(spool->keep(changed));
  }
  const auto spool = open_spool(folder.path());
  const auto jobs = spool->read_jobs(problems);
  ASSERT_EQ(jobs.size(), 3u);
  EXPECT_EQ(jobs[0].status().name(), "of 2");
  EXPECT_EQ(jobs[1].status().error(), "changed");
  EXPECT_EQ(jobs[2].status().job(), 11u);
  EXPECT_THAT(problems, IsEmpty());
}

TEST(Spool, NumbersAreNeverUsedAgain) {
  const TemporaryFolder folder;
  {
    const auto spool = open_spool(folder.path());
    EXPECT_EQ(spool->next_number(), 1u);
    ASSERT_TRUE(spool->use_number(6));
    ASSERT_TRUE(spool->keep(stored_job(6)));
    spool->remove(6);
  }
  EXPECT_EQ(open_spool(folder.path())->next_number(), 7u);
  std::filesystem::remove(folder / "next");
  const auto spool = open_spool(folder.path());
  ASSERT_TRUE(spool->keep(stored_job(9)));
  EXPECT_EQ(spool->next_number(), 10u);
}

TEST(Spool, WhatCannotBeReadIsToldAndLeft) {
  const TemporaryFolder folder;
  const auto spool = open_spool(folder.path());
  ASSERT_TRUE(spool->keep(stored_job(1)));
  std::filesystem::create_directories(folder / "jobs/2");
  std::filesystem::create_directories(folder / "jobs/other");
  std::filesystem::create_directories(folder / "jobs/3");
  write_text(folder / "jobs/3/job", "\xff\xff no job");
  std::filesystem::create_directories(folder / "jobs/4");  // another job's file
  write_text(folder / "jobs/4/job", file_contents(folder / "jobs/1/job"));
  std::vector<std::string> problems;
  EXPECT_EQ(spool->read_jobs(problems).size(), 1u);
  EXPECT_EQ(problems.size(), 4u);
  EXPECT_TRUE(std::filesystem::exists(folder / "jobs/3/job"));
}

TEST(Spool, ScenesAreWholeOrNotThere) {
  const TemporaryFolder folder;
  const auto spool = open_spool(folder.path());
  const DeviceScene scene = fake_scene(40, 30, true);
  const std::vector<std::uint8_t> bytes = scene.serialize();
  const std::string hash = hash_of(scene);
  EXPECT_FALSE(spool->has_scene(hash));
  {
    auto incoming = spool->receive_scene(hash);
    ASSERT_TRUE(incoming);
    ASSERT_TRUE(incoming->add(std::span(bytes).first(bytes.size() / 2)));
    const auto finished = incoming->finish();
    ASSERT_FALSE(finished);
    EXPECT_THAT(finished.error().message, HasSubstr("damaged"));
  }
  EXPECT_FALSE(spool->has_scene(hash));
  EXPECT_TRUE(std::filesystem::is_empty(folder / "scenes"));
  put_scene(*spool, scene);
  EXPECT_TRUE(spool->has_scene(hash));
  const auto read = spool->read_scene(hash);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->scene.serialize(), bytes);
  EXPECT_EQ(read->manifest.hash, hash);
  spool->remove_other_scenes({hash});
  EXPECT_TRUE(spool->has_scene(hash));
  std::string damaged = file_contents(folder / "scenes" / hash);
  damaged.back() = char(damaged.back() + 1);
  write_text(folder / "scenes" / hash, damaged);
  const auto wrong = spool->read_scene(hash);
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("damaged"));
  spool->remove_other_scenes({});
  EXPECT_FALSE(spool->has_scene(hash));
}

/// Whoever knows what another user submits could put a scene of his own in its place before.
TEST(Spool, TakesNoSceneUnderTheHashOfAnother) {
  const TemporaryFolder folder;
  const auto spool = open_spool(folder.path());
  const auto [scene, twin] = xxh3_twins();
  auto incoming = spool->receive_scene(hash_of(scene));
  ASSERT_TRUE(incoming);
  ASSERT_TRUE(incoming->add(twin.serialize()));
  const auto finished = incoming->finish();
  ASSERT_FALSE(finished);
  EXPECT_THAT(finished.error().message, HasSubstr("its hash is " + hash_of(twin)));
  EXPECT_FALSE(spool->has_scene(hash_of(scene)));
  put_scene(*spool, scene);
  EXPECT_TRUE(spool->has_scene(hash_of(scene)));
}

TEST(Spool, TakesNoOtherNamesForScenes) {
  const TemporaryFolder folder;
  const auto spool = open_spool(folder / "spool");
  write_text(folder / "target", "there");
  for (const std::string& name :
       {std::string("../../target"), std::string("/etc/passwd"), std::string(""), std::string(64, 'g'),
        std::string(63, 'a'), std::string(64, 'A'), std::string("../") + std::string(61, 'a')}) {
    EXPECT_FALSE(spool->has_scene(name)) << name;
    EXPECT_FALSE(spool->receive_scene(name)) << name;
  }
  EXPECT_EQ(file_contents(folder / "target"), "there");
}

TEST(Spool, WhatWasArrivingWhenAServiceDiedGoes) {
  const TemporaryFolder folder;
  { const auto spool = open_spool(folder.path()); }
  const std::string name = ".incoming-" + std::string(64, 'a') + "-1";
  write_text(folder / "scenes" / name, "half");
  const auto spool = open_spool(folder.path());
  EXPECT_TRUE(std::filesystem::is_empty(folder / "scenes"));
}

}  // namespace
}  // namespace penumbra
