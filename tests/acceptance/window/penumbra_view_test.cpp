// penumbra-view as users run it, on a virtual display: what it saves against what `penumbra render` writes,
// and its behaviour when processes die.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <regex>
#include <thread>

#include "scheduler/image/image.h"
#include "tests/gl/gl_test_context.h"
#include "tests/support/fake_processes.h"
#include "tests/support/image_test.h"
#include "tests/support/oracles.h"
#include "tests/support/program.h"
#include "tests/support/render_scene.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::SizeIs;

constexpr int kWidth = 48, kHeight = 40, kPixels = kWidth * kHeight, kSpp = 16;
// A block between a square light and a floor, diffuse and glossy.
constexpr const char* kScene = R"(<scene version="3.0.0">
  <default name="eye" value="0, 2.5, 5"/>
  <default name="at" value="0, 0.5, 0"/>
  <default name="type" value="polygon_cv"/>
  <integrator type="$type"/>
  <sensor type="perspective">
    <float name="fov" value="50"/>
    <transform name="to_world"><lookat origin="$eye" target="$at" up="0, 1, 0"/></transform>
    <sampler type="independent"><integer name="sample_count" value="16"/></sampler>
    <film type="hdrfilm">
      <integer name="width" value="48"/>
      <integer name="height" value="40"/>
      <rfilter type="box"/>
    </film>
  </sensor>
  <shape type="rectangle">
    <transform name="to_world"><rotate x="1" angle="-90"/><scale value="4"/></transform>
    <bsdf type="phong">
      <rgb name="diffuse_reflectance" value="0.4, 0.5, 0.6"/>
      <rgb name="specular_reflectance" value="0.2"/>
      <float name="exponent" value="20"/>
    </bsdf>
  </shape>
  <shape type="cube">
    <transform name="to_world"><scale value="0.5"/><translate x="0.3" y="0.5"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.3, 0.2"/></bsdf>
  </shape>
  <shape type="rectangle">
    <transform name="to_world"><rotate x="1" angle="90"/><translate x="-0.5" y="3"/></transform>
    <emitter type="area"><rgb name="radiance" value="6, 5, 4"/></emitter>
  </shape>
</scene>
)";

class PenumbraViewTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    if (!IsSkipped()) write_text(folder_.path() / "scene.xml", kScene);
  }

  /// `penumbra view` with a script, OpenGL's checks on.
  std::vector<std::string> view_arguments(std::vector<std::string> arguments, const std::string& script) {
    const std::string name = "script" + std::to_string(++scripts_) + ".txt";
    write_text(folder_.path() / name, script);
    arguments.insert(arguments.begin(), "view");
    arguments.insert(arguments.end(), {"--script", name, "--gl-debug", "--hidden"});
    return arguments;
  }
  ProgramResult view(const std::vector<std::string>& arguments, const std::string& script) {
    return run_penumbra(folder_.path(), view_arguments(arguments, script));
  }
  ProgramResult penumbra(const std::vector<std::string>& arguments) {
    return run_penumbra(folder_.path(), arguments);
  }
  Image image(const std::string& name) const { return read_image(folder_.path() / name).value(); }
  [[nodiscard]] const fs::path& path() const { return folder_.path(); }

  /// What the running program has written so far.
  std::string output(const std::string& name) const { return file_contents(folder_.path() / name); }
  bool says(const std::string& text) const {
    return eventually([&] { return output(".stdout").find(text) != std::string::npos; }, 60s);
  }

 private:
  TemporaryFolder folder_;
  int scripts_ = 0;
};

/// Channels `prefix`R, G, B.
statistics::Image channels(const Image& image, const std::string& prefix) {
  statistics::Image result(image.data.width, image.data.height, 3);
  const char* names[] = {"R", "G", "B"};
  for (int c = 0; c < 3; ++c) {
    const std::size_t channel = image.channel(prefix + names[c]).value();
    for (int y = 0; y < result.height; ++y)
      for (int x = 0; x < result.width; ++x) result.at(x, y, c) = image.at(x, y, channel);
  }
  return result;
}

/// How many values differ in any bit.
int differing_bits(const statistics::Image& a, const statistics::Image& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i)
    count += std::bit_cast<std::uint64_t>(a.values[i]) == std::bit_cast<std::uint64_t>(b.values[i]) ? 0 : 1;
  return count + std::abs(int(a.values.size()) - int(b.values.size()));
}

