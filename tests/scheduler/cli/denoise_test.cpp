// Tests `penumbra denoise` and `penumbra render --denoise`.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <random>
#include <thread>

#include "scheduler/image/image.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "worker/device.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class DenoiseCommand : public ::testing::Test {
 protected:
  void SetUp() override { write_small_scene(folder_ / "s.xml"); }

  ProgramResult penumbra(const std::vector<std::string>& arguments) {
    return run_penumbra(folder_.path(), arguments);
  }
  void succeed(const std::vector<std::string>& arguments) {
    const ProgramResult result = penumbra(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
  }
  Image image(const std::string& name) {
    auto read = read_image(folder_ / name);
    EXPECT_TRUE(read) << read.error().message;
    return read.value_or(Image{});
  }
  [[nodiscard]] bool exists(const std::string& name) const { return fs::exists(folder_ / name); }
  [[nodiscard]] std::string contents(const std::string& name) const { return file_contents(folder_ / name); }

  TemporaryFolder folder_;
};

TEST_F(DenoiseCommand, ARenderWritesTheDenoisedImageBesideTheImage) {
  succeed({"render", "s.xml", "--spp", "8", "--denoise", "-o", "a.exr"});
  succeed({"render", "s.xml", "--spp", "8", "-o", "plain.exr"});
  for (const char* channel : {"R", "G", "B"})
    EXPECT_EQ(image("a.exr").at(2, 1, *image("a.exr").channel(channel)),
              image("plain.exr").at(2, 1, *image("plain.exr").channel(channel)));
  EXPECT_THAT(image("a.exr").channels, AllOf(Contains("half_a.R"), Contains("depth_variance.Z")));
  EXPECT_THAT(image("plain.exr").channels, Not(Contains("half_a.R")));
  EXPECT_THAT(image("a-denoised.exr").channels, AllOf(Contains("error.G"), Contains("albedo.R")));
  EXPECT_TRUE(exists("a-denoised.png"));
  // The command gives the same bytes.
  succeed({"denoise", "a.exr", "-o", "again.exr"});
  EXPECT_EQ(image("again.exr").values, image("a-denoised.exr").values);
}

TEST_F(DenoiseCommand, DevicesGiveTheSameFile) {
  succeed({"render", "s.xml", "--spp", "8", "--denoise=layers", "-o", "a.exr"});
  for (const char* method : {"nlmeans", "nfor"}) {
    succeed({"denoise", "a.exr", "-o", "b.exr", "--method", method});
    succeed({"denoise", "a.exr", "-o", "narrow.exr", "--method", method, "--threads", "1", "--isa",
             std::string(isa_name(usable_isas().front()))});
    EXPECT_TRUE(contents("narrow.exr") == contents("b.exr")) << method;
    succeed({"denoise", "a.exr", "-o", "opencl.exr", "--method", method, "--backend", "opencl"});
    EXPECT_TRUE(contents("opencl.exr") == contents("b.exr")) << method;
  }
}

TEST_F(DenoiseCommand, LayersAloneAreForLater) {
  succeed({"render", "s.xml", "--spp", "8", "--denoise=layers", "-o", "a.exr"});
  EXPECT_FALSE(exists("a-denoised.exr"));
  const ProgramResult result = penumbra({"denoise", "a.exr"});
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("wrote a-denoised.exr, a-denoised.png: nfor"), Not(HasSubstr("lacks"))));
}

/// Denoising of five frames whose noise differs.
class DenoiseShot : public DenoiseCommand {
 protected:
  void SetUp() override {
    DenoiseCommand::SetUp();
    succeed({"render", "s.xml", "--frames", "1-5", "--spp", "8", "--denoise=layers", "--layers", "motion",
             "--seed-per-frame", "frame", "-o", "a.####.exr", "-q"});
  }
  std::string attribute(const std::string& name, const char* key) { return metadata_text(image(name), key); }
};

