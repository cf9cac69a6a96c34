// Tests the text that describes a service's state to users.
#include "scheduler/service/status_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

void add_job(wire::StatusReply& reply, wire::JobState state, const std::string& name, int priority = 0) {
  wire::JobStatus& job = *reply.add_jobs();
  job.set_job(std::uint32_t(reply.jobs_size()));
  job.set_name(name);
  job.set_state(state);
  job.set_priority(priority);
  job.set_submitted(900);
  job.set_begun(950);
  job.set_ended(960 + reply.jobs_size());
  job.set_samples_done(1'000'000);
  job.set_samples_total(4'000'000);
  job.set_elapsed_seconds(10);
  job.set_relative_error(0.031);
}

wire::StatusReply example() {
  wire::StatusReply reply;
  reply.set_version("1.2");
  reply.set_up_seconds(3723);
  reply.set_now(1000);
  add_job(reply, wire::JOB_DONE, "done.xml");
  add_job(reply, wire::JOB_QUEUED, "later.xml", 1);
  add_job(reply, wire::JOB_RENDERING, "now.xml", 2);
  add_job(reply, wire::JOB_QUEUED, "next.xml", 5);
  add_job(reply, wire::JOB_FAILED, "failed.xml");
  reply.mutable_jobs(4)->set_error("no worker\nmore");
  wire::FarmWorker& worker = *reply.add_workers();
  worker.set_number(7);
  worker.set_name("host:12");
  worker.set_device("native avx2");
  worker.set_units(4);
  worker.set_samples(3'000'000);
  worker.set_busy_seconds(2);
  worker.set_job(3);
  return reply;
}

TEST(StatusText, SaysWhatIsUnderWayFirst) {
  const auto lines = status_lines(example(), 200, 50);
  ASSERT_THAT(lines, SizeIs(9));
  EXPECT_EQ(lines[0], "penumbra 1.2, up 1:02:03: 5 jobs, 1 rendering, 2 queued, 1 worker");
  EXPECT_THAT(lines[2], AllOf(HasSubstr("now.xml"), HasSubstr(" 25%"), HasSubstr("0.10 Msamples/s"),
                              HasSubstr("30 s left"), HasSubstr("error 3.1%")));
  EXPECT_THAT(lines[3], HasSubstr("next.xml"));
  EXPECT_THAT(lines[4], AllOf(HasSubstr("later.xml"), HasSubstr("since 1:40")));
  EXPECT_THAT(lines[5], AllOf(HasSubstr("failed.xml"), HasSubstr("no worker"), Not(HasSubstr("more"))));
  EXPECT_THAT(lines[6], AllOf(HasSubstr("done.xml"), HasSubstr("in 11 s"), HasSubstr("39 s ago")));
  EXPECT_THAT(lines[8], AllOf(HasSubstr("host:12"), HasSubstr("job 3"), HasSubstr("1.50 Msamples/s")));
}

/// A group of 4 renders, of which the last has not been submitted yet.
wire::StatusReply with_group() {
  wire::StatusReply reply = example();
  wire::JobGroup& group = *reply.add_groups();
  group.set_number(70);
  group.set_name("jobs.toml");
  group.set_size(4);
  for (const int job : {0, 1, 2}) {
    reply.mutable_jobs(job)->set_group(70);
    reply.mutable_jobs(job)->set_submitter("ann@host");
  }
  reply.mutable_jobs(0)->set_samples_done(4'000'000);
  reply.mutable_jobs(0)->set_elapsed_seconds(40);
  reply.mutable_jobs(1)->set_samples_done(0);
  reply.mutable_jobs(1)->set_elapsed_seconds(0);
  reply.mutable_jobs(1)->add_after(1);
  return reply;
}

TEST(StatusText, GroupsAreFoldedAndSayHowFarTheyAre) {
  const auto folded = status_lines(with_group(), 200, 50);
  ASSERT_THAT(folded, SizeIs(7));
  // Done: 1 + 0.25 jobs of 4 in 50 s; the other 2.75 take 110 s.
  EXPECT_THAT(folded[2], AllOf(HasSubstr("    70  rendering"), HasSubstr("jobs.toml"),
                               HasSubstr("1 of 4 done"), HasSubstr("31%"), HasSubstr("1:50 left")));
  EXPECT_THAT(folded[3], HasSubstr("next.xml"));
  const auto unfolded = status_lines(with_group(), 200, 50, true);
  ASSERT_THAT(unfolded, SizeIs(10));
  EXPECT_THAT(unfolded[3], HasSubstr("now.xml"));
  EXPECT_THAT(unfolded[4], AllOf(HasSubstr("later.xml"), HasSubstr("after 1")));
  EXPECT_THAT(unfolded[5], HasSubstr("done.xml"));
  const auto json = status_json(with_group());
  EXPECT_EQ(json["groups"][0]["jobs"]["queued"], 2);
  EXPECT_EQ(json["groups"][0]["seconds_left"], 110);
  EXPECT_EQ(json["groups"][0]["submitter"], "ann@host");
  EXPECT_EQ(json["groups"][0]["ended"], nullptr);
  EXPECT_EQ(json["jobs"][1]["group"], 70);
  EXPECT_EQ(json["jobs"][1]["after"][0], 1);
  EXPECT_EQ(json["jobs"][2]["seconds_left"], 30);
  EXPECT_EQ(json["jobs"][3]["group"], nullptr);
}