// What is drawn is in single precision: as a standard deviation, a tenth of what analytic_pass_test allows at
// most.
constexpr double kDrawnError = 1e-4;

/// Means of blocks of so many pixels a side with so many samples each, and standard errors from those of the
/// pixels. Where all samples are equal the edge of a light may still cross the block, so narrow that one
/// sample more would have met it.
statistics::Estimate blocks(const statistics::Image& mean, const statistics::Image& variance, int block,
                            int spp) {
  statistics::Estimate estimate{statistics::block_average(mean, block),
                                statistics::block_average(variance, block),
                                std::numeric_limits<double>::infinity()};
  const double brightest = std::ranges::max(mean.values);
  for (std::size_t i = 0; i < estimate.mean.values.size(); ++i) {
    double& error = estimate.standard_error.values[i];
    error = error > 0 ? std::sqrt(error) / block : brightest / (block * block * spp);
    error = std::hypot(error, kDrawnError * estimate.mean.values[i]);
  }
  return estimate;
}

/// Where a scheduler that a window has started listens for it.
fs::path listen_path(pid_t scheduler) {
  std::ifstream file("/proc/" + std::to_string(scheduler) + "/cmdline");
  std::string argument, last;
  while (std::getline(file, argument, '\0') && last != "--listen") last = argument;
  EXPECT_TRUE(argument.starts_with("unix:")) << argument;
  return argument.substr(std::string_view("unix:").size());
}

double largest_sample_count(const Image& image) {
  double most = 0;
  const std::size_t channel = image.channel("samples.Y").value();
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) most = std::max(most, double(image.at(x, y, channel)));
  return most;
}

TEST_F(PenumbraViewTest, PressesOfSpaceAreTheSamplesOfAnOfflineControlVariate) {
  for (const std::string alpha : {"1", "0.5"}) {
    SCOPED_TRACE(alpha);
    const ProgramResult seen =
        view({"scene.xml", "--workers", "2", "--tile", "16", "--set", "integrator.alpha=" + alpha},
             "wait connected\nkey space 5\nwait samples 5\nkey space 11\nwait samples 16\n"
             "wait analytic 64\nsave view.exr\nquit\n");
    ASSERT_EQ(seen.exit_code, 0) << seen.err;
    const std::vector<std::string> render = {
        "render", "scene.xml", "--spp", "16", "--pass", "1", "-q", "--set", "integrator.alpha=" + alpha};
    for (const auto& [seed, file] : {std::pair{"0", "same.exr"}, std::pair{"1", "other.exr"}}) {
      std::vector<std::string> arguments = render;
      arguments.insert(arguments.end(), {"--seed", seed, "-o", file});
      ASSERT_EQ(penumbra(arguments).exit_code, 0);
    }
    const Image from_view = image("view.exr"), same = image("same.exr"), other = image("other.exr");
    if (alpha == "1")
      EXPECT_EQ(differing_bits(channels(from_view, "difference."), channels(same, "difference.")), 0);
    // The composite against another seed: independent samples, and the same error.
    constexpr int kBlock = 4;
    const statistics::Estimate a = blocks(channels(from_view, ""), channels(same, "variance."), kBlock, kSpp);
    const statistics::Estimate b = blocks(channels(other, ""), channels(other, "variance."), kBlock, kSpp);
    const statistics::ImageTestResult result = statistics::z_test(a, b);
    EXPECT_TRUE(result.passed) << result.summary();
  }
}

/// TinyRender's own scenes, at the size that they have: a polygon light, its 84 triangles, a concave star.
class TinyRenderViewTest : public PenumbraViewTest, public testing::WithParamInterface<const char*> {};

TEST_P(TinyRenderViewTest, TheSceneIsTheSameOnScreenAndOffline) {
  PENUMBRA_NEED_ORACLE("tinyrender-a4");
  const std::string file = (*find_oracle("tinyrender-a4") / GetParam()).string();
  const ProgramResult seen =
      view({file, "--workers", "2", "--spp", "16", "--sampler", "independent"},
           "wait connected\nkey space 16\nwait samples 16\nwait analytic 64\nsave view.exr\nquit\n");
  ASSERT_EQ(seen.exit_code, 0) << seen.err;
  // On screen the edges of lights are those of some frames.
  for (const auto& [seed, name] : {std::pair{"0", "same.exr"}, std::pair{"1", "other.exr"}})
    ASSERT_EQ(penumbra({"render", file, "--integrator", "polygon_cv", "--set", "integrator.alpha=1", "--set",
                        "film.light_edges=sampled", "--spp", "16", "--pass", "1", "--sampler", "independent",
                        "-q", "--seed", seed, "-o", name})
                  .exit_code,
              0);
  const Image from_view = image("view.exr"), same = image("same.exr"), other = image("other.exr");
  EXPECT_EQ(differing_bits(channels(from_view, "difference."), channels(same, "difference.")), 0);
  constexpr int kBlock = 8;  // 1024 samples: their spread tells the standard error
  const statistics::ImageTestResult result =
      statistics::z_test(blocks(channels(from_view, ""), channels(same, "variance."), kBlock, kSpp),
                         blocks(channels(other, ""), channels(other, "variance."), kBlock, kSpp));
  EXPECT_TRUE(result.passed) << result.summary();
}