TEST_F(DenoiseShot, FramesTakeLightFromThoseBeside) {
  succeed({"denoise", "a.####.exr"});
  EXPECT_TRUE(exists("a.0005-denoised.png"));
  EXPECT_THAT(image("a.0003-denoised.exr").channels,
              AllOf(Contains("error.B"), Contains("noisy_variance.R")));
  const auto hash = [&](int frame) {
    return attribute(fmt::format("a.000{}.exr", frame), "penumbra:film_hash");
  };
  EXPECT_EQ(attribute("a.0003-denoised.exr", "penumbra:frames_before"), hash(2) + " " + hash(1));
  EXPECT_EQ(attribute("a.0003-denoised.exr", "penumbra:frames_after"), hash(4) + " " + hash(5));
  EXPECT_EQ(attribute("a.0001-denoised.exr", "penumbra:frames_before"), "");
  // One frame alone, and without those beside it.
  succeed({"denoise", "a.####.exr", "--frames", "3", "-o", "b.####.exr"});
  EXPECT_TRUE(contents("b.0003.exr") == contents("a.0003-denoised.exr"));
  EXPECT_FALSE(exists("b.0002.exr"));
  succeed({"denoise", "a.####.exr", "--time-radius", "0", "-o", "c.####.exr"});
  succeed({"denoise", "a.0003.exr", "-o", "d.exr"});
  EXPECT_TRUE(contents("c.0003.exr") == contents("d.exr"));
  // Other layers are the frame's own.
  const Image noisy = image("a.0003.exr"), blended = image("a.0003-denoised.exr");
  for (const char* layer : {"half_a.G", "albedo.R", "normal.Y", "samples.Y"})
    EXPECT_EQ(blended.at(3, 2, *blended.channel(layer)), noisy.at(3, 2, *noisy.channel(layer))) << layer;
}

TEST_F(DenoiseShot, GoesOnWhereItWasStopped) {
  succeed({"denoise", "a.####.exr"});
  std::vector<std::string> whole;
  for (int frame = 1; frame <= 5; ++frame)
    whole.push_back(contents(fmt::format("a.000{}-denoised.exr", frame)));
  // As after a kill, since files appear whole; 4 is of another denoiser.
  fs::remove(folder_ / "a.0002-denoised.exr");
  fs::remove(folder_ / "a.0005-denoised.exr");
  succeed({"denoise", "a.####.exr", "--frames", "4", "--method", "nlmeans"});
  const ProgramResult result = penumbra({"denoise", "a.####.exr"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("kept 2 frames"));
  for (int frame = 1; frame <= 5; ++frame)
    EXPECT_TRUE(contents(fmt::format("a.000{}-denoised.exr", frame)) == whole[std::size_t(frame - 1)])
        << frame;
  // A frame that is rendered anew changes those beside it.
  succeed({"render", "s.xml", "--frames", "1", "--spp", "4", "--denoise=layers", "--layers", "motion", "-o",
           "a.####.exr", "-q"});
  EXPECT_THAT(penumbra({"denoise", "a.####.exr"}).out, HasSubstr("kept 2 frames"));
}

TEST_F(DenoiseShot, IsWhatARenderOfFramesDoes) {
  const std::vector<std::string> render = {"render",           "s.xml", "--spp", "8",          "--denoise",
                                           "--seed-per-frame", "frame", "-o",    "r.####.exr", "-q",
                                           "--frames"};
  const auto frames = [&](const char* list, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = render;
    arguments.emplace_back(list);
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  succeed(frames("1-5"));
  succeed({"denoise", "a.####.exr"});
  for (int frame = 1; frame <= 5; ++frame)
    EXPECT_EQ(image(fmt::format("r.000{}-denoised.exr", frame)).values,
              image(fmt::format("a.000{}-denoised.exr", frame)).values);
  // Nothing changes in a set that is there; what a kill has left unblended is blended.
  const std::string whole = contents("r.0003-denoised.exr");
  succeed(frames("1-5"));
  EXPECT_TRUE(contents("r.0003-denoised.exr") == whole);
  succeed({"denoise", "r.0003.exr", "-o", "r.0003-denoised.exr"});
  EXPECT_FALSE(contents("r.0003-denoised.exr") == whole);
  succeed(frames("1-5", {"--order", "preview"}));
  EXPECT_EQ(image("r.0003-denoised.exr").values, image("a.0003-denoised.exr").values);
  // Each frame by itself.
  succeed(frames("1-2", {"--time-radius", "0", "--force"}));
  EXPECT_THAT(image("r.0001.exr").channels, Not(Contains("motion.X")));
  EXPECT_EQ(attribute("r.0001-denoised.exr", "penumbra:frames_after"), "");
}

// What denoised files are missing is made of the images, which are not rendered again.
TEST_F(DenoiseShot, ImagesOutliveTheirDenoising) {
  const std::vector<std::string> render{"render", "s.xml",     "--frames", "1-4",       "--spp",
                                        "8",      "--denoise", "-o",       "r.####.exr"};
  succeed(render);
  const auto bytes = [&] {
    std::vector<std::string> all;
    for (int frame = 1; frame <= 4; ++frame)
      for (const char* ending : {".exr", "-denoised.exr", "-denoised.png"})
        all.push_back(contents(fmt::format("r.000{}{}", frame, ending)));
    return all;
  };
  const std::vector<std::string> whole = bytes();
  fs::remove(folder_ / "r.0002-denoised.exr");
  fs::remove(folder_ / "r.0003-denoised.png");
  fs::remove(folder_ / "r.0004-denoised.exr");
  fs::remove(folder_ / "r.0004-denoised.png");
  const ProgramResult result = penumbra(render);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("4 unchanged"));
  EXPECT_TRUE(bytes() == whole);
}

// Kills the program at random moments, and starts it again until it is done.
TEST_F(DenoiseShot, SurvivesAnyKill) {
  const auto render = [](const char* out) {
    return std::vector<std::string>{"render",  "s.xml", "--frames",  "1-8", "--spp", "8",
                                    "--scale", "400%",  "--denoise", "-q",  "-o",    out};
  };
  const auto begin = std::chrono::steady_clock::now();
  succeed(render("w.####.exr"));
  const auto longest =
      std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - begin);
  std::mt19937 random(64);
  for (int kill = 0; kill < 8; ++kill) {
    Program program(folder_.path(), render("k.####.exr"));
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % std::uint64_t(longest.count())));
    program.send(SIGKILL);
    program.wait();
  }
  succeed(render("k.####.exr"));
  for (int frame = 1; frame <= 8; ++frame)
    for (const char* ending : {"-denoised.exr", "-denoised.png"})
      EXPECT_TRUE(contents(fmt::format("k.000{}{}", frame, ending)) ==
                  contents(fmt::format("w.000{}{}", frame, ending)))
          << frame << ending;
}

