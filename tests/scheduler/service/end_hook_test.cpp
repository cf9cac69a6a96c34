// The command that is called at the end of jobs, and that nothing in a job's name is executed by it.
#include "scheduler/service/end_hook.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class EndHookTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ended_.number = 12;
    wire::JobStatus& job = *ended_.status.add_jobs();
    job.set_job(12);
    job.set_name("s.xml");
    job.set_state(wire::JOB_FAILED);
    job.set_error("no worker");
    job.set_submitter("ann@host");
  }
  Expected<void> call(const std::string& command) const {
    const auto hook = EndHook::make(command);
    return hook ? hook->call(ended_, stop_) : Expected<void>(std::unexpected(hook.error()));
  }
  /// What the command prints.
  std::string printed(const std::string& command) const {
    const auto called = call(fmt::format("{{ {}; }} >{}", command, (folder_ / "out").string()));
    EXPECT_TRUE(called) << called.error().message;
    return file_contents(folder_ / "out");
  }

  const TemporaryFolder folder_;
  JobQueue::Ended ended_;
  std::atomic<bool> stop_ = false;
};

TEST_F(EndHookTest, FieldsAreWordsInsideQuotesAndOutside) {
  EXPECT_EQ(printed("echo {job} {kind} {group} {state}"), "12 job 0 failed\n");
  EXPECT_EQ(printed("printf '%s|' {name} \"{name}: {error}\" '{submitter}'"),
            "s.xml|s.xml: no worker|ann@host|");
}

TEST_F(EndHookTest, OtherBracesAreTheShells) {
  EXPECT_EQ(printed("X=3; echo ${X} $(echo 1 2 | awk '{ print $2 }') {a,b} \\'{job}\\'"), "3 2 {a,b} '12'\n");
}

TEST_F(EndHookTest, ATextOfAClientIsNeverExecuted) {
  for (const char* name : {"$(touch hit)", "`touch hit`", "'; touch hit; '", "\"; touch hit; \"",
                           "a\ntouch hit", "*", "-n", "${IFS}", "\\"}) {
    ended_.status.mutable_jobs(0)->set_name(name);
    const std::string folder = folder_.path().string();
    for (const char* word : {"{name}", "\"{name}\"", "'{name}'", "\"x{name}y\"", "a'{name}'b"})
      printed("cd " + folder + "; printf '%s' " + word);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "hit")) << name;
  }
  ended_.status.mutable_jobs(0)->set_name("two  words $HOME");
  EXPECT_EQ(printed("printf '%s' {name}"), "two  words $HOME");
  EXPECT_EQ(printed("printf '%s' '{name}'"), "two  words $HOME");
}

TEST_F(EndHookTest, OfAGroupItTellsHowAllEnded) {
  ended_.number = 11;
  ended_.is_group = true;
  ended_.status.mutable_jobs(0)->set_group(11);
  wire::JobGroup& group = *ended_.status.add_groups();
  group.set_number(11);
  group.set_name("jobs.toml");
  group.set_size(1);
  EXPECT_EQ(printed("echo {job} {kind} {group} {name} {state} {submitter}"),
            "11 group 11 jobs.toml failed ann@host\n");
}

TEST_F(EndHookTest, SaysWhatIsWrong) {
  EXPECT_THAT(EndHook::make("echo {jobs}").error().message,
              AllOf(HasSubstr("{jobs}"), HasSubstr("these are: {error}, {group}, {job}")));
  EXPECT_THAT(call("exit 3").error().message, HasSubstr("--on-done for job 12: it ended with exit code 3"));
  stop_ = true;
  EXPECT_THAT(call("sleep 100").error().message, HasSubstr("the next one calls it again"));
}

}  // namespace
}  // namespace penumbra