INSTANTIATE_TEST_SUITE_P(Scenes, TinyRenderViewTest,
                         testing::Values("grid/tinyrender/grid_cv.toml",
                                         "polygon/tinyrender/polygon_analytic_realtime.toml",
                                         "star/tinyrender/star_analytic_realtime.toml"));

TEST_F(PenumbraViewTest, OverTcpATokenIsNeeded) {
  Program preview(path(), {"preview", "scene.xml", "--listen", "127.0.0.1:0"});
  std::smatch found;
  std::string text;
  const std::regex printed("PENUMBRA_TOKEN=(\\S+) penumbra-view --connect (\\S+)");
  ASSERT_TRUE(eventually([&] { return std::regex_search(text = output(".stderr"), found, printed); }, 60s))
      << text;
  const std::string token = found[1], address = found[2];
  TemporaryFolder elsewhere;
  write_text(elsewhere.path() / "script.txt", "wait connected timeout 20\nkey space\nwait samples 1\nquit\n");
  const std::vector<std::string> arguments = {"view",     "--connect",  address,
                                              "--script", "script.txt", "--hidden"};
  const ProgramResult without = run_penumbra(elsewhere.path(), arguments);
  EXPECT_EQ(without.exit_code, 1);
  EXPECT_THAT(without.err, HasSubstr("token"));
  setenv("PENUMBRA_TOKEN", token.c_str(), 1);
  const ProgramResult let_in = run_penumbra(elsewhere.path(), arguments);
  unsetenv("PENUMBRA_TOKEN");
  EXPECT_EQ(let_in.exit_code, 0) << let_in.err;
}

TEST_F(PenumbraViewTest, AnotherCameraShowsItsClosedFormAtOnceAndNothingOfTheLast) {
  const std::string move = "camera eye 1 1.5 4 at 0 0.5 0.2\n";
  const ProgramResult moved =
      view({"scene.xml", "--workers", "2", "--tile", "8", "--spp", "64"},
           "wait connected\nwait analytic 3\nkey space 40\nwait samples 3\n" + move +
               "save moved.exr\nkey space 4\nwait samples 4\nsave samples.exr\nquit\n");
  ASSERT_EQ(moved.exit_code, 0) << moved.err;
  const ProgramResult fresh =
      view({"scene.xml", "--spp", "64", "-D", "eye=1, 1.5, 4", "-D", "at=0, 0.5, 0.2"},
           "wait connected\nsave fresh.exr\nkey space 4\nwait samples 4\n"
           "save fresh-samples.exr\nquit\n");
  ASSERT_EQ(fresh.exit_code, 0) << fresh.err;
  const Image at_once = image("moved.exr");
  EXPECT_EQ(largest_sample_count(at_once), 0);
  // One frame of the new view; the script's camera and the scene's are the same but for rounding.
  const statistics::Image ours = channels(at_once, ""), theirs = channels(image("fresh.exr"), "");
  int far = 0;
  for (std::size_t i = 0; i < ours.values.size(); ++i)
    far += std::abs(ours.values[i] - theirs.values[i]) > 1e-4 * (std::abs(theirs.values[i]) + 1e-3) ? 1 : 0;
  constexpr int kSilhouettePixels = kPixels / 100;
  EXPECT_LE(far, 3 * kSilhouettePixels);
  // And samples of it alone.
  const Image samples = image("samples.exr");
  EXPECT_EQ(largest_sample_count(samples), 4);
  const statistics::Image difference = channels(samples, "difference.");
  const statistics::Image expected = channels(image("fresh-samples.exr"), "difference.");
  double off = 0, scale = 0;
  for (std::size_t i = 0; i < difference.values.size(); ++i) {
    off += std::abs(difference.values[i] - expected.values[i]);
    scale += std::abs(expected.values[i]);
  }
  EXPECT_GT(scale, 0);
  EXPECT_LT(off, 0.02 * scale);  // the same random numbers; only rays at edges may differ
}