TEST_F(DenoiseShot, WhatIsMissingIsLeftOutAndSaid) {
  fs::remove(folder_ / "a.0004.exr");
  write_text(folder_ / "a.0002.exr", "no image");
  succeed({"render", "s.xml", "--frames", "6-7", "--spp", "4", "--denoise=layers", "-o", "a.####.exr", "-q"});
  succeed({"render", "s.xml", "--frames", "8", "--spp", "4", "--denoise=layers", "--layers", "motion",
           "--scale", "50%", "-o", "a.####.exr", "-q"});
  succeed({"render", "s.xml", "--frames", "9", "--spp", "4", "--denoise=layers", "--layers", "motion", "-o",
           "a.####.exr", "-q"});
  const ProgramResult result = penumbra({"denoise", "a.####.exr"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("a.0002.exr"));
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("a.0001.exr: without frame 2: a.0002.exr"),
                    HasSubstr("a.0005.exr: without frame 6: it lacks motion.X/Y/Z/W"),
                    HasSubstr("a.0009.exr: without frame 8: it has "),
                    HasSubstr("a.0006.exr: it is denoised by itself, since it lacks motion.X/Y/Z/W")));
  EXPECT_EQ(attribute("a.0003-denoised.exr", "penumbra:frames_before"), "");
  EXPECT_EQ(attribute("a.0003-denoised.exr", "penumbra:frames_after"), "");
  EXPECT_FALSE(exists("a.0004-denoised.exr"));
  const auto error = [&](const std::vector<std::string>& arguments) {
    const ProgramResult failed = penumbra(arguments);
    EXPECT_EQ(failed.exit_code, 2);
    return failed.err;
  };
  EXPECT_THAT(error({"denoise", "b.####.exr"}), HasSubstr("b.####.exr: there is no such file"));
  EXPECT_THAT(error({"denoise", "a.####.exr", "-o", "b.exr"}),
              HasSubstr("no field for the frame, such as b.####.exr"));
  EXPECT_THAT(error({"denoise", "a.####.exr", "-o", "a.####.exr"}), HasSubstr("a.0001.exr"));
  EXPECT_THAT(error({"denoise", "a.0001.exr", "--frames", "1"}), HasSubstr("no field for the frame"));
  EXPECT_THAT(error({"denoise", "a.####.exr", "--frames", "1-"}), HasSubstr("--frames"));
}

