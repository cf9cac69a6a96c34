// Tests `penumbra sbatch` without Slurm: sbatch and the commands beside it are scripts that write down how
// they were called. tests/slurm runs what it writes on a real cluster.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernels/host/process.h"
#include "scheduler/files/quoting.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::sbatch_command_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

class Sbatch : public ::testing::Test {
 protected:
  Sbatch() {
    write_small_scene(folder_ / "s.xml");
    std::filesystem::create_directory(folder_ / "bin");
    fake("sinfo", "echo node1 node1 10.0.0.1; echo node2 node2 " + host_name());
    fake("sbatch", "case $* in *scheduler*) echo 17 ;; *) echo '18;cluster' ;; esac");
    fake("squeue", "");
    fake("scancel", "");
  }
  /// A command that logs its words and then does what the shell makes of the line.
  void fake(const std::string& name, const std::string& line) {
    const auto file = folder_ / ("bin/" + name);
    write_text(file, "#!/bin/sh\necho " + name + " \"$@\" >>" + shell_quoted((folder_ / "log").string()) +
                         "\n" + line + "\n");
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }
  ProgramResult run(const std::string& words) {
    return run_shell(folder_.path(), "PATH=\"$PWD/bin:$PATH\" penumbra sbatch " + words);
  }
  /// Where nothing is but what the test has put there.
  ProgramResult without_slurm(const std::string& words) {
    return run_shell(folder_.path(), "PATH=\"$PWD/bin\" " + shell_quoted(PENUMBRA_BINARY_DIR "/penumbra") +
                                         " sbatch " + words);
  }
  [[nodiscard]] std::string text(const std::string& name) const { return file_contents(folder_ / name); }

  TemporaryFolder folder_;
};

TEST_F(Sbatch, WritesSchedulerWorkersAndKeys) {
  const ProgramResult done =
      run("s.xml --spp 64 --workers 32 --cpus 8 --time 1-12 --partition long --account film");
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(text("s.slurm/scheduler.sbatch"),
              AllOf(StartsWith("#!/bin/sh\n"), HasSubstr("--cpus-per-task=8 --requeue --open-mode=append"),
                    HasSubstr("#SBATCH --time=1-12\n"), HasSubstr("#SBATCH --partition=long\n"),
                    HasSubstr("#SBATCH --account=film\n"), HasSubstr("--threads=8"), HasSubstr("--spp=64"),
                    HasSubstr("--listen=0.0.0.0:0"), Not(HasSubstr("--workers"))));
  EXPECT_THAT(text("s.slurm/workers.sbatch"),
              AllOf(StartsWith("#!/bin/sh\n"), HasSubstr("--array=1-32"), HasSubstr("--retry-for 600"),
                    HasSubstr("#SBATCH --partition=long\n"), HasSubstr("s.slurm/address")));
  EXPECT_THAT(done.out, AllOf(HasSubstr("submit  sh "), HasSubstr("scancel $(cat ")));
  EXPECT_THAT(text("log"), Not(HasSubstr("sbatch"))) << "nothing is submitted";
  EXPECT_TRUE(std::filesystem::exists(folder_ / "s.slurm/keys/worker/work.token"));
  const std::string key = text("s.slurm/keys/worker/key.pem");
  ASSERT_EQ(run("s.xml --spp 8").exit_code, 0) << "written anew";
  EXPECT_EQ(text("s.slurm/keys/worker/key.pem"), key) << "the keys stay";
}

TEST_F(Sbatch, TakesFramesOfAShot) {
  const ProgramResult done = run("s.xml --frames 1-4x3 --order preview -o 'out/s.####.exr'");
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(text("s.slurm/scheduler.sbatch"),
              AllOf(HasSubstr("--frames=1-4x3"), HasSubstr("--order=preview"), HasSubstr("out/s.####.exr")));
}

TEST_F(Sbatch, NamesTheNodesOfThePartitionInNewKeys) {
  ASSERT_EQ(run("s.xml --partition long").exit_code, 0);
  EXPECT_THAT(text("log"), HasSubstr("--partition=long"));
  const ProgramResult certificate = run_shell(
      folder_.path(), "openssl x509 -noout -ext subjectAltName -in s.slurm/keys/scheduler/certificate.pem");
  if (certificate.exit_code != 0) GTEST_SKIP() << "there is no openssl";
  EXPECT_THAT(certificate.out, AllOf(HasSubstr("DNS:node1"), HasSubstr("DNS:node2"), HasSubstr("10.0.0.1"),
                                     HasSubstr("DNS:localhost")));
}

TEST_F(Sbatch, SubmitsBothOrNone) {
  const ProgramResult done = run("s.xml --submit");
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("submitted: scheduler 17, workers 18"));
  EXPECT_EQ(text("s.slurm/jobs"), "17 18\n");
  EXPECT_THAT(text("log"), HasSubstr("sbatch --parsable scheduler.sbatch\n"
                                     "sbatch --parsable --dependency=after:17 workers.sbatch\n"));

  fake("squeue", "echo 18 is there");
  const ProgramResult twice = run("s.xml --submit");
  EXPECT_EQ(twice.exit_code, 1);
  EXPECT_THAT(twice.err, HasSubstr("jobs 17 18 of this render are still in the queue"));
  EXPECT_THAT(text("log"), HasSubstr("--jobs=17,18"));
  fake("squeue", "");

  fake("sbatch", "case $* in *scheduler*) echo 19 ;; *) echo 'no such partition' >&2; exit 1 ;; esac");
  const ProgramResult half = run("s.xml --submit");
  EXPECT_EQ(half.exit_code, 1);
  EXPECT_THAT(half.err, HasSubstr("not submitted:\nno such partition"));
  EXPECT_THAT(text("log"), HasSubstr("scancel 19\n"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "s.slurm/jobs"));

  fake("sbatch", "echo 'the controller does not answer' >&2; exit 1");
  EXPECT_THAT(run("s.xml --submit").err, HasSubstr("not submitted:\nthe controller does not answer"));
  std::filesystem::remove(folder_ / "bin/sbatch");
  const ProgramResult none = without_slurm("s.xml --submit");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("there is no sbatch here"));
}