TEST_F(PenumbraViewTest, ABatchRenderIsWatchedByTwoToItsEnd) {
  Program render(
      path(), {"render", "scene.xml", "-D", "type=path", "--time-budget", "8", "--workers", "1", "--threads",
               "1", "--spp", "100000000", "--tile", "16", "-o", "batch.exr", "--no-report"});
  const auto address = [&] {
    std::smatch found;
    const std::string text = output(".stderr");
    return std::regex_search(text, found, std::regex("penumbra-view --connect (unix:\\S+)")) ? found[1].str()
                                                                                             : "";
  };
  ASSERT_TRUE(eventually([&] { return !address().empty(); }, 60s)) << output(".stderr");
  const std::string connect = address();
  TemporaryFolder elsewhere;  // each program keeps its output in its folder
  write_text(elsewhere.path() / "watch.txt",
             "wait samples 1\nsave first.exr\nwait finished\nsave last.exr\nquit\n");
  const std::vector<std::string> arguments = {"view",      "--connect", connect,     "--script",
                                              "watch.txt", "--hidden",  "--gl-debug"};
  TemporaryFolder third;
  write_text(third.path() / "watch.txt", "wait finished\nsave last.exr\nquit\n");
  Program second(third.path(), arguments);
  const ProgramResult watched = run_penumbra(elsewhere.path(), arguments);
  const ProgramResult watched_too = second.wait();
  EXPECT_EQ(render.wait().exit_code, 0);
  ASSERT_EQ(watched.exit_code, 0) << watched.err;
  ASSERT_EQ(watched_too.exit_code, 0) << watched_too.err;
  const statistics::Image written = channels(image("batch.exr"), "");
  for (const TemporaryFolder* folder : {&elsewhere, &third}) {
    const Image last = read_image(folder->path() / "last.exr").value();
    EXPECT_EQ(differing_bits(channels(last, ""), written), 0);
  }
  EXPECT_GT(differing_bits(channels(read_image(elsewhere.path() / "first.exr").value(), ""), written), 0);
}

TEST_F(PenumbraViewTest, AKilledWorkerIsToldAndReplaced) {
  Program viewer(
      path(), view_arguments({"scene.xml", "--workers", "2", "--tile", "16"},
                             "wait connected\nkey r\nwait samples 3\nlog ready\nwait samples 300\nquit\n"));
  ASSERT_TRUE(says("ready")) << output(".stderr");
  const std::vector<pid_t> schedulers = children_of(viewer.pid());
  ASSERT_THAT(schedulers, SizeIs(1));
  const std::vector<pid_t> workers = children_of(schedulers[0]);
  ASSERT_THAT(workers, SizeIs(2));
  kill(workers[0], SIGKILL);
  const ProgramResult result = viewer.wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, ContainsRegex("penumbra-view: .*" + std::to_string(workers[0]) + " was lost"));
}

TEST_F(PenumbraViewTest, AKilledSchedulerIsToldAndStartedAgain) {
  Program viewer(
      path(),
      view_arguments(
          {"scene.xml", "--workers", "2", "--tile", "16"},
          "wait connected\nkey r\nwait samples 3\nlog ready\nwait samples 300\nsave end.exr\nquit\n"));
  ASSERT_TRUE(says("ready")) << output(".stderr");
  const std::vector<pid_t> schedulers = children_of(viewer.pid());
  ASSERT_THAT(schedulers, SizeIs(1));
  // It has been open for long: whatever was made at its beginning is old.
  const fs::path socket = listen_path(schedulers[0]);
  fs::last_write_time(socket.parent_path(), fs::file_time_type::clock::now() - 1h);
  kill(schedulers[0], SIGKILL);
  const ProgramResult result = viewer.wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("the connection was lost"), HasSubstr("signal 9"),
                                HasSubstr("starting it again")));
  EXPECT_GE(largest_sample_count(image("end.exr")), 300);
}

TEST_F(PenumbraViewTest, ASceneThatChangesIsReloaded) {
  const ProgramResult result = view({"scene.xml", "--spp", "4"},
                                    "wait connected\nkey space\nwait samples 1\nkey f5\nwait connected\n"
                                    "key space 2\nwait samples 2\nsave end.exr\nquit\n");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(largest_sample_count(image("end.exr")), 2);
}