TEST(StatusText, SubmittersAreNamedWhereThereAreSeveral) {
  wire::StatusReply reply = with_group();
  EXPECT_THAT(status_lines(reply, 200, 50), Contains(HasSubstr("jobs.toml (ann@host)")));
  for (wire::JobStatus& job : *reply.mutable_jobs()) job.set_submitter("ann@host");
  EXPECT_THAT(status_lines(reply, 200, 50), Each(Not(HasSubstr("ann"))));
}

TEST(StatusText, AShotIsALineWithItsFramesByState) {
  wire::StatusReply reply;
  wire::JobGroup& group = *reply.add_groups();
  group.set_number(70);
  group.set_name("shot.glb");
  group.set_size(48);
  for (int frame = 1; frame <= 48; ++frame) {
    const wire::JobState state = frame == 7                   ? wire::JOB_FAILED
                                 : frame <= 12                ? wire::JOB_DONE
                                 : frame == 13 || frame == 14 ? wire::JOB_RENDERING
                                 : frame % 2 == 1             ? wire::JOB_CANCELLED
                                                              : wire::JOB_QUEUED;
    add_job(reply, state, "shot.glb frame=" + std::to_string(frame));
    reply.mutable_jobs(frame - 1)->set_group(70);
    reply.mutable_jobs(frame - 1)->set_frame(frame);
  }
  EXPECT_THAT(status_lines(reply, 200, 50)[2],
              HasSubstr("shot.glb  frames 1-48: 1-6,8-12 done, 13-14 rendering, 7 failed, 15-47x2 cancelled, "
                        "16-48x2 queued  "));
  const auto json = status_json(reply);
  EXPECT_EQ(json["jobs"][6]["frame"], 7);
  EXPECT_EQ(json["groups"][0]["frames"]["rendering"], nlohmann::json({13, 14}));
  EXPECT_EQ(json["groups"][0]["frames"]["failed"], nlohmann::json({7}));
  EXPECT_EQ(json["groups"][0]["frames"]["incomplete"], nlohmann::json::array());
  EXPECT_EQ(status_json(with_group())["groups"][0]["frames"], nullptr);
  EXPECT_EQ(status_json(with_group())["jobs"][0]["frame"], nullptr);
}

TEST(StatusText, AGroupThatIsOverSaysTheWorst) {
  wire::StatusReply reply = with_group();
  reply.mutable_groups(0)->set_size(3);
  for (const auto& [state, name] :
       {std::pair(wire::JOB_DONE, "done"), std::pair(wire::JOB_INCOMPLETE, "incomplete"),
        std::pair(wire::JOB_CANCELLED, "cancelled"), std::pair(wire::JOB_FAILED, "failed")}) {
    reply.mutable_jobs(2)->set_state(state);
    reply.mutable_jobs(1)->set_state(wire::JOB_DONE);
    EXPECT_EQ(status_json(reply)["groups"][0]["state"], name);
    EXPECT_EQ(status_json(reply)["groups"][0]["seconds_left"], 0);
  }
  EXPECT_THAT(status_lines(reply, 200, 50)[4],
              AllOf(HasSubstr("2 of 3 done, 1 failed"), HasSubstr("37 s ago")));
}

TEST(StatusText, FitsAnyTerminal) {
  for (const int rows : {1, 2, 3, 5, 8, 24})
    for (const int columns : {1, 20, 80}) {
      const auto lines = status_lines(example(), columns, rows);
      EXPECT_LE(int(lines.size()), rows);
      for (const std::string& line : lines) EXPECT_LE(int(line.size()), columns);
    }
  EXPECT_THAT(status_lines(example(), 200, 7), Contains(HasSubstr("3 more")));
}

TEST(StatusText, ObeysNobodysControlCharacters) {
  wire::StatusReply reply;
  add_job(reply, wire::JOB_QUEUED, "a\x1b[2J\nb");
  for (const std::string& line : status_lines(reply, 200, 50)) {
    EXPECT_EQ(line.find('\x1b'), std::string::npos);
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
}

TEST(StatusText, JsonHasNullForWhatIsNotKnown) {
  wire::StatusReply reply = example();
  reply.mutable_jobs(1)->set_relative_error(std::numeric_limits<double>::quiet_NaN());
  reply.mutable_jobs(1)->set_begun(0);
  const auto json = status_json(reply);
  EXPECT_EQ(json["jobs"][1]["relative_error"], nullptr);
  EXPECT_EQ(json["jobs"][1]["begun"], nullptr);
  EXPECT_EQ(json["jobs"][2]["state"], "rendering");
  EXPECT_EQ(json["jobs"][4]["error"], "no worker\nmore");
  EXPECT_EQ(json["workers"][0]["job"], 3);
}

}  // namespace
}  // namespace penumbra