/// The scripts are run as Slurm would run them, from a folder and with names that a shell would take apart.
TEST_F(Sbatch, ScriptsRenderWhateverTheNamesAre) {
  const std::string nasty = "it's $(touch here) \"2\" & ü";
  std::filesystem::create_directory(folder_ / nasty);
  write_small_scene(folder_ / nasty / "a b.xml");
  const ProgramResult done =
      run_shell(folder_ / nasty,
                "PATH=\"$OLDPWD/bin:../bin:$PATH\" penumbra sbatch 'a b.xml' --workers 1 --cpus 1 --spp 64 "
                "-D albedo=0.4 --set integrator.max_depth=3 --set sampler.seed=2 --denoise=nlmeans "
                "--cryptomatte --crop 0,0,8,8 -o 'out $x/b.exr'");
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const std::string there = shell_quoted((folder_ / nasty / "a b.slurm").string());
  // The worker first: it waits for the address.
  const ProgramResult ran = run_shell(
      folder_.path(), "export PENUMBRA_CACHE=off; sh " + there + "/workers.sbatch >worker.log 2>&1 & sh " +
                          there + "/scheduler.sbatch; code=$?; wait $! && exit $code");
  ASSERT_EQ(ran.exit_code, 0) << ran.out << ran.err << text("worker.log");
  EXPECT_EQ(file_contents(folder_ / nasty / "a b.slurm/address"), "ended\n");
  const ProgramResult here =
      run_shell(folder_ / nasty,
                "penumbra render 'a b.xml' --spp 64 -D albedo=0.4 --set integrator.max_depth=3 --set "
                "sampler.seed=2 --denoise=nlmeans --cryptomatte --crop 0,0,8,8 -o here.exr -q");
  ASSERT_EQ(here.exit_code, 0) << here.err;
  EXPECT_TRUE(file_contents(folder_ / nasty / "here.exr") == file_contents(folder_ / nasty / "out $x/b.exr"));
  EXPECT_TRUE(file_contents(folder_ / nasty / "here-denoised.exr") ==
              file_contents(folder_ / nasty / "out $x/b-denoised.exr"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "here")) << "nothing was expanded";
  EXPECT_FALSE(std::filesystem::exists(folder_ / nasty / "here"));
}

TEST_F(Sbatch, BadInputIsFoundBeforeTheQueue) {
  const std::pair<const char*, const char*> cases[] = {
      {"none.xml", "none.xml"},
      {"s.xml --launch srun", "--launch is not for `penumbra sbatch`: the workers are an array"},
      {"s.xml --estimate", "--estimate is not for"},
      {"s.xml --pixel 1,1", "--pixel is not for"},
      {"s.xml --restart", "remove IMAGE.checkpoint instead"},
      {"s.xml --time tomorrow", "is no time limit of Slurm"},
      {"s.xml --time ''", "is no time limit of Slurm"},
      {"s.xml --partition 'a b'", "--partition: 'a b' has characters"},
      {"s.xml --partition ''", "--partition"},
      {"s.xml --option '--comment=\"x\"'", "--option"},
      {"s.xml --stop-after 100 --spp 4", "--stop-after 100"},
      {"s.xml -o x.gif", "x.gif"},
      {"s.xml --folder s.xml/x", "s.xml"},
      {"s.xml --keys s.xml", "--keys"},
  };
  for (const auto& [words, message] : cases) {
    const ProgramResult done = run(words);
    EXPECT_EQ(done.exit_code, 2) << words;
    EXPECT_THAT(done.err, HasSubstr(message)) << words;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "s.slurm/submit.sh")) << words;
  }
  std::filesystem::remove(folder_ / "bin/sinfo");
  const ProgramResult done = without_slurm("s.xml");
  EXPECT_EQ(done.exit_code, 2);
  EXPECT_THAT(done.err, AllOf(HasSubstr("cannot find the program sinfo"), HasSubstr("penumbra keys")));
}

TEST_F(Sbatch, TakesJobFilesAndWritesBesideThem) {
  std::filesystem::create_directory(folder_ / "jobs");
  write_text(folder_ / "jobs/night.toml", "[[render]]\nscene = \"../s.xml\"\nseed = [1, 2]\nspp = 4\n");
  ASSERT_EQ(run("jobs/night.toml --worker-partition cheap").exit_code, 0);
  EXPECT_THAT(text("jobs/night.slurm/scheduler.sbatch"),
              AllOf(HasSubstr("--job-name=night "), HasSubstr("render \\\n    jobs/night.toml"),
                    Not(HasSubstr("cheap"))));
  EXPECT_THAT(text("jobs/night.slurm/workers.sbatch"), HasSubstr("#SBATCH --partition=cheap\n"));
  write_text(folder_ / "jobs/bad.toml", "[[render]]\nscene = \"none.xml\"\n");
  EXPECT_EQ(run("jobs/bad.toml").exit_code, 2);
}

}  // namespace
}  // namespace penumbra::sbatch_command_test