TEST_F(PenumbraViewTest, ACameraThatWasMovedStaysWhereItIsThoughTheSceneGrows) {
  // Something far away moves the point that the device scene is relative to; alpha is the file's still.
  std::string grown = kScene;
  const std::string integrator = R"(<integrator type="$type"/>)";
  grown.replace(grown.find(integrator), integrator.size(),
                R"(<integrator type="$type"><float name="alpha" value="0.5"/></integrator>
  <shape type="cube"><transform name="to_world"><translate x="90"/></transform></shape>)");
  Program viewer(
      path(), view_arguments({"scene.xml", "--workers", "2", "--spp", "100000"},
                             "wait connected\ncamera eye 1 1.5 4 at 0 0.5 0.2\nwait analytic 64\n"
                             "save before.exr\nkey r\nlog ready\nwait samples 300\nkey r\nwait analytic 64\n"
                             "save after.exr\nquit\n"));
  ASSERT_TRUE(says("ready")) << output(".stderr");
  write_text(path() / "scene.xml", grown);
  const std::vector<pid_t> schedulers = children_of(viewer.pid());
  ASSERT_THAT(schedulers, SizeIs(1));
  kill(schedulers[0], SIGKILL);  // the next one reads the scene again
  const ProgramResult result = viewer.wait();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Image after = image("after.exr");
  const statistics::Image old_form = channels(image("before.exr"), "analytic.");
  const statistics::Image new_form = channels(after, "analytic."), shown = channels(after, "");
  const statistics::Image difference = channels(after, "difference.");
  int moved = 0, halved = 0;
  for (std::size_t i = 0; i < old_form.values.size(); ++i) {
    const double form = new_form.values[i];
    moved += std::abs(old_form.values[i] - form) > 1e-2 * (form + 1e-2) ? 1 : 0;
    halved += form > 0 && std::abs(shown.values[i] - difference.values[i] - 0.5 * form) < 1e-4 * form ? 1 : 0;
  }
  // The same frames but for silhouettes: coordinates are of single precision, 45 units away.
  constexpr int kSilhouetteValues = 3 * kPixels / 20, kDarkValues = 3 * kPixels / 2;
  EXPECT_LE(moved, kSilhouetteValues);
  EXPECT_GT(halved, 3 * kPixels - kDarkValues);
}

TEST_F(PenumbraViewTest, ABatchRenderKeepsItsAlphaAndSaysWhatItDoesNotDo) {
  Program render(
      path(), {"render", "scene.xml", "--time-budget", "6", "--workers", "1", "--threads", "1", "--spp",
               "100000000", "--tile", "16", "--set", "integrator.alpha=1", "-o", "batch.exr", "--no-report"});
  std::smatch found;
  std::string text;
  const std::regex printed("penumbra-view --connect (unix:\\S+)");
  ASSERT_TRUE(eventually([&] { return std::regex_search(text = output(".stderr"), found, printed); }, 60s))
      << text;
  TemporaryFolder elsewhere;
  write_text(elsewhere.path() / "watch.txt",
             "wait samples 1\nkey space\nkey w\nwait finished\nwait analytic 64\nsave before.exr\n"
             "key [ 3\nset alpha 0\nsave after.exr\nquit\n");
  const ProgramResult watched =
      run_penumbra(elsewhere.path(), {"view", "--connect", found[1], "--script", "watch.txt", "--hidden"});
  EXPECT_EQ(render.wait().exit_code, 0);
  ASSERT_EQ(watched.exit_code, 0) << watched.err;
  EXPECT_THAT(watched.err, AllOf(HasSubstr("alpha of this render cannot be changed"),
                                 HasSubstr("the samples that it was asked for"),
                                 HasSubstr("the camera of this render cannot be moved")));
  const auto saved = [&](const char* name) {
    return channels(read_image(elsewhere.path() / name).value(), "");
  };
  EXPECT_EQ(differing_bits(saved("before.exr"), saved("after.exr")), 0);
}

