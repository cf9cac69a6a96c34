// Tests `penumbra serve`, `submit`, `status`, `fetch` and the others as users run them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <thread>

#include "tests/scheduler/cli/moving_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

using Arguments = std::vector<std::string>;

class Service : public ::testing::Test {
 protected:
  void SetUp() override { write_small_scene(folder_ / "s.xml"); }

  void serve(const Arguments& more = {"--workers", "1", "--threads", "1"}) {
    // Into a file of its own: programs that run meanwhile have the same names for theirs.
    Arguments arguments{"-c",
                        "exec \"$0\" \"$@\" >>service.log 2>&1",
                        PENUMBRA_BINARY_DIR "/penumbra",
                        "serve",
                        "--listen",
                        address_,
                        "--spool",
                        "spool",
                        "--checkpoint-interval",
                        "0.02"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    service_ = std::make_unique<Program>(folder_.path(), "/bin/sh", arguments);
    for (int i = 0; i < 1000 && run({"status"}).exit_code != 0; ++i) std::this_thread::sleep_for(10ms);
  }
  void kill_service() {
    service_->send(SIGKILL);
    service_->wait();
  }
  ProgramResult run(Arguments arguments) const {
    arguments.insert(arguments.end(), {"--to", address_});
    return run_penumbra(folder_.path(), arguments);
  }
  /// The number that it got.
  std::string submit(const Arguments& more) const {
    Arguments arguments{"submit", "s.xml", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult submitted = run(arguments);
    EXPECT_EQ(submitted.exit_code, 0) << submitted.err;
    return submitted.out.substr(0, submitted.out.find('\n'));
  }
  [[nodiscard]] nlohmann::json status() const {
    const ProgramResult result = run({"status", "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out, nullptr, false);
  }
  [[nodiscard]] nlohmann::json job(const std::string& number) const {
    for (const auto& job : status()["jobs"])
      if (std::to_string(job["job"].get<int>()) == number) return job;
    return nullptr;
  }
  /// Until the job has this state, or this many samples.
  bool comes(const std::string& number, const std::string& state, std::uint64_t samples = 0) const {
    for (int i = 0; i < 2000; ++i) {
      const nlohmann::json now = job(number);
      if (now["state"] == state && now["samples_done"] >= samples) return true;
      std::this_thread::sleep_for(10ms);
    }
    return false;
  }
  void render(const Arguments& more, const std::string& out) const {
    Arguments arguments{"render", "s.xml", "-q", "-o", out, "--threads", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult rendered = run_penumbra(folder_.path(), arguments);
    ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
  }
  [[nodiscard]] std::string contents(const std::string& name) const { return file_contents(folder_ / name); }

  /// Whether the service that serve() started says this before long.
  [[nodiscard]] bool service_says(const std::string& words) const {
    for (int i = 0; i < 1000 && !contents("service.log").contains(words); ++i)
      std::this_thread::sleep_for(10ms);
    return contents("service.log").contains(words);
  }

  /// What programs here have said once it has these words, or after a while.
  [[nodiscard]] std::string wait_for_words(const std::regex& words) const {
    std::string said;
    for (int i = 0; i < 1000 && !std::regex_search(said, words); ++i) {
      std::this_thread::sleep_for(10ms);
      said.clear();
      for (const std::string& name : folder_.names())
        if (name.starts_with(".")) said += contents(name);
    }
    return said;
  }

  const TemporaryFolder folder_;
  const std::string address_ = "unix:" + (folder_ / "socket").string();
  std::unique_ptr<Program> service_;
};

const Arguments kLong = {"--spp", "20000", "--pass", "32", "--tile", "8"};

// One that is stopped takes connections as long as the kernel keeps them, and answers nothing.
TEST_F(Service, OneThatIsBusyIsWaitedFor) {
  serve({"--workers", "0"});
  service_->send(SIGSTOP);
  std::jthread later([&] {
    std::this_thread::sleep_for(2500ms);
    service_->send(SIGCONT);
  });
  const ProgramResult result = run({"status"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("waiting for the service at " + address_));
}

TEST_F(Service, TheSameBytesAsRender) {
  serve();
  const std::string job = submit({"--spp", "20", "--seed", "7", "-D", "albedo=0.3", "-o", "a.exr"});
  const ProgramResult fetched = run({"fetch", job, "--wait", "-o", "out"});
  EXPECT_EQ(fetched.exit_code, 0) << fetched.err;
  EXPECT_THAT(fetched.out, HasSubstr("out/a.exr"));
  render({"--spp", "20", "--seed", "7", "-D", "albedo=0.3"}, "ref.exr");
  EXPECT_EQ(contents("out/a.exr"), contents("ref.exr"));
  EXPECT_EQ(contents("out/a.png"), contents("ref.png"));
  const auto statistics = nlohmann::json::parse(contents("out/a.json"));
  EXPECT_EQ(statistics["complete"], true);
  EXPECT_EQ(statistics["settings"]["seed"], 7);
  EXPECT_EQ(statistics["command_line"][1], "submit");
}

TEST_F(Service, LinesOfInputAreAnsweredInTurn) {
  serve();
  write_small_scene(folder_ / "u.xml");
  write_text(folder_ / "lines", R"(["s.xml", "--spp", "4", "-D", "albedo=0.3", "-o", "a.exr"]
["s.xml", "--spp", "4", "--set", "integrator.max_depth=2", "-o", "b.exr"]
["s.xml", "u.xml", "--spp", "4", "--seed", "2", "-o", "{scene}.exr"]
["t.xml"]
["s.xml", "--sp", "4"]
["s.xml", "--workers", "2"]
{"scene": "s.xml"}
["s.xml", "--spp", "3"])");
  const ProgramResult result =
      run_shell(folder_.path(), "penumbra submit --lines --to " + address_ + " <lines");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  std::istringstream lines(result.out);
  std::vector<nlohmann::json> answers;
  for (std::string line; std::getline(lines, line);) answers.push_back(nlohmann::json::parse(line));
  const std::tuple<int, int, std::string> expected[] = {{1, 0, ""},
                                                        {2, 0, ""},
                                                        {3, 0, ""},
                                                        {0, 1, "no file 't.xml'"},
                                                        {0, 2, "--sp"},
                                                        {0, 2, "--workers is not of a job"},
                                                        {0, 2, "JSON array of words"},
                                                        {6, 0, ""}};
  ASSERT_EQ(answers.size(), std::size(expected)) << result.out;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const auto& [number, code, message] = expected[i];
    EXPECT_EQ(answers[i]["number"], number) << i;
    EXPECT_EQ(answers[i]["exit_code"], code) << i;
    EXPECT_THAT(answers[i]["messages"].get<std::string>(), HasSubstr(message)) << i;
  }
  EXPECT_EQ(run({"fetch", "1", "2", "3", "6", "--wait", "-o", "out"}).exit_code, 0);
  render({"--spp", "4", "-D", "albedo=0.3"}, "a.exr");
  render({"--spp", "4", "--set", "integrator.max_depth=2"}, "b.exr");
  render({"--spp", "4", "--seed", "2"}, "s.exr");
  for (const char* name : {"a.exr", "b.exr", "s.exr"})
    EXPECT_TRUE(contents(std::string("out/") + name) == contents(name)) << name;
  EXPECT_EQ(run({"submit", "--lines", "s.xml"}).exit_code, 2);
  EXPECT_THAT(run({"submit"}).err, HasSubstr("say which SCENE to submit"));
}

TEST_F(Service, AJobWithPhotonMapsHasTheirPassesAndTiles) {
  serve({"--workers", "2", "--threads", "1"});
  const std::string one = submit({"--integrator", "ppm", "--spp", "20", "-o", "a.exr"});
  const std::string four =
      submit({"--integrator", "ppm", "--spp", "20", "--pass", "4", "--tile", "8", "-o", "b.exr"});
  const ProgramResult fetched = run({"fetch", one, four, "--wait", "-o", "out"});
  ASSERT_EQ(fetched.exit_code, 0) << fetched.err;
  const auto settings = nlohmann::json::parse(contents("out/a.json"))["settings"];
  EXPECT_EQ(settings["samples_per_pass"], 1);
  EXPECT_EQ(settings["tile"], 256);
  render({"--integrator", "ppm", "--spp", "20"}, "a.exr");
  render({"--integrator", "ppm", "--spp", "20", "--pass", "4"}, "b.exr");
  EXPECT_TRUE(contents("out/a.exr") == contents("a.exr"));
  EXPECT_TRUE(contents("out/b.exr") == contents("b.exr"));
}

TEST_F(Service, NamesOfObjectsTravelWithTheirJob) {
  serve();
  const std::string job = submit({"--cryptomatte", "-o", "a.exr"});
  EXPECT_EQ(run({"fetch", job, "--wait", "-o", "out"}).exit_code, 0);
  render({"--cryptomatte"}, "ref.exr");
  EXPECT_THAT(contents("ref.exr"), HasSubstr("CryptoObject00.R"));
  EXPECT_TRUE(contents("out/a.exr") == contents("ref.exr"));
}

TEST_F(Service, DenoisedImagesComeWithTheirImages) {
  serve();
  const std::string job = submit({"--denoise", "--spp", "4", "-o", "a.exr"});
  const ProgramResult fetched = run({"fetch", job, "--wait", "-o", "out"});
  EXPECT_EQ(fetched.exit_code, 0) << fetched.err;
  EXPECT_THAT(fetched.out, AllOf(HasSubstr("out/a-denoised.exr"), HasSubstr("out/a-denoised.png")));
  render({"--denoise", "--spp", "4"}, "ref.exr");
  EXPECT_TRUE(contents("out/a.exr") == contents("ref.exr"));
  EXPECT_TRUE(contents("out/a-denoised.exr") == contents("ref-denoised.exr"));
}

TEST_F(Service, AJobFileIsAsManyJobs) {
  write_text(folder_ / "jobs.toml",
             "[[render]]\nscene = 's.xml'\nseed = [1, 2]\nspp = 4\n[[render]]\nscene = 's.xml'\nspp = 2\n"
             "out = 'first.exr'\npriority = 3\n");
  serve();
  const ProgramResult submitted = run({"submit", "jobs.toml"});
  EXPECT_EQ(submitted.exit_code, 0) << submitted.err;
  EXPECT_THAT(submitted.out, AllOf(HasSubstr("group 1: jobs.toml, 3 renders\n  job 2: "),
                                   HasSubstr("job 4: "), HasSubstr("seed=2")));
  const ProgramResult fetched = run({"fetch", "2", "3-4", "--wait", "-o", "out"});
  EXPECT_EQ(fetched.exit_code, 0) << fetched.err;
  render({"--spp", "4", "--seed", "2"}, "ref.exr");
  EXPECT_EQ(contents("out/s-2.exr"), contents("ref.exr"));
  EXPECT_EQ(job("2")["priority"], 3);
}

TEST_F(Service, AGroupIsOneThing) {
  for (const char* shot : {"1", "2"}) write_small_scene(folder_ / (std::string("shot") + shot + ".xml"));
  std::filesystem::create_directories(folder_ / "project");
  write_text(
      folder_ / "project/night.toml",
      "[defaults]\nspp = 2\n[[render]]\nscene = '../shot{frame}.xml'\nframe = '1..2'\n"
      "out = 'shots/{frame:04}/beauty.exr'\nafter = 'first'\n[[render]]\nname = 'first'\nscene = '../s.xml'\n"
      "out = '../elsewhere/s.exr'\n");
  serve({"--workers", "0"});
  const ProgramResult submitted = run({"submit", "project/night.toml", "-q"});
  EXPECT_EQ(submitted.out, "1\n") << submitted.err;
  EXPECT_EQ(run({"prioritize", "night.toml", "--priority", "4"}).exit_code, 0);
  EXPECT_EQ(status()["groups"][0]["priority"], 4);
  kill_service();
  serve({"--workers", "1", "--threads", "1", "--on-done", "echo {kind} {job} {state} '{name}' >>ends.txt"});
  const ProgramResult fetched = run({"fetch", "night.toml", "--wait", "-o", "out"});
  EXPECT_EQ(fetched.exit_code, 0) << fetched.err;
  EXPECT_THAT(fetched.out,
              AllOf(HasSubstr("out/shots/0001/beauty.exr\n"), HasSubstr("out/shots/0002/beauty.png\n"),
                    HasSubstr("out/s.exr\n")));  // never outside of out
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/shots/0002/beauty.exr"));
  const nlohmann::json now = status();
  EXPECT_EQ(now["groups"][0]["state"], "done");
  EXPECT_EQ(now["groups"][0]["jobs"]["done"], 3);
  EXPECT_LE(job("2")["ended"], job("3")["begun"]);  // the first came first
  std::string ends;
  for (int i = 0; i < 1000 && ends.find("group 1") == std::string::npos; ++i) {
    std::this_thread::sleep_for(10ms);
    if (std::filesystem::exists(folder_ / "ends.txt")) ends = contents("ends.txt");
  }
  EXPECT_THAT(ends, AllOf(HasSubstr("frame 2 done"), HasSubstr("frame 4 done"),
                          HasSubstr("group 1 done night.toml\n")));
  // A link that leads out of the folder is not followed.
  std::filesystem::remove_all(folder_ / "out");
  std::filesystem::create_directories(folder_ / "out");
  std::filesystem::create_directory_symlink(folder_ / "project", folder_ / "out/shots");
  const ProgramResult linked = run({"fetch", "1", "-o", "out"});
  EXPECT_EQ(linked.exit_code, 1);
  EXPECT_THAT(linked.err, HasSubstr("leads out of out through a link"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "project/0001"));
}

// Killed at any moment, the service goes on, also with the denoising; the files are those of `penumbra
// render`.
TEST_F(Service, AShotIsDenoisedInTime) {
  const Arguments shot{"shot.xml",  "--frames",         "1-5",   "--spp", "8",
                       "--denoise", "--seed-per-frame", "frame", "-o",    "a.####.exr"};
  write_moving_scene(folder_ / "shot.xml");
  Arguments render{"render"}, submit{"submit"};
  for (Arguments* arguments : {&render, &submit})
    arguments->insert(arguments->end(), shot.begin(), shot.end());
  ASSERT_EQ(run_penumbra(folder_.path(), render).exit_code, 0);
  serve();
  ASSERT_EQ(run(submit).exit_code, 0);
  for (const int wait : {100, 250, 400}) {
    std::this_thread::sleep_for(std::chrono::milliseconds(wait));
    kill_service();
    serve();
  }
  const ProgramResult fetched = run({"fetch", "1", "--wait", "-o", "out"});
  ASSERT_EQ(fetched.exit_code, 0) << fetched.err;
  for (int frame = 1; frame <= 5; ++frame)
    for (const char* ending : {".exr", "-denoised.exr", "-denoised.png"}) {
      const std::string name = "a.000" + std::to_string(frame) + ending;
      EXPECT_TRUE(contents("out/" + name) == contents(name)) << name;
    }
}

TEST_F(Service, AShotIsAGroupOfFrames) {
  write_moving_scene(folder_ / "shot.xml");
  serve({"--workers", "0"});
  const ProgramResult submitted =
      run({"submit", "shot.xml", "--frames", "1-6", "--order", "preview", "-o", "shot.####.exr"});
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  EXPECT_THAT(submitted.out, HasSubstr("group 1: shot.xml, 6 renders\n  job 2: shot.xml frame=1\n"
                                       "  job 3: shot.xml frame=6\n  job 4: shot.xml frame=3\n"));
  EXPECT_EQ(run({"cancel", "1", "--frames", "2-3"}).exit_code, 0);
  EXPECT_THAT(run({"status"}).out, HasSubstr("frames 1-6: 2-3 cancelled, 1,4-6 queued"));
  EXPECT_EQ(run({"prioritize", "shot.xml", "--frames", "4", "--priority", "9"}).exit_code, 0);
  const nlohmann::json now = status();
  for (const auto& job : now["jobs"]) EXPECT_EQ(job["priority"], job["frame"] == 4 ? 9 : 0);
  EXPECT_EQ(now["groups"][0]["frames"]["cancelled"], nlohmann::json({2, 3}));
  const ProgramResult unknown = run({"retry", "1", "--frames", "5-9"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("group 1 has no frames 7-9; it has 1-6"));
  EXPECT_THAT(run({"retry", "1", "--frames", "4-5"}).err,
              HasSubstr("nothing to do for these frames of group 1: 4-5 queued"));
  EXPECT_EQ(run({"retry", "1", "--frames", "2,5"}).exit_code, 0);
  EXPECT_THAT(run({"status"}).out, HasSubstr("frames 1-6: 3 cancelled, 1-2,4-6 queued"));
  kill_service();
  serve();
  const ProgramResult fetched = run({"fetch", "1", "--frames", "2,5", "--wait", "-o", "out"});
  EXPECT_EQ(fetched.exit_code, 0) << fetched.err;
  EXPECT_THAT(fetched.out, AllOf(HasSubstr("out/shot.0002.exr\n"), HasSubstr("out/shot.0005.png\n"),
                                 Not(HasSubstr("0004"))));
  const ProgramResult rendered = run_penumbra(
      folder_.path(), {"render", "shot.xml", "--frame", "5", "-q", "-o", "ref.exr", "--threads", "1"});
  ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
  EXPECT_TRUE(contents("out/shot.0005.exr") == contents("ref.exr"));
  EXPECT_FALSE(contents("out/shot.0002.exr") == contents("ref.exr"));
  const std::string still = submit({"--spp", "1"});
  EXPECT_THAT(run({"retry", still, "--frames", "1"}).err, HasSubstr("it is no shot"));
  EXPECT_THAT(run({"submit", "shot.xml", "--frames", "7", "-q"}).out, HasSubstr("9\n")) << "one, and a group";
}

TEST_F(Service, WhatWasCancelledGoesOnWithRetry) {
  serve();
  write_text(folder_ / "jobs.toml",
             "[[render]]\nscene = 's.xml'\nname = 'a'\nspp = 20000\npass = 32\ntile = 8\n"
             "[[render]]\nscene = 's.xml'\nafter = 'a'\nspp = 2\nout = 'b.exr'\n");
  ASSERT_EQ(run({"submit", "jobs.toml", "-q"}).out, "1\n");
  ASSERT_TRUE(comes("2", "rendering", 24 * 20 * 32));
  EXPECT_EQ(run({"cancel", "2"}).exit_code, 0);
  ASSERT_TRUE(comes("2", "cancelled"));
  EXPECT_THAT(job("3")["error"].get<std::string>(), HasSubstr("`penumbra retry 2` queues both again"));
  kill_service();
  serve();
  EXPECT_EQ(run({"retry", "1"}).exit_code, 0);
  const ProgramResult fetched = run({"fetch", "1", "--wait", "--remove", "-o", "out"});
  EXPECT_EQ(fetched.exit_code, 0) << fetched.err;
  render(kLong, "ref.exr");
  EXPECT_EQ(contents("out/s.exr"), contents("ref.exr"));
  EXPECT_GT(nlohmann::json::parse(contents("out/s.json"))["samples"]["before"], 0);
  EXPECT_TRUE(status()["groups"].empty());
  EXPECT_THAT(run({"retry", "7-9"}).err, HasSubstr("there is no job from 7 to 9"));
  EXPECT_THAT(run({"cancel", "jobs.toml"}).err, HasSubstr("there is no group 'jobs.toml'"));
}

TEST_F(Service, OldJobsAreRemoved) {
  serve();
  EXPECT_TRUE(comes(submit({"--spp", "2"}), "done"));
  kill_service();
  serve({"--workers", "0", "--keep", "0s"});
  for (int i = 0; i < 1000 && !status()["jobs"].empty(); ++i) std::this_thread::sleep_for(10ms);
  EXPECT_TRUE(status()["jobs"].empty());
}

TEST_F(Service, NothingIsLostByItsDeath) {
  serve();
  Arguments first = kLong;
  first.insert(first.end(), {"-o", "long.exr"});
  const std::string rendering = submit(first), waiting = submit({"--spp", "3", "-o", "short.exr"});
  // Some of it is done, and kept.
  const std::filesystem::path checkpoint = folder_ / "spool/jobs" / rendering / "long.exr.checkpoint";
  for (int i = 0; i < 2000 && !std::filesystem::exists(checkpoint); ++i) std::this_thread::sleep_for(5ms);
  ASSERT_TRUE(std::filesystem::exists(checkpoint));
  kill_service();
  const ProgramResult away = run({"status"});
  EXPECT_EQ(away.exit_code, 1);
  EXPECT_THAT(away.err, HasSubstr("no service answers"));
  serve({"--workers", "2", "--threads", "1"});
  EXPECT_EQ(job(waiting)["state"], "queued");
  ASSERT_TRUE(comes(rendering, "rendering"));
  kill_service();
  serve();
  const ProgramResult fetched = run({"fetch", rendering, waiting, "--wait", "-o", "out"});
  EXPECT_EQ(fetched.exit_code, 0) << fetched.err;
  render(kLong, "ref.exr");
  EXPECT_EQ(contents("out/long.exr"), contents("ref.exr"));
  render({"--spp", "3"}, "ref2.exr");
  EXPECT_EQ(contents("out/short.exr"), contents("ref2.exr"));
  const auto statistics = nlohmann::json::parse(contents("out/long.json"));
  EXPECT_GT(statistics["samples"]["before"], 0);
  EXPECT_FALSE(std::filesystem::exists(checkpoint));
}

TEST_F(Service, ACleanEndKeepsWhatIsUnderWay) {
  serve();
  const std::string number = submit(kLong);
  ASSERT_TRUE(comes(number, "rendering", 1000));
  service_->send(SIGTERM);
  const ProgramResult ended = service_->wait();
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  serve();
  EXPECT_EQ(run({"fetch", number, "--wait", "-o", "out"}).exit_code, 0);
  render(kLong, "ref.exr");
  EXPECT_EQ(contents("out/s.exr"), contents("ref.exr"));
  EXPECT_GT(nlohmann::json::parse(contents("out/s.json"))["samples"]["before"], 0);
}

TEST_F(Service, CancelKeepsWhatIsRendered) {
  serve();
  const std::string rendering = submit({"--spp", "2000000", "--pass", "32"}), waiting = submit(kLong);
  ASSERT_TRUE(comes(rendering, "rendering", 24 * 20 * 32));
  EXPECT_EQ(run({"cancel", rendering, waiting}).exit_code, 0);
  ASSERT_TRUE(comes(rendering, "cancelled"));
  ASSERT_TRUE(comes(waiting, "cancelled"));
  const ProgramResult fetched = run({"fetch", rendering, "-o", "out"});
  EXPECT_EQ(fetched.exit_code, 1);
  EXPECT_THAT(fetched.err, HasSubstr("cancelled"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/s.exr"));
  const auto statistics = nlohmann::json::parse(contents("out/s.json"));
  EXPECT_EQ(statistics["complete"], false);
  EXPECT_TRUE(service_says("cancelled: what was rendered before is kept")) << contents("service.log");
  EXPECT_THAT(contents("service.log"), Not(HasSubstr("signal")));
  const ProgramResult again = run({"cancel", rendering});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.err, HasSubstr("is cancelled"));
  EXPECT_EQ(run({"fetch", "--all", "--remove", "-q", "-o", "out"}).exit_code, 1);
  EXPECT_TRUE(status()["jobs"].empty());
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "spool/jobs"));
}

TEST_F(Service, WhatAnEarlierServiceRenderedOfACancelledJobIsKept) {
  serve();
  const std::string slow = submit({"--spp", "2000000", "--pass", "32", "--tile", "8"});
  const std::filesystem::path checkpoint = folder_ / "spool/jobs" / slow / "s.exr.checkpoint";
  for (int i = 0; i < 2000 && !std::filesystem::exists(checkpoint); ++i) std::this_thread::sleep_for(5ms);
  kill_service();
  serve({"--workers", "0"});
  EXPECT_EQ(run({"cancel", slow}).exit_code, 0);
  ASSERT_TRUE(comes(slow, "cancelled"));
  EXPECT_EQ(run({"fetch", slow, "-o", "out"}).exit_code, 1);
  const auto statistics = nlohmann::json::parse(contents("out/s.json"));
  EXPECT_GT(statistics["samples"]["total"], 0);
  EXPECT_EQ(statistics["samples"]["total"], statistics["samples"]["before"]);
  EXPECT_TRUE(std::filesystem::exists(checkpoint)) << "for `penumbra retry`";
}

TEST_F(Service, ATimeBudgetIsOfTheJobsOwnTime) {
  serve();
  const std::string budgeted =
      submit({"--spp", "100000000", "--pass", "32", "--time-budget", "0.5", "-o", "b.exr"});
  const std::string urgent =
      submit({"--spp", "100000000", "--pass", "32", "--priority", "2", "--time-budget", "1"});
  const ProgramResult fetched = run({"fetch", budgeted, urgent, "--wait", "-o", "out"});
  EXPECT_EQ(fetched.exit_code, 0) << fetched.err;
  // As much as half of what the other one had in twice the time, or nearly: a third tells it from one pass.
  const auto samples = [&](const char* name) {
    return nlohmann::json::parse(contents(name))["samples"]["total"].get<double>();
  };
  EXPECT_GT(samples("out/b.json"), samples("out/s.json") / 6);
}

TEST_F(Service, UrgentJobsGoFirst) {
  serve();
  const std::string slow = submit({"--spp", "2000000", "--pass", "32"});
  ASSERT_TRUE(comes(slow, "rendering", 1));
  const std::string next = submit({"--spp", "2000000", "--pass", "32", "-o", "n.exr"});
  const std::string last = submit({"--spp", "4", "-o", "l.exr"});
  EXPECT_EQ(run({"prioritize", last, "--priority", "3"}).exit_code, 0);
  ASSERT_TRUE(comes(last, "done"));
  EXPECT_EQ(job(slow)["state"], "rendering");
  EXPECT_NE(job(next)["state"], "done");
  // And of those that are under way.
  const std::uint64_t before = job(next)["samples_done"];
  EXPECT_EQ(run({"prioritize", next, "--priority", "1"}).exit_code, 0);
  EXPECT_TRUE(comes(next, "rendering", before + 1));
  EXPECT_EQ(run({"cancel", slow, next}).exit_code, 0);
}

TEST_F(Service, ABadSceneStopsNothing) {
  write_text(folder_ / "bad.xml", "<scene version='3.0.0'><shape type='nonsense'/></scene>");
  serve();
  const ProgramResult submitted = run({"submit", "bad.xml", "s.xml", "--spp", "2", "-o", "out/"});
  EXPECT_EQ(submitted.exit_code, 1);
  EXPECT_THAT(submitted.err, AllOf(HasSubstr("bad.xml:1:"), HasSubstr("1 of 2 renders not submitted")));
  EXPECT_EQ(run({"fetch", "1", "--wait", "-o", "out"}).exit_code, 0);  // the group of one
}

TEST_F(Service, OtherWorkersJoin) {
  serve({"--workers", "0"});
  const std::string number = submit({"--spp", "4"});
  std::this_thread::sleep_for(100ms);
  EXPECT_NE(job(number)["state"], "done");
  const std::string worker = std::string(PENUMBRA_BINARY_DIR) + "/penumbra-worker";
  Program joined(folder_.path(), worker, {"--connect", address_});
  EXPECT_TRUE(comes(number, "done"));
  for (int i = 0; i < 500 && status()["workers"].empty(); ++i) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(status()["workers"].size(), 1u);
  // It looks for the service that comes next, until it is told to end.
  kill_service();
  serve({"--workers", "0"});
  EXPECT_TRUE(comes(submit({"--spp", "4"}), "done"));
  joined.send(SIGTERM);
  EXPECT_EQ(joined.wait().exit_code, 0);
}

TEST_F(Service, TheLossOfAnotherWorkerIsTold) {
  serve({"--workers", "1", "--threads", "1"});
  Program joined(folder_.path(), std::string(PENUMBRA_BINARY_DIR) + "/penumbra-worker",
                 {"--connect", address_, "--threads", "1"});
  const std::string number = submit({"--spp", "2000000", "--pass", "32"});
  const auto renders = [&] {
    const nlohmann::json workers = status()["workers"];
    return workers.size() == 2 && std::ranges::all_of(workers, [](const nlohmann::json& worker) {
             return worker["units"].get<int>() > 0;
           });
  };
  for (int i = 0; i < 1000 && !renders(); ++i) std::this_thread::sleep_for(10ms);
  joined.send(SIGKILL);
  joined.wait();
  EXPECT_TRUE(service_says("was lost")) << contents("service.log");
  EXPECT_THAT(status()["messages"].dump(), HasSubstr("was lost"));
  EXPECT_THAT(run({"status"}).out, HasSubstr("was lost"));
  EXPECT_EQ(run({"cancel", number}).exit_code, 0);
  EXPECT_TRUE(comes(number, "cancelled"));
  EXPECT_THAT(job(number)["problems"].dump(), HasSubstr("was lost"));
}

TEST_F(Service, OwnJobsAreChangedByTheirSubmitterAlone) {
  serve({"--workers", "0", "--own-jobs"});
  const auto as = [&](const std::string& who, const std::string& line) {
    return run_shell(folder_.path(),
                     "XDG_STATE_HOME=\"$PWD/" + who + "\" penumbra " + line + " --to " + address_);
  };
  ASSERT_EQ(as("one", "submit s.xml --spp 4").exit_code, 0);
  for (const char* change : {"cancel 1", "prioritize 1 --priority 3", "retry 1"}) {
    const ProgramResult refused = as("two", change);
    EXPECT_EQ(refused.exit_code, 1) << change;
    EXPECT_THAT(refused.err, HasSubstr("lets only who submitted a job change it")) << change;
  }
  EXPECT_EQ(as("two", "status").exit_code, 0);
  EXPECT_EQ(as("one", "prioritize 1 --priority 3").exit_code, 0);
  EXPECT_EQ(as("one", "cancel 1").exit_code, 0);
  EXPECT_TRUE(comes("1", "cancelled"));  // a job that was begun ends a little later
  const ProgramResult fetched = as("two", "fetch 1 --remove");
  EXPECT_EQ(fetched.exit_code, 1);
  EXPECT_THAT(fetched.err, HasSubstr("lets only who submitted a job change it"));
  EXPECT_EQ(job("1")["state"], "cancelled") << "it is still there";
  EXPECT_EQ(as("two", "submit s.xml --spp 4").exit_code, 0) << "the owner's secret is not needed to submit";
  const std::string secret = contents("one/penumbra/submitter");
  EXPECT_EQ(secret.size(), 33u);
  EXPECT_THAT(run({"status", "--json"}).out, Not(HasSubstr(secret.substr(0, 32))));
}

// Nobody could change such jobs later.
TEST_F(Service, OwnJobsHaveAnOwner) {
  serve({"--workers", "0", "--own-jobs"});
  std::filesystem::create_directories(folder_ / "short/penumbra");
  write_text(folder_ / "short/penumbra/submitter", "");
  const auto submit_in = [&](const std::string& state) {
    return run_shell(folder_.path(),
                     "XDG_STATE_HOME=" + state + " penumbra submit s.xml --spp 4 --to " + address_);
  };
  for (const auto& [state, why] : {std::pair("/proc", "cannot make /proc/penumbra/submitter: "),
                                   {"\"$PWD/short\"", "remove it, and a new one is made"}}) {
    const ProgramResult refused = submit_in(state);
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.err, AllOf(HasSubstr("without the secret of its submitter"), HasSubstr(why)));
  }
  EXPECT_TRUE(status()["jobs"].empty());
  std::filesystem::remove(folder_ / "short/penumbra/submitter");
  EXPECT_EQ(submit_in("\"$PWD/short\"").exit_code, 0);
}

TEST_F(Service, AFolderThatCannotBeWrittenIsNoHindrance) {
  serve({"--workers", "0"});
  const ProgramResult submitted = run_shell(
      folder_.path(), "s=$PWD/s.xml; cd /proc && penumbra submit \"$s\" --spp 4 -q --to " + address_);
  EXPECT_EQ(submitted.exit_code, 0) << submitted.err;
  EXPECT_EQ(run({"cancel", "1"}).exit_code, 0);
}

TEST_F(Service, OverTcpATokenIsWanted) {
  service_ = std::make_unique<Program>(
      folder_.path(), Arguments{"serve", "--listen", "127.0.0.1:0", "--spool", "spool", "--threads", "1"});
  const std::regex wanted("to submit: PENUMBRA_TOKEN=(\\S+) penumbra submit SCENE --to (\\S+)");
  const std::regex watching("to watch: PENUMBRA_TOKEN=(\\S+) ");
  std::smatch found, watch;
  const std::string said = wait_for_words(wanted);
  ASSERT_TRUE(std::regex_search(said, found, wanted)) << said;
  ASSERT_TRUE(std::regex_search(said, watch, watching));
  const std::string to = " --to " + found[2].str(), token = "PENUMBRA_TOKEN=" + found[1].str() + " ",
                    watch_token = "PENUMBRA_TOKEN=" + watch[1].str() + " ";
  const auto shell = [&](const std::string& line) { return run_shell(folder_.path(), line); };
  EXPECT_THAT(shell("penumbra submit s.xml" + to).err,
              AllOf(HasSubstr("token"), HasSubstr("PENUMBRA_TOKEN")));
  EXPECT_THAT(shell("PENUMBRA_TOKEN=wrong penumbra status" + to).err, HasSubstr("token is missing or wrong"));
  EXPECT_THAT(shell(watch_token + "penumbra submit s.xml" + to).err, HasSubstr("this token is for watching"));
  EXPECT_EQ(shell(watch_token + "penumbra status" + to).exit_code, 0);
  EXPECT_EQ(shell(token + "penumbra submit s.xml --spp 2" + to).exit_code, 0);
  EXPECT_EQ(shell(token + "penumbra fetch 1 --wait -o out" + to).exit_code, 0);
  // What the state says to those who may only watch has no tokens in it.
  EXPECT_THAT(shell(watch_token + "penumbra status --json" + to).out, Not(HasSubstr(found[1].str())));
}

TEST_F(Service, OverTlsWithKeys) {
  const ProgramResult made =
      run_penumbra(folder_.path(), {"keys", "farm", "--name", "localhost", "--name", "127.0.0.1"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  service_ = std::make_unique<Program>(
      folder_.path(), Arguments{"serve", "--listen", "0.0.0.0:0", "--keys", "farm/scheduler/", "--spool",
                                "spool", "--workers", "0"});
  const std::regex wanted("penumbra submit SCENE --to \\S*:([0-9]+) ");
  std::smatch found;
  const std::string said = wait_for_words(wanted);
  ASSERT_TRUE(std::regex_search(said, found, wanted)) << said;
  const std::string at = "127.0.0.1:" + found[1].str();
  const auto ask = [&](Arguments arguments, const std::string& keys) {
    arguments.insert(arguments.end(), {"--to", at});
    if (!keys.empty()) arguments.insert(arguments.end(), {"--keys", keys});
    return run_penumbra(folder_.path(), arguments);
  };
  EXPECT_THAT(ask({"status"}, "").err, HasSubstr("asks for TLS: give --keys"));
  EXPECT_THAT(ask({"cancel", "1"}, "farm/viewer").err, HasSubstr("submit.token is missing"));
  const Program worker(folder_.path(), std::string(PENUMBRA_BINARY_DIR) + "/penumbra-worker",
                       {"--connect", at, "--keys", "farm/worker"});
  EXPECT_EQ(ask({"submit", "s.xml", "--spp", "3"}, "farm/user").exit_code, 0);
  EXPECT_EQ(ask({"status"}, "farm/viewer").exit_code, 0);
  const ProgramResult fetched = ask({"fetch", "1", "--wait", "-o", "out"}, "farm");
  EXPECT_EQ(fetched.exit_code, 0) << fetched.err;
  render({"--spp", "3"}, "ref.exr");
  EXPECT_EQ(contents("out/s.exr"), contents("ref.exr"));
}

TEST_F(Service, WrongUse) {
  const auto error = [&](const Arguments& arguments) {
    const ProgramResult result = run_penumbra(folder_.path(), arguments);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    return result.err;
  };
  EXPECT_THAT(error({"serve"}), HasSubstr("--listen"));
  EXPECT_THAT(error({"serve", "--listen", "7000"}), HasSubstr("host and port"));
  EXPECT_THAT(error({"submit", "s.xml"}), HasSubstr("--to"));
  EXPECT_THAT(error({"submit", "s.xml", "--workers", "3", "--to", address_}),
              HasSubstr("--workers is not of a job"));
  EXPECT_THAT(error({"submit", "s.xml", "--resume", "--to", address_}),
              HasSubstr("--resume is not of a job"));
  const std::string help = run_penumbra(folder_.path(), {"submit", "--help"}).out;
  for (const char* refused : {"--workers", "--launch", "--listen", "--resume", "--estimate", "--force"})
    EXPECT_THAT(help, Not(HasSubstr(std::string("  ") + refused + " "))) << refused;
  EXPECT_THAT(help, AllOf(HasSubstr("  --spp "), HasSubstr("  --priority "), HasSubstr("  --backend ")));
  EXPECT_THAT(error({"fetch", "--to", address_}), HasSubstr("--all"));
  EXPECT_THAT(error({"serve", "--listen", "unix:x", "--keep", "7"}), HasSubstr("--keep"));
  EXPECT_THAT(error({"serve", "--listen", "unix:x", "--keep", "-7d"}), HasSubstr("--keep"));
  EXPECT_THAT(error({"serve", "--listen", "unix:x", "--on-done", "mail {to}"}), HasSubstr("{to}"));
  EXPECT_THAT(error({"status", "--watch", "--to", address_}), HasSubstr("needs a terminal"));
  serve();
  EXPECT_THAT(error({"serve", "--listen", "unix:other", "--spool", "spool"}), HasSubstr("another service"));
  EXPECT_THAT(run({"fetch", "0"}).err, HasSubstr("there is no group '0'"));
  const ProgramResult unknown = run({"fetch", "9"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("there is no job 9"));
}

TEST_F(Service, ARenderIsNoService) {
  // Elsewhere, since what two programs of one folder say is in one file.
  const TemporaryFolder elsewhere;
  Program render(elsewhere.path(), {"render", folder_.path() / "s.xml", "--spp", "2000000", "--listen",
                                    address_, "--threads", "1"});
  ProgramResult asked;
  for (int i = 0; i < 500; ++i) {
    asked = run({"status"});
    if (asked.err.find("no service answers") == std::string::npos) break;
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(asked.exit_code, 1);
  EXPECT_THAT(asked.err, HasSubstr("is no service"));
}

}  // namespace
}  // namespace penumbra
