// Tests `penumbra report` as users run it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <thread>

#include "scheduler/image/image.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr auto kPatience = std::chrono::seconds(100);

nlohmann::json report_of(const TemporaryFolder& folder, const std::string& name = "out") {
  return nlohmann::json::parse(file_contents(folder / name / "report.json"));
}

std::size_t finished_cells(const std::filesystem::path& out) {
  std::size_t count = 0;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(out / "cells", error))
    count +=
        entry.path().extension() == ".json" && !entry.path().filename().string().starts_with(".") ? 1 : 0;
  return count;
}

std::map<std::string, std::filesystem::file_time_type> cell_times(const std::filesystem::path& out) {
  std::map<std::string, std::filesystem::file_time_type> times;
  for (const auto& entry : std::filesystem::directory_iterator(out / "cells"))
    times[entry.path().filename().string()] = entry.last_write_time();
  return times;
}

int reference_spp(const nlohmann::json& scene) {
  int spp = 0;
  for (const auto& half : scene["reference"]["images"]) spp += half["spp"].get<int>();
  return spp;
}

class ReportCommand : public ::testing::Test {
 protected:
  void SetUp() override { write_small_scene(folder_ / "s.xml"); }
  ProgramResult run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "report");
    return run_penumbra(folder_.path(), arguments);
  }
  TemporaryFolder folder_;
};