TEST_F(PenumbraViewTest, ABatchRenderThatIsStoppedEndsAWaitForItsEnd) {
  Program render(
      path(), {"render", "scene.xml", "-D", "type=path", "--spp", "100000000", "-o", "a.exr", "--no-report"});
  std::smatch found;
  std::string text;
  const std::regex printed("penumbra-view --connect (unix:\\S+)");
  ASSERT_TRUE(eventually([&] { return std::regex_search(text = output(".stderr"), found, printed); }, 60s))
      << text;
  TemporaryFolder elsewhere;
  write_text(elsewhere.path() / "watch.txt", "wait samples 1\nlog ready\nwait finished\n");
  Program viewer(elsewhere.path(), {"view", "--connect", found[1], "--script", "watch.txt", "--hidden"});
  EXPECT_TRUE(eventually([&] { return !file_contents(elsewhere.path() / ".stdout").empty(); }, 60s));
  render.send(SIGINT);
  EXPECT_EQ(render.wait().exit_code, 1);
  const ProgramResult watched = viewer.wait();
  EXPECT_EQ(watched.exit_code, 1);
  EXPECT_THAT(watched.err, HasSubstr("watch.txt:3: error: the render is over, with "));
}

TEST_F(PenumbraViewTest, ASchedulerWhoseWorkersNeverStartIsGivenUp) {
  const fs::path bin = path() / "bin";
  fs::create_directory(bin);
  for (const char* program : {"penumbra", "penumbra-view"})
    fs::copy_file(fs::path(PENUMBRA_BINARY_DIR) / program, bin / program);
  write_text(bin / "penumbra-worker", "#!/bin/sh\nexit 1\n");
  fs::permissions(bin / "penumbra-worker", fs::perms::owner_all);
  write_text(path() / "steps.txt", "wait connected\nkey space\nwait samples 1 timeout 60\n");
  const std::string command =
      "cd '" + path().string() +
      "' && timeout 50 bin/penumbra view scene.xml --script steps.txt --hidden 2> err.txt";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_THAT(output("err.txt"),
              AllOf(HasSubstr("no worker could be started"), HasSubstr("starting it again"),
                    HasSubstr("error: the scheduler ended: exit code 1")));
}

TEST_F(PenumbraViewTest, AScreenshotWithoutAScriptIsOfAllSamplesAndNothingIsLeftBehind) {
  TemporaryFolder runtime;
  const char* const before = std::getenv("XDG_RUNTIME_DIR");
  const std::string old = before == nullptr ? "" : before;
  setenv("XDG_RUNTIME_DIR", runtime.path().c_str(), 1);
  const ProgramResult result =
      penumbra({"view", "scene.xml", "--spp", "3", "--screenshot", "end.png", "--hidden"});
  before == nullptr ? unsetenv("XDG_RUNTIME_DIR") : setenv("XDG_RUNTIME_DIR", old.c_str(), 1);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(image("end.png").data.width, 1280);
  EXPECT_TRUE(fs::is_empty(runtime.path()));
}

TEST_F(PenumbraViewTest, AnyIntegratorIsShownAsItConverges) {
  const ProgramResult result = view({"scene.xml", "-D", "type=path", "--spp", "6"},
                                    "wait finished\nsave view.exr\nscreenshot view.png\nkey 4\nkey o\n"
                                    "screenshot error.png\nquit\n");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  ASSERT_EQ(penumbra({"render", "scene.xml", "-D", "type=path", "--spp", "6", "--pass", "1", "-q", "-o",
                      "offline.exr"})
                .exit_code,
            0);
  EXPECT_EQ(differing_bits(channels(image("view.exr"), ""), channels(image("offline.exr"), "")), 0);
  EXPECT_EQ(image("view.png").data.width, 1280);
}

/// The mean squared difference of two pictures of the same size.
double squared_difference(const Image& a, const Image& b) {
  EXPECT_EQ(a.values.size(), b.values.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i)
    sum += std::pow(double(a.values[i]) - double(b.values[i]), 2);
  return sum / double(a.values.size());
}

TEST_F(PenumbraViewTest, APictureIsDenoisedAndTheSamplesStayAsTheyAre) {
  const ProgramResult result =
      view({"scene.xml", "-D", "type=path", "--spp", "8"},
           "wait finished\nsave noisy.exr\nsave noisy.png\nkey n\nwait denoised\nsave denoised.exr\n"
           "save denoised.png\nscreenshot window.png\nkey n\nsave again.png\nquit\n");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const ProgramResult reference =
      penumbra({"render", "scene.xml", "-D", "type=path", "--spp", "512", "-q", "-o", "reference.png"});
  ASSERT_EQ(reference.exit_code, 0) << reference.err;
  EXPECT_LT(squared_difference(image("denoised.png"), image("reference.png")),
            0.5 * squared_difference(image("noisy.png"), image("reference.png")));
  EXPECT_EQ(differing_bits(channels(image("denoised.exr"), ""), channels(image("noisy.exr"), "")), 0);
  EXPECT_EQ(image("again.png").values, image("noisy.png").values);
}