TEST_F(DenoiseCommand, AJobFileChoosesTheMethod) {
  write_text(
      folder_ / "j.toml",
      "[defaults]\nscene = \"s.xml\"\nspp = 4\n[[render]]\nout = \"a.exr\"\ndenoise = true\n"
      "[[render]]\nout = \"b.exr\"\ndenoise = \"nlmeans\"\n[[render]]\nout = \"c.exr\"\ndenoise = false\n");
  succeed({"render", "j.toml", "-q"});
  const auto method = [&](const char* name) {
    return std::get<std::string>(image(name).attribute("penumbra:denoised_by").value_or("none"));
  };
  EXPECT_EQ(method("a-denoised.exr"), "nfor");
  EXPECT_EQ(method("b-denoised.exr"), "nlmeans");
  EXPECT_FALSE(exists("c-denoised.exr"));
  write_text(folder_ / "bad.toml", "[[render]]\nscene = \"s.xml\"\ndenoise = \"best\"\n");
  const ProgramResult bad = penumbra({"render", "bad.toml"});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.err, AllOf(HasSubstr("bad.toml:3"), HasSubstr("nlmeans")));
}

TEST_F(DenoiseCommand, TheRecordRepeatsIt) {
  succeed({"render", "s.xml", "--spp", "4", "--denoise=nlmeans", "-o", "a.exr"});
  EXPECT_THAT(std::get<std::string>(*image("a.exr").attribute("penumbra:command")),
              HasSubstr("--denoise=nlmeans"));
  succeed({"render", "s.xml", "--spp", "4", "-o", "b.exr"});
  EXPECT_THAT(std::get<std::string>(*image("b.exr").attribute("penumbra:command")),
              Not(HasSubstr("denoise")));
}

TEST_F(DenoiseCommand, WhatCannotWorkIsSaid) {
  succeed({"render", "s.xml", "--spp", "2", "-o", "a.exr"});
  const auto error = [&](const std::vector<std::string>& arguments) {
    const ProgramResult result = penumbra(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    return result.err;
  };
  EXPECT_THAT(error({"denoise", "none.exr"}), HasSubstr("none.exr: no such file"));
  EXPECT_THAT(error({"denoise", "a.exr", "-o", "a.exr"}), HasSubstr("a.exr"));
  EXPECT_THAT(error({"denoise", "a.png"}), HasSubstr("denoising takes radiance"));
  succeed({"denoise", "a.exr"});
  EXPECT_THAT(error({"denoise", "a-denoised.exr"}), HasSubstr("it is denoised already"));
  EXPECT_THAT(error({"denoise", "a.exr", "-o", "b.jpg"}), HasSubstr("must end in .exr or .png"));
  EXPECT_THAT(error({"denoise", "a.exr", "--method", "best"}), HasSubstr("best"));
  EXPECT_THAT(error({"denoise", "a.exr", "--patch-radius", "99"}), HasSubstr("--patch-radius"));
  setenv("PENUMBRA_OIDN", "/none/libOpenImageDenoise.so", 1);
  EXPECT_THAT(error({"denoise", "a.exr", "--method", "oidn"}), HasSubstr("Open Image Denoise is not there"));
  EXPECT_THAT(error({"render", "s.xml", "--denoise=oidn"}), HasSubstr("Open Image Denoise is not there"));
  unsetenv("PENUMBRA_OIDN");
}

TEST_F(DenoiseCommand, OpenImageDenoiseRemovesNoise) {
  if (penumbra({"render", "s.xml", "--spp", "1", "--denoise=oidn", "-q"}).exit_code != 0)
    GTEST_SKIP() << "there is no library of Open Image Denoise; PENUMBRA_OIDN names one";
  succeed({"render", "s.xml", "--spp", "8", "--denoise=oidn", "-o", "a.exr"});
  const Image denoised = image("a-denoised.exr"), noisy = image("a.exr");
  EXPECT_NE(denoised.values, noisy.values);
  for (int y = 0; y < denoised.data.height; ++y)
    for (int x = 0; x < denoised.data.width; ++x) EXPECT_TRUE(std::isfinite(denoised.at(x, y, 0)));
}

}  // namespace
}  // namespace penumbra