TEST_F(ReportCommand, PhotonMappingIsComparedWithPaths) {
  const auto result = run({"s.xml", "-o", "out", "--integrator", "ppm", "--integrator", "photonmapper",
                           "--integrator", "path", "--spp", "1..2", "--seeds", "3", "--no-plots", "-q"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto scene = report_of(folder_)["scenes"][0];
  for (const auto& half : scene["reference"]["images"])
    EXPECT_THAT(half["what"].get<std::string>(), HasSubstr("path_mis"));
  ASSERT_EQ(scene["curves"].size(), 3u);
  for (const auto& curve : scene["curves"]) {
    EXPECT_EQ(curve["estimates_what_the_reference_does"], true) << curve["integrator"];
    for (const auto& point : curve["points"]) {
      const auto& split = point["relmse_split"];
      EXPECT_NEAR(split["error"].get<double>(),
                  split["bias_squared"].get<double>() + split["variance"].get<double>(), 1e-9);
    }
  }
  EXPECT_THAT(file_contents(folder_ / "out/index.html"), HasSubstr("bias²"));
}

TEST_F(ReportCommand, TwoScenesEndToEnd) {
  const auto result = run({source_path("scenes/cornell-small/cornell-small.xml"),
                           source_path("scenes/star-light/star-light.xml"),
                           "-o",
                           "out",
                           "--set",
                           "film.width=24",
                           "--set",
                           "film.height=24",
                           "--integrator",
                           "direct",
                           "--integrator",
                           "control=polygon_cv:alpha=auto,vis_samples=2",
                           "--spp",
                           "1..4",
                           "--seeds",
                           "2",
                           "--target",
                           "relmse=0.05",
                           "--target",
                           "mse=1e-30",
                           "--repeats",
                           "2"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto report = report_of(folder_);
  ASSERT_EQ(report["scenes"].size(), 2u);
  for (const auto& scene : report["scenes"]) {
    EXPECT_EQ(scene["width"], 24);
    ASSERT_EQ(scene["curves"].size(), 2u);
    ASSERT_EQ(scene["reference"]["images"].size(), 2u);
    EXPECT_GE(reference_spp(scene), 50 * 4);
    EXPECT_LT(std::abs(scene["reference"]["z_of_the_halves"].get<double>()), 5) << "path and direct agree";
    for (const auto& curve : scene["curves"]) {
      ASSERT_EQ(curve["points"].size(), 3u);
      EXPECT_LT(curve["fits"]["mse_over_spp"]["slope"].get<double>(), -0.6) << curve["label"];
      EXPECT_EQ(curve["time_to_target"].size(), 2u);
      EXPECT_TRUE(curve["estimates_what_the_reference_does"].get<bool>());
      for (const auto& image : curve["points"][0]["images"]) EXPECT_EQ(image["render_seconds"].size(), 2u);
      const auto& seconds = curve["points"][2]["seconds"];
      EXPECT_GT(seconds["render"].get<double>(), 0);
      EXPECT_GT(seconds["transfer"].get<double>(), 0);
      EXPECT_GE(seconds["total"].get<double>(),
                seconds["render"].get<double>() + seconds["transfer"].get<double>());
    }
    EXPECT_EQ(scene["equal_time"]["pictures"].size(), 2u);
  }
  const std::string html = file_contents(folder_ / "out/index.html");
  EXPECT_THAT(html, AllOf(HasSubstr("<svg"), HasSubstr("data:image/png"), HasSubstr(">control<")));
  EXPECT_FALSE(std::regex_search(html, std::regex(R"re((src|href)\s*=\s*["'](?!data:|#))re")));
  const std::string bare = std::regex_replace(html, std::regex(R"re(xmlns(:\w+)?="[^"]*")re"), "");
  EXPECT_THAT(bare, AllOf(Not(HasSubstr("http://")), Not(HasSubstr("https://"))));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/plots/star-light-time.svg"));
  for (const char* name : {"report.csv", "table.csv", "table.tex"})
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / name)) << name;
}

/// A name of which every interpreter would run a part: it makes a file `NAME-…`.
std::string hostile(const std::string& name) {
  return name + "`touch " + name + "-1` $(touch " + name + "-2);touch " + name + "-3'\"\nsystem('touch " +
         name + "-4')\n@PATH\\<b hidden>";
}

TEST_F(ReportCommand, NamesStayText) {
  const std::string scene = hostile("scene"), out = "|touch out-5;" + hostile("out");
  std::filesystem::rename(folder_ / "s.xml", folder_ / (scene + ".xml"));
  std::filesystem::create_directory(folder_ / out);
  const auto before = folder_.names();
  const auto result =
      run({scene + ".xml", "-o", out, "--integrator", hostile("label") + "</title><script>x</script>=path",
           "--budgets", "1,2", "--seeds", "2", "--reference-spp", "16", "-q"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(folder_.names(), before) << "something was run";
  std::set<std::string> plots;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / out / "plots"))
    plots.insert(entry.path().extension());
  EXPECT_THAT(plots, ::testing::ElementsAre(".gp", ".png", ".svg"));
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / out))
    EXPECT_THAT(entry.path().filename().string(), Not(::testing::MatchesRegex("(scene|out|label)-[0-9]")));
  EXPECT_THAT(file_contents(folder_ / out / "table.tex"),
              AllOf(HasSubstr("`touch label-1` \\$(touch"), Not(HasSubstr("\\<b"))));
  const std::string html = file_contents(folder_ / out / "index.html");
  EXPECT_THAT(html,
              AllOf(HasSubstr("touch label-1"), Not(HasSubstr("<script>x")), Not(HasSubstr("<b hidden"))));
}

TEST_F(ReportCommand, BackendsGiveTheSameErrors) {
  const auto result = run({"s.xml", "-o", "out", "--budgets", "1,2", "--seeds", "1", "--reference-spp", "16",
                           "--no-plots", "--backend", "native", "--backend", "opencl"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto report = report_of(folder_);
  const auto& curves = report["scenes"][0]["curves"];
  ASSERT_EQ(curves.size(), 2u);
  EXPECT_EQ(curves[1]["label"], "path_mis, opencl");
  for (int i = 0; i < 2; ++i) EXPECT_EQ(curves[0]["points"][i]["errors"], curves[1]["points"][i]["errors"]);
}

TEST_F(ReportCommand, GoesOnAfterCtrlCAndAfterAKill) {
  const std::vector<std::string> arguments = {
      "report", "s.xml", "-o", "out", "--spp", "1..4", "--seeds", "2", "--no-plots", "--reference-spp", "64"};
  for (const int signal : {SIGINT, SIGKILL}) {
    const std::size_t before = finished_cells(folder_ / "out");
    Program program(folder_.path(), arguments);
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (finished_cells(folder_ / "out") < before + 2 && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    program.send(signal);
    const auto result = program.wait();
    if (signal == SIGKILL) {
      EXPECT_EQ(result.signal, SIGKILL);
    } else {
      EXPECT_EQ(result.exit_code, 1);
      EXPECT_THAT(result.err, HasSubstr("the same command goes on"));
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/index.html"));
    EXPECT_GE(finished_cells(folder_ / "out"), before + 2);
    ASSERT_LT(finished_cells(folder_ / "out"), 8u) << "too fast to be interrupted";
  }
  const auto kept = cell_times(folder_ / "out");
  const auto result = run_penumbra(folder_.path(), arguments);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(finished_cells(folder_ / "out"), 8u) << "two references, three budgets, two seeds";
  const auto now = cell_times(folder_ / "out");
  for (const auto& [name, time] : kept) {
    if (name.ends_with(".json")) {
      EXPECT_EQ(now.at(name), time) << name << " was rendered again";
    }
  }
  EXPECT_EQ(report_of(folder_)["scenes"][0]["curves"][0]["points"].size(), 3u);
}

TEST_F(ReportCommand, ChangedSceneIsRenderedAgain) {
  const std::vector<std::string> arguments = {"s.xml", "-o",         "out", "--budgets",       "1", "--seeds",
                                              "1",     "--no-plots", "-q",  "--reference-spp", "16"};
  ASSERT_EQ(run(arguments).exit_code, 0);
  EXPECT_EQ(finished_cells(folder_ / "out"), 3u);
  ASSERT_EQ(run(arguments).exit_code, 0);
  EXPECT_EQ(finished_cells(folder_ / "out"), 3u);
  std::string scene = file_contents(folder_ / "s.xml");
  scene.replace(scene.find("4, 3, 2"), 7, "4, 3, 1");
  write_text(folder_ / "s.xml", scene);
  ASSERT_EQ(run(arguments).exit_code, 0);
  EXPECT_EQ(finished_cells(folder_ / "out"), 6u);
}

TEST_F(ReportCommand, ChangedImageIsRenderedAgain) {
  const std::vector<std::string> arguments = {"s.xml", "-o",         "out", "--budgets",       "1", "--seeds",
                                              "1",     "--no-plots", "-q",  "--reference-spp", "16"};
  ASSERT_EQ(run(arguments).exit_code, 0);
  const auto before = report_of(folder_)["scenes"][0]["curves"][0]["points"][0]["errors"];
  std::filesystem::path image;
  std::string intact;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out/cells"))
    if (entry.path().extension() == ".exr") image = entry.path();
  intact = file_contents(image);
  write_text(image, intact.substr(0, intact.size() / 2));
  const auto result = run(arguments);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr(image.filename().string()), HasSubstr("rendered again")));
  EXPECT_TRUE(file_contents(image) == intact);
  EXPECT_EQ(report_of(folder_)["scenes"][0]["curves"][0]["points"][0]["errors"], before);
}

TEST_F(ReportCommand, OverwritesNothingButItsOwnFiles) {
  const std::vector<std::string> arguments = {"s.xml", "-o",         "out", "--budgets",       "1", "--seeds",
                                              "1",     "--no-plots", "-q",  "--reference-spp", "16"};
  std::filesystem::create_directory(folder_ / "out");
  for (const char* name : {"index.html", "report.json", "report.csv", "table.csv", "table.tex"}) {
    write_text(folder_ / "out" / name, "<!DOCTYPE html><title>Error against run time</title>");
    const auto result = run(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr(std::string("out/") + name));
    EXPECT_EQ(file_contents(folder_ / "out" / name), "<!DOCTYPE html><title>Error against run time</title>");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/cells"));
    std::filesystem::remove(folder_ / "out" / name);
  }
  ASSERT_EQ(run(arguments).exit_code, 0);
  EXPECT_EQ(run(arguments).exit_code, 0) << "its own";
}

TEST_F(ReportCommand, TakesReferencesAndPeersFromFiles) {
  for (const auto& [file, spp, seed] : std::vector<std::tuple<std::string, std::string, std::string>>{
           {"a.exr", "512", "1"}, {"b.exr", "512", "2"}, {"peers/other/0.5-seconds.exr", "8", "3"}}) {
    std::filesystem::create_directories((folder_ / file).parent_path());
    ASSERT_EQ(run_penumbra(folder_.path(),
                           {"render", "s.xml", "-o", file, "--spp", spp, "--seed", seed, "--no-report"})
                  .exit_code,
              0);
  }
  std::filesystem::remove(folder_ / "peers/other/0.5-seconds.png");
  const auto result =
      run({"s.xml", "-o", "out", "--budgets", "4,8", "--reference", "a.exr", "--second-reference", "b.exr",
           "--peer", "peers", "--no-plots", "--crop-view", "2,3,8"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto report = report_of(folder_);
  const auto& scene = report["scenes"][0];
  EXPECT_EQ(scene["reference"]["images"][1]["file"], "b.exr");
  ASSERT_EQ(scene["curves"].size(), 2u);
  const auto& peer = scene["curves"][1];
  EXPECT_EQ(peer["label"], "other");
  EXPECT_EQ(peer["points"][0]["seconds"], 0.5);
  // The same program at the same budget: the same error but for the seeds.
  const double ours = scene["curves"][0]["points"][1]["errors"]["mse"],
               theirs = peer["points"][0]["errors"]["mse"];
  EXPECT_NEAR(theirs / ours, 1, 0.5);
  EXPECT_EQ(scene["equal_time"]["x"], 2);
  EXPECT_EQ(scene["equal_time"]["width"], 8);
}

TEST_F(ReportCommand, BiasedMethodShowsItsBias) {
  // A closed form without shadows against direct light with them: its error is bias alone. What is set for
  // all counts for those that have such a parameter.
  const auto result = run({source_path("scenes/star-light/star-light.xml"),
                           "-o",
                           "out",
                           "--set",
                           "film.width=24",
                           "--set",
                           "film.height=16",
                           "--set",
                           "integrator.emitter_sampling=area",
                           "--integrator",
                           "polygon_analytic",
                           "--integrator",
                           "direct",
                           "--reference-integrator",
                           "direct",
                           "--budgets",
                           "16,32",
                           "--seeds",
                           "4",
                           "--no-plots"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto report = report_of(folder_);
  const auto& curves = report["scenes"][0]["curves"];
  const auto& analytic = curves[0]["points"][1]["relmse_split"];
  EXPECT_GT(analytic["bias_squared"].get<double>(),
            4 * analytic["bias_squared_standard_error"].get<double>());
  EXPECT_GT(analytic["bias_squared"].get<double>(), analytic["variance"].get<double>());
  const auto& direct = curves[1]["points"][1]["relmse_split"];
  EXPECT_LT(std::abs(direct["bias_squared"].get<double>()),
            5 * direct["bias_squared_standard_error"].get<double>());
  EXPECT_FALSE(curves[0]["estimates_what_the_reference_does"].get<bool>());
  EXPECT_THAT(report["scenes"][0]["remarks"][0].get<std::string>(), HasSubstr("without shadows"));
}

TEST_F(ReportCommand, BadInputIsExitCode2AndSaysWhat) {
  write_text(folder_ / "file", "");
  std::filesystem::create_directories(folder_ / "empty");
  ASSERT_EQ(run_penumbra(folder_.path(),
                         {"render", "s.xml", "-o", "small.exr", "--set", "film.width=7", "--spp", "1"})
                .exit_code,
            0);
  const std::pair<std::vector<std::string>, std::string> cases[] = {
      {{}, "SCENE is required"},
      {{"s.xml"}, "--out is required"},
      {{"missing.xml", "-o", "out"}, "missing.xml"},
      {{"s.xml", "-o", "file"}, "file"},
      {{"s.xml", "-o", "out", "--integrator", "pathh"}, "did you mean 'path'"},
      {{"s.xml", "-o", "out", "--integrator", "path:ne=cv"}, "integrator.ne"},
      {{"s.xml", "-o", "out", "--integrator", "path", "--set", "integrator.vis_samples=2"},
       "--set integrator.vis_samples=2: no method of this report has such a parameter"},
      {{"s.xml", "-o", "out", "--integrator", "path:vis_samples=2"}, "these have: polygon_cv"},
      {{"s.xml", "-o", "out", "--integrator", "path", "--integrator", "path"},
       "two methods are called 'path'"},
      {{"s.xml", "-o", "out", "--spp", "8..4"}, "before it begins"},
      {{"s.xml", "-o", "out", "--budgets", "1,x"}, "'x'"},
      {{"s.xml", "-o", "out", "--spp", "1..4", "--budgets", "1"}, "excludes"},
      {{"s.xml", "-o", "out", "--reference", "missing.exr"}, "missing.exr"},
      {{"s.xml", "-o", "out", "--reference", "small.exr"}, "has 7 x 20 pixels"},
      {{"s.xml", "-o", "out", "--second-reference", "small.exr"}, "--reference FILE"},
      {{"s.xml", "-o", "out", "--peer", "empty"}, "holds no folders"},
      {{"s.xml", "s.xml", "-o", "out", "--peer", "empty"}, "SCENE=DIR"},
      {{"s.xml", "-o", "out", "--target", "flip=1"}, "flip"},
      {{"s.xml", "-o", "out", "--crop-view", "left"}, "left"},
      {{"s.xml", "-o", "out", "--backend", "cuda"}, "cuda"},
      {{"s.xml", "-o", "out", "--seeds", "0"}, "--seeds"},
      {{"s.xml", "-o", "out", "--backend", "opencl", "--intersector", "embree"}, "portable"},
  };
  for (const auto& [arguments, message] : cases) {
    const auto result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << message << "\n" << result.err;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
  EXPECT_EQ(finished_cells(folder_ / "out"), 0u) << "nothing is rendered before all of it is checked";
}

TEST_F(ReportCommand, RemovedImagesAreMissed) {
  Program report(folder_.path(), {"report", "s.xml", "-o", "out", "--spp", "1..64", "--seeds", "2",
                                  "--reference-spp", "64", "--no-plots"});
  for (int i = 0; i < 3000 && finished_cells(folder_ / "out") == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out" / "cells"))
    if (entry.path().filename().string().front() != '.') std::filesystem::remove(entry.path());
  const auto result = report.wait();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("removed or damaged"));
}

TEST_F(ReportCommand, ABackendThatFailsDoesNotKeepTheOthers) {
  const auto result =
      run({"s.xml", "-o", "out", "--budgets", "1,2", "--seeds", "1", "--reference-spp", "16", "--no-plots",
           "--backend", "native", "--backend", "opencl", "--opencl-device", "no such device"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("no such device"));
  const auto report = report_of(folder_);
  EXPECT_EQ(report["scenes"][0]["curves"][0]["points"].size(), 2u);
  EXPECT_EQ(report["scenes"][0]["curves"][1]["points"].size(), 0u);
  EXPECT_THAT(report["scenes"][0]["remarks"][0].get<std::string>(), HasSubstr("missing"));
}

}  // namespace
}  // namespace penumbra