/// What is wrong with the scene is in the window, where the user pressed the key.
TEST_F(PenumbraViewTest, AFailedReloadIsExplainedInTheWindow) {
  Program viewer(path(),
                 view_arguments({"scene.xml", "--spp", "100000"},
                                "wait connected\nkey r\nlog ready\nwait samples 1000\nkey f5\n"
                                "wait message \"scene.xml:1:\"\nwait message \"did you mean 'rectangle'\"\n"
                                "wait message \"Reload (F5) tries again\"\nquit\n"));
  ASSERT_TRUE(says("ready")) << output(".stderr");
  write_text(path() / "scene.xml", "<scene version=\"3.0.0\"><shape type=\"rectangl\"/></scene>");
  EXPECT_EQ(viewer.wait().exit_code, 0) << output(".stderr");
}

std::string text_attribute(const Image& image, const std::string& name) {
  const auto value = image.attribute(name);
  const auto* text = value ? std::get_if<std::string>(&*value) : nullptr;
  return text == nullptr ? "" : *text;
}

TEST_F(PenumbraViewTest, AViewIsKeptWithTheCommandThatRendersIt) {
  const ProgramResult result = view({"scene.xml", "-D", "type=path"},
                                    "wait samples 4\nkey r\nwait finished\nkey p\n"
                                    "camera eye 1 1.5 4 at 0 0.5 0.2\nkey space 4\nwait samples 4\nkey p\n"
                                    "copy settings\ncopy tinyrender\nquit\n");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  // The scene's own camera: the same bits.
  const Image own = image("scene-view-001.exr");
  const ProgramResult again = run_shell(path(), text_attribute(own, "penumbra:command") + " -q -o own.exr");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(differing_bits(channels(own, ""), channels(image("own.exr"), "")), 0);
  // A moved camera goes through text. Rays that rounding moves past an edge are other samples, so a few
  // pixels differ.
  const Image moved = image("scene-view-002.exr");
  const std::string nearest = text_attribute(moved, "penumbra:nearest_command");
  EXPECT_THAT(nearest, HasSubstr("--set 'camera.lookat=1 1.5 4"));
  EXPECT_EQ(text_attribute(moved, "penumbra:camera.lookat").substr(0, 8), "1 1.5 4 ");
  const ProgramResult close = run_shell(path(), nearest + " -q -o moved.exr");
  ASSERT_EQ(close.exit_code, 0) << close.err;
  const statistics::Image a = channels(moved, ""), b = channels(image("moved.exr"), "");
  int far = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i)
    far += std::abs(a.values[i] - b.values[i]) > 1e-3 * (std::abs(b.values[i]) + 0.1) ? 1 : 0;
  EXPECT_LT(far, int(a.values.size() / 50));
  EXPECT_THAT(result.out, AllOf(HasSubstr("--set 'camera.lookat=1 1.5 4 "), HasSubstr("eye = [1, 1.5, 4]")));
  EXPECT_TRUE(fs::exists(path() / "scene-view-002.png"));
  EXPECT_FALSE(fs::exists(path() / "scene-view-003.exr"));
}

TEST_F(PenumbraViewTest, SamplesThatAreAskedForBeforeTheConnectionAreTaken) {
  const ProgramResult result = view({"scene.xml"}, "key space 3\nwait samples 3\nquit\n");
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST_F(PenumbraViewTest, FilesAreShownWithAllTheirLayers) {
  for (const char* seed : {"1", "2"}) {
    const ProgramResult rendered = penumbra({"render", "scene.xml", "-D", "type=path", "--spp", "4", "--seed",
                                             seed, "--cryptomatte", "-q", "-o", fmt::format("{}.exr", seed)});
    ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
  }
  const ProgramResult result = view(
      {"1.exr", "--reference", "2.exr", "--width", "640", "--height", "480"},
      "save image.exr\nlayer depth\nsave depth.png\nlayer normal\nsave normal.png\nlayer CryptoObject00\n"
      "save ids.png\nlayer image\ncompare reference\nsave reference.png\ncompare difference\n"
      "save difference.png\ncompare none\nsave picture.png\nzoom 4 20 20\npoint 100 100\nkey c\n"
      "screenshot window.png\nkey escape\nkey f5\nwait message \"read the file again\"\n");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(differing_bits(channels(image("image.exr"), ""), channels(image("1.exr"), "")), 0);
  EXPECT_EQ(image("picture.png").values, image("1.png").values);
  EXPECT_EQ(image("reference.png").values, image("2.png").values);
  for (const char* name : {"depth.png", "normal.png", "ids.png", "difference.png"})
    EXPECT_NE(image(name).values, image("picture.png").values) << name;
  const ProgramResult no_layer = view({"1.exr"}, "layer dephts\n");
  EXPECT_EQ(no_layer.exit_code, 1);
  EXPECT_THAT(no_layer.err, AllOf(HasSubstr("there is no layer 'dephts'"), HasSubstr("depth")));
  const ProgramResult with_options = view({"1.exr", "--spp", "4"}, "quit\n");
  EXPECT_EQ(with_options.exit_code, 2);
  EXPECT_THAT(with_options.err, HasSubstr("options of renders do not apply: --spp 4"));
  EXPECT_EQ(view({"1.exr", "--reference", "3.exr"}, "quit\n").exit_code, 2);
}

TEST_F(PenumbraViewTest, LayersOfARenderComeWhenTheyAreChosen) {
  const ProgramResult result =
      view({"scene.xml", "-D", "type=path"},
           "wait samples 4\nkey r\nwait finished\nlayer albedo\nwait layer\nsave albedo.png\n"
           "save a.exr\nlayer samples\nwait layer\nsave samples.png\nquit\n");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string command = text_attribute(image("a.exr"), "penumbra:command");
  const ProgramResult rendered = run_shell(path(), command + " -q -o a.exr");
  ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
  const ProgramResult shown = view({"a.exr"}, "layer albedo\nsave file.png\nquit\n");
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_EQ(image("albedo.png").values, image("file.png").values);
  const auto samples = image("samples.png").values;  // as many everywhere: one colour
  EXPECT_TRUE(std::ranges::all_of(
      samples, [&, i = 0](float value) mutable { return value == samples[std::size_t(i++ % 3)]; }));
}

TEST_F(PenumbraViewTest, WhatCannotWorkIsSaid) {
  write_text(path() / "bad.xml", "<scene version=\"3.0.0\"><shape type=\"rectangl\"/></scene>");
  const ProgramResult bad_scene = view({"bad.xml"}, "wait connected\n");
  EXPECT_EQ(bad_scene.exit_code, 2);
  EXPECT_THAT(bad_scene.err, AllOf(HasSubstr("bad.xml:1:"), HasSubstr("rectangl")));

  const ProgramResult bad_script = view({"scene.xml"}, "wait conected\n");
  EXPECT_EQ(bad_script.exit_code, 2);
  EXPECT_THAT(bad_script.err, AllOf(ContainsRegex("script.*txt:1:6: error"), HasSubstr("connected")));

  const ProgramResult endless =
      run_penumbra(path(), {"view", "scene.xml", "--script", "/dev/zero", "--hidden"});
  EXPECT_EQ(endless.exit_code, 2);
  EXPECT_THAT(endless.err, HasSubstr("--script: '/dev/zero' is not a plain file"));

  const ProgramResult no_scheduler =
      view({"--connect", "unix:" + (path() / "missing").string()}, "wait connected timeout 1\n");
  EXPECT_EQ(no_scheduler.exit_code, 1);
  EXPECT_THAT(no_scheduler.err,
              AllOf(HasSubstr("nobody listens there"), ContainsRegex("script.*txt:1: error: waited 1 s")));

  for (const std::string nowhere : {"nonsense", "unix:", "host:", "host:99999", ":7000", "host:70x"}) {
    const ProgramResult result = view({"--connect", nowhere}, "quit\n");
    EXPECT_EQ(result.exit_code, 2) << nowhere;
    EXPECT_THAT(result.err, HasSubstr("'" + nowhere + "' is not an address")) << nowhere;
  }
  EXPECT_EQ(view({"scene.xml", "--screenshot", "end.jpg"}, "quit\n").exit_code, 2);
  EXPECT_EQ(view({"scene.xml", "--listen", "127.0.0.1:0"}, "quit\n").exit_code, 2);

  EXPECT_EQ(view({}, "quit\n").exit_code, 2);
  EXPECT_EQ(view({"scene.xml", "--spp", "-3"}, "quit\n").exit_code, 2);
}

}  // namespace
}  // namespace penumbra
