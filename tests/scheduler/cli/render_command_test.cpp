// Tests `penumbra render` from the scene file to the files that it writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "kernels/host/sample_buffer.h"
#include "scheduler/image/image.h"
#include "scheduler/plan/render_memory.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/film_layers.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "worker/device.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class RenderCommand : public ::testing::Test {
 protected:
  void SetUp() override { write_small_scene(folder_ / "s.xml"); }

  ProgramResult render(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"render", "s.xml"});
    ProgramResult result = run_penumbra(folder_.path(), arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result;
  }
  Image image(const std::string& name) {
    auto read = read_image(folder_ / name);
    EXPECT_TRUE(read) << read.error().message;
    return read.value_or(Image{});
  }
  /// Does what the metadata of an image says, into another file.
  void repeat(const std::string& file, const std::string& again) {
    const std::string command =
        std::get<std::string>(image(file).attribute("penumbra:command").value_or("none"));
    // All of its words are plain, so that spaces separate them.
    std::vector<std::string> words;
    std::istringstream stream(command);
    for (std::string word; stream >> word;) words.push_back(word);
    ASSERT_GT(words.size(), 3u);
    EXPECT_EQ(words[0], "penumbra");
    std::vector<std::string> arguments(words.begin() + 1, words.end());
    arguments.insert(arguments.end(), {"-o", again});
    EXPECT_EQ(run_penumbra(folder_.path(), arguments).exit_code, 0);
  }
  nlohmann::json report(const std::string& name) {
    return nlohmann::json::parse(file_contents(folder_ / name));
  }

  TemporaryFolder folder_;
};

/// A bumpy sheet of 20 000 triangles.
std::string sheet_obj() {
  std::ostringstream obj;
  for (int i = 0; i <= 100; ++i)
    for (int j = 0; j <= 100; ++j)
      obj << "v " << 0.02 * i - 1 << ' ' << 0.5 + 0.01 * (i * j % 7) << ' ' << 0.02 * j - 1 << '\n';
  for (int i = 1; i <= 100; ++i)
    for (int j = 1; j <= 100; ++j) {
      const int at = (i - 1) * 101 + j;
      obj << "f " << at << ' ' << at + 1 << ' ' << at + 102 << ' ' << at + 101 << '\n';
    }
  return obj.str();
}

TEST_F(RenderCommand, TheHierarchyOfALargeSceneIsKept) {
  write_text(folder_ / "sheet.obj", sheet_obj());
  std::string scene = file_contents(folder_ / "s.xml");
  scene.insert(scene.find("</scene>"),
               "<shape type='obj'><string name='filename' value='sheet.obj'/></shape>");
  write_text(folder_ / "s.xml", scene);
  setenv("PENUMBRA_HIERARCHY_CACHE", (folder_ / "kept").c_str(), 1);
  const auto film = [&](std::vector<std::string> arguments) {
    render(std::move(arguments));
    return report("s.json")["film_hash"];
  };
  const auto built = film({});
  EXPECT_EQ(std::ranges::distance(std::filesystem::directory_iterator(folder_ / "kept")), 1);
  EXPECT_EQ(film({}), built);
  EXPECT_NE(film({"-D", "albedo=0.2"}), built);
  EXPECT_EQ(std::ranges::distance(std::filesystem::directory_iterator(folder_ / "kept")), 1)
      << "it does not depend on materials";
  std::filesystem::remove_all(folder_ / "kept");
  setenv("PENUMBRA_HIERARCHY_CACHE", "off", 1);
  EXPECT_EQ(film({}), built);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "kept"));
  unsetenv("PENUMBRA_HIERARCHY_CACHE");
}

TEST_F(RenderCommand, SobolReplacesTheIndependentSamplerOfAScene) {
  const auto note =
      HasSubstr("\nnote: sobol replaces the scene's independent sampler; --sampler scene keeps it\n");
  const auto sampler = [&] { return report("s.json")["settings"]["sampler"].get<std::string>(); };
  EXPECT_THAT(render({}).out, note);
  EXPECT_EQ(sampler(), "sobol");
  const auto hash = report("s.json")["film_hash"];
  EXPECT_THAT(render({"--sampler", "sobol", "--force"}).out, Not(note));
  EXPECT_EQ(report("s.json")["film_hash"], hash);
  EXPECT_THAT(render({"--quiet", "--force"}).out, Not(note));
  // Whoever needs independent samples asks for them.
  const std::vector<std::string> asking[] = {{"--sampler", "scene"},
                                             {"--sampler", "independent"},
                                             {"--set", "sampler.type=independent"},
                                             {"--target-error", "0.5"}};
  for (std::vector<std::string> options : asking) {
    options.emplace_back("--force");
    EXPECT_THAT(render(options).out, Not(note));
    EXPECT_EQ(sampler(), "independent");
    EXPECT_NE(report("s.json")["film_hash"], hash);
  }
}

TEST_F(RenderCommand, ARenderThatABudgetEndsSaysHowFarItCame) {
  const ProgramResult result = render({"--spp", "1000000", "--time-budget", "0.2"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, ContainsRegex("[0-9]+ of 1000000 samples per pixel: ended by the budget, in "));
  const nlohmann::json json = report("s.json");
  EXPECT_EQ(json["complete"], false);
  EXPECT_EQ(json["ended_by"], "time_budget");
  EXPECT_LT(json["samples"]["most_per_pixel"], 1000000);
  // Its command renders the same, to its end.
  repeat("s.exr", "again.exr");
  EXPECT_EQ(file_contents(folder_ / "again.exr"), file_contents(folder_ / "s.exr"));
  // A budget that is not used up is not mentioned.
  EXPECT_THAT(render({"--spp", "2", "--time-budget", "1000", "--force"}).out,
              AllOf(HasSubstr("2 samples per pixel"), Not(HasSubstr("budget"))));
  EXPECT_EQ(report("s.json")["complete"], true);
}

TEST_F(RenderCommand, SaysOnceHowToWatchIt) {
  EXPECT_THAT(render({}).err, AllOf(HasSubstr("to watch: "), Not(ContainsRegex("to watch(.|\n)*to watch"))));
}

TEST_F(RenderCommand, WritesImageAndReportBesideEachOther) {
  const ProgramResult result = render({});
  EXPECT_THAT(folder_.names(), ElementsAre("s.exr", "s.json", "s.png", "s.xml"));
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("wrote s.exr, s.png, s.json"), HasSubstr("24 x 20 pixels, 8 samples")));
  const Image exr = image("s.exr"), png = image("s.png");
  EXPECT_EQ(exr.data, (PixelWindow{0, 0, 24, 20}));
  EXPECT_EQ(exr.channels.size(), 14u);
  EXPECT_EQ(png.data.width, 24);
  EXPECT_EQ(exr.attribute("penumbra:spp"), MetadataValue(8));
  EXPECT_FALSE(exr.attribute("penumbra:incomplete"));
  // The floor is lit and seen in the lower middle; its albedo is the file's.
  EXPECT_GT(exr.at(12, 14, *exr.channel("G")), 0.01f);
  EXPECT_FLOAT_EQ(exr.at(12, 14, *exr.channel("albedo.G")), 0.5f);
  EXPECT_NEAR(exr.at(12, 14, *exr.channel("normal.Y")), 1.0f, 1e-6);
  EXPECT_GT(exr.at(12, 14, *exr.channel("depth.Z")), 2.0f);
  EXPECT_EQ(exr.at(12, 14, *exr.channel("samples.Y")), 8.0f);

  const nlohmann::json json = report("s.json");
  EXPECT_EQ(json["complete"], true);
  EXPECT_EQ(json["samples"]["total"], 24 * 20 * 8);
  EXPECT_EQ(json["samples"]["nan"]["count"], 0);
  EXPECT_EQ(MetadataValue(json["film_hash"].get<std::string>()), exr.attribute("penumbra:film_hash"));
  EXPECT_GT(json["samples_per_second"], 0);
  EXPECT_GT(json["memory"]["largest_worker_peak_bytes"], 0);
  EXPECT_THAT(json["problems"], IsEmpty());
}

TEST_F(RenderCommand, SamplesThatAreNoNumbersAreReportedOrAnError) {
  std::string scene = file_contents(folder_ / "s.xml");
  scene.replace(scene.find("</scene>"), 0, R"(  <emitter type="point">
    <point name="position" x="0" y="0.01" z="0"/>
    <rgb name="intensity" value="1e37"/>
  </emitter>
)");
  write_text(folder_ / "bad.xml", scene);
  const std::vector<std::string> arguments{"render", "bad.xml", "--spp", "4"};
  const ProgramResult warned = run_penumbra(folder_.path(), arguments);
  EXPECT_EQ(warned.exit_code, 0);
  EXPECT_THAT(warned.err, AllOf(HasSubstr("infinite samples count as black; the first is sample"),
                                HasSubstr("in the light sample of step"), HasSubstr("--pixel")));
  const nlohmann::json first = report("bad.json")["samples"]["infinite"]["first"];
  EXPECT_EQ(first["source"], "light sample");
  // The command that repeats it does.
  std::string repeat = first["repeat"];
  std::istringstream words(repeat.substr(repeat.find("render")));
  const std::vector<std::string> again{std::istream_iterator<std::string>(words), {}};
  EXPECT_THAT(run_penumbra(folder_.path(), again).err,
              HasSubstr("of pixel (" + first["x"].dump() + ", " + first["y"].dump() + ")"));

  std::vector<std::string> strictly = arguments;
  strictly.push_back("--strict-numerics");
  const ProgramResult strict = run_penumbra(folder_.path(), strictly);
  EXPECT_EQ(strict.exit_code, 1);
  EXPECT_THAT(strict.err, HasSubstr("error: "));
  render({"--strict-numerics"});
}

TEST_F(RenderCommand, ManySamplesThatAreNotFiniteAreAnError) {
  write_text(
      folder_ / "inf.xml",
      "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'><film type='hdrfilm'>"
      "<integer name='width' value='8'/><integer name='height' value='8'/></film><transform name='to_world'>"
      "<translate z='-4'/></transform></sensor><shape type='sphere'><bsdf type='diffuse'><rgb "
      "name='reflectance' value='1'/></bsdf><emitter type='area'><rgb name='radiance' "
      "value='3e38'/></emitter>"
      "</shape><emitter type='constant'><rgb name='radiance' value='3e38'/></emitter></scene>");
  const ProgramResult done =
      run_penumbra(folder_.path(), {"render", "inf.xml", "-o", "inf.exr", "-q", "--spp", "4"});
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_THAT(done.err, HasSubstr("error: "));
  EXPECT_THAT(done.err, HasSubstr("infinite samples count as black"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "inf.exr")) << "what there is of it is kept";
}

TEST_F(RenderCommand, AVarianceThatNoFloatHoldsIsReported) {
  std::string text = file_contents(folder_ / "s.xml");
  const std::string radiance = "4, 3, 2";
  text.replace(text.find(radiance), radiance.size(), "3e37, 3e37, 3e37");
  write_text(folder_ / "huge.xml", text);
  const auto huge = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"render", "huge.xml", "-o", "huge.exr", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_penumbra(folder_.path(), arguments);
  };
  const ProgramResult lenient = huge({});
  EXPECT_EQ(lenient.exit_code, 0);
  EXPECT_THAT(lenient.err, HasSubstr("warning: the variance of "));
  const Image written = image("huge.exr");
  double largest = 0;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x) {
      const double radiance_here = written.at(x, y, *written.channel("R"));
      ASSERT_TRUE(std::isfinite(radiance_here)) << x << ", " << y;
      largest = std::max(largest, radiance_here);
    }
  EXPECT_GT(largest, 1e36);
  const ProgramResult strict = huge({"--strict-numerics"});
  EXPECT_EQ(strict.exit_code, 1);
  EXPECT_THAT(strict.err, HasSubstr("error: the variance of "));
}

TEST_F(RenderCommand, TheMemoryOfAPixelIsWhatIsCountedForIt) {
  std::string text = file_contents(folder_ / "s.xml");
  for (const auto& [from, to] :
       {std::pair<std::string, std::string>{R"("width" value="24")", R"("width" value="1400")"},
        {R"("height" value="20")", R"("height" value="1000")"}})
    text.replace(text.find(from), from.size(), to);
  write_text(folder_ / "large.xml", text);
  const auto peak = [&](const std::string& scene, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"render", scene, "-o", "a.exr", "-q", "--spp", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(run_penumbra(folder_.path(), arguments).exit_code, 0);
    return report("a.json")["memory"]["scheduler_peak_bytes"].get<double>();
  };
  for (const bool layers : {true, false}) {
    const std::vector<std::string> more =
        layers ? std::vector<std::string>{} : std::vector<std::string>{"--no-features"};
    const double measured = peak("large.xml", more) - peak("s.xml", more);
    const double counted =
        1400.0 * 1000 * double(pixel_memory(layers ? kFeatureLayers : kNoLayers).peak(true));
    // Less where a file compresses well; more for results on their way.
    EXPECT_GT(measured, 0.5 * counted) << layers;
    EXPECT_LT(measured, 1.2 * counted) << layers;
  }
}

TEST_F(RenderCommand, FilesDoNotDependOnWorkersThreadsOrTiles) {
  render({"-o", "a.exr", "--pass", "4", "--workers", "1", "--threads", "2"});
  const std::string exr = file_contents(folder_ / "a.exr"), png = file_contents(folder_ / "a.png");
  for (const char* workers : {"1", "2", "5"}) {
    for (const char* tile : {"7", "16", "64"}) {
      render({"-o", "b.exr", "--pass", "4", "--workers", workers, "--threads", "1", "--tile", tile});
      EXPECT_EQ(file_contents(folder_ / "b.exr"), exr) << workers << " workers, tile " << tile;
      EXPECT_EQ(file_contents(folder_ / "b.png"), png) << workers << " workers, tile " << tile;
    }
  }
}

TEST_F(RenderCommand, VerifiesUnitsByASecondWorkerAndTheImageIsTheSame) {
  render({"-o", "a.exr", "--tile", "8", "--pass", "2"});
  render({"-o", "b.exr", "--tile", "8", "--pass", "2", "--workers", "2", "--verify", "0.5"});
  EXPECT_EQ(file_contents(folder_ / "a.exr"), file_contents(folder_ / "b.exr"));
  EXPECT_EQ(report("a.json")["units"]["verified"], 0);
  const int units = report("b.json")["units"]["done"], verified = report("b.json")["units"]["verified"];
  EXPECT_EQ(units, 36);
  EXPECT_GT(verified, 8);
  EXPECT_LT(verified, 28);
  const ProgramResult alone = run_penumbra(folder_.path(), {"render", "s.xml", "--verify", "0.5"});
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_THAT(alone.err, HasSubstr("--verify: it takes two workers"));
}

TEST_F(RenderCommand, TheRecordedCommandGivesTheSameBytes) {
  render({"-o", "a.exr", "-D", "albedo=0.25", "--set", "integrator.max_depth=3", "--seed", "7", "--spp", "5",
          "--crop", "3,2,20,18", "--sampler", "sobol"});
  repeat("a.exr", "b.exr");
  EXPECT_EQ(file_contents(folder_ / "a.exr"), file_contents(folder_ / "b.exr"));
}

TEST_F(RenderCommand, TheRecordedCommandRepeatsWhatATimeBudgetEnded) {
  // Points of a Sobol sequence depend on how many of them were to come, and halves of a fitted alpha even
  // more.
  const std::vector<std::string> integrators[] = {
      {}, {"--integrator", "polygon_cv", "--set", "integrator.alpha=auto"}};
  for (std::vector<std::string> arguments : integrators) {
    arguments.insert(arguments.end(), {"-o", "a.exr", "--spp", "2000000000", "--pass", "4", "--sampler",
                                       "sobol", "--time-budget", "0.2", "--tile", "7"});
    render(arguments);
    EXPECT_EQ(image("a.exr").attribute("penumbra:spp"), MetadataValue(2000000000));
    repeat("a.exr", "b.exr");
    EXPECT_TRUE(file_contents(folder_ / "a.exr") == file_contents(folder_ / "b.exr"));
    EXPECT_EQ(report("a.json")["film_hash"], report("b.json")["film_hash"]);
  }
}

TEST_F(RenderCommand, StopsAfterSomeOfItsSamples) {
  render({"-o", "a.exr", "--sampler", "sobol", "--spp", "64", "--stop-after", "10", "--pass", "4"});
  const Image exr = image("a.exr");
  EXPECT_EQ(exr.at(0, 0, *exr.channel("samples.Y")), 10.0f);
  EXPECT_EQ(report("a.json")["complete"], true);
  EXPECT_EQ(report("a.json")["ended_by"], "stop_after");
  render({"-o", "b.exr", "--sampler", "sobol", "--spp", "10", "--pass", "4"});
  EXPECT_EQ(report("b.json")["ended_by"], "samples");
  EXPECT_NE(report("a.json")["film_hash"], report("b.json")["film_hash"]);
  render({"-o", "c.exr", "--sampler", "sobol", "--spp", "10", "--pass", "4", "--stop-after", "10"});
  EXPECT_TRUE(file_contents(folder_ / "b.exr") == file_contents(folder_ / "c.exr")) << "that is all of them";
  const ProgramResult result =
      run_penumbra(folder_.path(), {"render", "s.xml", "--spp", "4", "--stop-after", "5"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--stop-after 5: the render has 4 samples"));
}

TEST_F(RenderCommand, FilesDoNotDependOnHowTheSceneIsNamed) {
  render({"-o", "a.exr"});
  std::filesystem::create_directory(folder_ / "elsewhere");
  for (const std::string& name :
       {std::string("./s.xml"), (folder_ / "s.xml").string(), std::string("elsewhere/../s.xml")}) {
    ASSERT_EQ(run_penumbra(folder_.path(), {"render", name, "-o", "b.exr"}).exit_code, 0);
    EXPECT_TRUE(file_contents(folder_ / "a.exr") == file_contents(folder_ / "b.exr")) << name;
  }
  ASSERT_EQ(run_penumbra(folder_ / "elsewhere", {"render", "../s.xml", "-o", "../b.exr"}).exit_code, 0);
  EXPECT_TRUE(file_contents(folder_ / "a.exr") == file_contents(folder_ / "b.exr")) << "from another folder";
}

TEST_F(RenderCommand, SeedChangesTheImage) {
  render({"-o", "a.exr"});
  render({"-o", "b.exr", "--seed", "1"});
  EXPECT_NE(image("a.exr").values, image("b.exr").values);
}

TEST_F(RenderCommand, ACropIsThatPartOfTheWholeImage) {
  render({"-o", "whole.exr"});
  render({"-o", "part.exr", "--crop", "5,7,20,19"});
  const Image whole = image("whole.exr"), part = image("part.exr");
  EXPECT_EQ(part.data, (PixelWindow{5, 7, 15, 12}));
  EXPECT_EQ(part.display, (PixelWindow{0, 0, 24, 20}));
  ASSERT_EQ(part.channels, whole.channels);
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 15; ++x) {
      for (std::size_t c = 0; c < part.channels.size(); ++c) {
        EXPECT_EQ(part.at(x, y, c), whole.at(x + 5, y + 7, c)) << x << ',' << y << ' ' << part.channels[c];
      }
    }
  }
}

/// The film of 24 x 20 pixels, half of it, is one of 12 x 10 in every respect.
TEST_F(RenderCommand, AScaledFilmIsOneOfThatSize) {
  render({"-o", "small.exr", "--set", "film.width=12", "--set", "film.height=10"});
  for (const char* scale : {"50%", "0.5"}) {
    render({"-o", "scaled.exr", "--scale", scale});
    EXPECT_EQ(report("scaled.json")["film_hash"], report("small.json")["film_hash"]) << scale;
    EXPECT_EQ(image("scaled.exr").attribute("penumbra:scale"), MetadataValue(0.5));
  }
  render({"-o", "set.exr", "--scale", "25%", "--set", "film.width=48", "--set", "film.height=40"});
  EXPECT_EQ(report("set.json")["film_hash"], report("small.json")["film_hash"]) << "--set comes first";
  render({"-o", "all.exr"});
  render({"-o", "all2.exr", "--scale", "100%"});
  EXPECT_EQ(file_contents(folder_ / "all.exr"), file_contents(folder_ / "all2.exr"));
}

TEST_F(RenderCommand, AScaledFilmsCommandGivesTheSameBytes) {
  render({"-o", "a.exr", "--scale", "30%", "--set", "film.crop_offset_x=4", "--set", "film.crop_width=12"});
  EXPECT_EQ(image("a.exr").display, (PixelWindow{0, 0, 7, 6})) << "7.2 x 6";
  EXPECT_EQ(image("a.exr").data, (PixelWindow{1, 0, 4, 6})) << "from 1.2 to 4.8";
  repeat("a.exr", "b.exr");
  EXPECT_EQ(file_contents(folder_ / "a.exr"), file_contents(folder_ / "b.exr"));
  render({"-o", "c.exr", "--scale", "30%", "--crop", "1,0,5,6"});
  EXPECT_EQ(image("c.exr").values, image("a.exr").values) << "--crop is in the scaled film's pixels";
  const ProgramResult outside =
      run_penumbra(folder_.path(), {"render", "s.xml", "--scale", "30%", "--crop", "0,0,8,6"});
  EXPECT_EQ(outside.exit_code, 2);
  EXPECT_THAT(outside.err, HasSubstr("--crop reaches outside the film, which is 7 x 6 pixels after --scale"));
}

TEST_F(RenderCommand, AJobFileScalesItsRenders) {
  write_text(folder_ / "jobs.toml",
             "[[render]]\nscene = 's.xml'\nscale = ['25%', 0.5]\nout = 'a-{scale}.exr'\n");
  const ProgramResult done = run_penumbra(folder_.path(), {"render", "jobs.toml"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(image("a-25%25.exr").display, (PixelWindow{0, 0, 6, 5}));
  EXPECT_EQ(image("a-0.5.exr").display, (PixelWindow{0, 0, 12, 10}));
  write_text(folder_ / "jobs.toml", "[[render]]\nscene = 's.xml'\nscale = 25\n");
  const ProgramResult wrong = run_penumbra(folder_.path(), {"render", "jobs.toml"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("25% is written 25% or 0.25"));
}

TEST_F(RenderCommand, PixelPrintsTheImagesOwnBits) {
  render({"-o", "whole.exr"});
  const Image whole = image("whole.exr");
  const ProgramResult result = render({"--pixel", "12,14"});
  EXPECT_THAT(folder_.names(), ElementsAre("s.xml", "whole.exr", "whole.json", "whole.png"));
  EXPECT_THAT(result.out, HasSubstr("pixel 12,14  8 samples"));
  char expected[128];
  std::snprintf(expected, sizeof expected, "%17a%17a%17a", whole.at(12, 14, *whole.channel("R")),
                whole.at(12, 14, *whole.channel("G")), whole.at(12, 14, *whole.channel("B")));
  EXPECT_THAT(result.out, HasSubstr(expected));
}

TEST_F(RenderCommand, WritesOnlyWhatIsAskedFor) {
  const ProgramResult result = render({"-o", "p.png", "--no-report", "--quiet"});
  EXPECT_THAT(folder_.names(), ElementsAre("p.png", "s.xml"));
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(result.err, IsEmpty());
}

TEST_F(RenderCommand, FeatureLayersCanBeLeftOut) {
  render({"--no-features"});
  EXPECT_THAT(image("s.exr").channels,
              ElementsAre("R", "G", "B", "samples.Y", "variance.R", "variance.G", "variance.B"));
}

TEST_F(RenderCommand, TimeBudgetEndsWithWholeUnitsInTheirOrder) {
  const ProgramResult first =
      render({"--spp", "100000000", "--pass", "4", "--tile", "8", "--time-budget", "0.3"});
  EXPECT_THAT(first.out,
              ContainsRegex("24 x 20 pixels, [0-9]+(–[0-9]+)? of 100000000 samples per pixel: ended "
                            "by the budget, in "));
  const Image exr = image("s.exr");
  const std::size_t count = *exr.channel("samples.Y");
  EXPECT_GE(exr.at(0, 0, count), 4.0f);
  // Nine tiles, each of which has as many samples as the one before or a pass less than the first one.
  float last = exr.at(0, 0, count);
  for (int tile = 0; tile < 9; ++tile) {
    const int left = tile % 3 * 8, top = tile / 3 * 8;
    const float here = exr.at(left, top, count);
    EXPECT_TRUE(here == last || (last == exr.at(0, 0, count) && here == last - 4)) << tile;
    last = here;
    for (int y = top; y < std::min(top + 8, 20); ++y)
      for (int x = left; x < left + 8; ++x) EXPECT_EQ(exr.at(x, y, count), here);
  }
  EXPECT_EQ(exr.attribute("penumbra:spp"), MetadataValue(100000000));
  EXPECT_EQ(report("s.json")["complete"], false) << "of 100000000 samples";
  EXPECT_EQ(report("s.json")["ended_by"], "time_budget");
  EXPECT_TRUE(exr.attribute("penumbra:command").has_value());
}

TEST_F(RenderCommand, StopsAfterSomeOfItsUnits) {
  render({"-o", "a.exr", "--spp", "64", "--pass", "4", "--tile", "8", "--stop-after-units", "31"});
  const Image exr = image("a.exr");
  const std::size_t count = *exr.channel("samples.Y");
  for (int tile = 0; tile < 9; ++tile)
    EXPECT_EQ(exr.at(tile % 3 * 8, tile / 3 * 8, count), tile < 31 % 9 ? 16.0f : 12.0f) << tile;
  EXPECT_EQ(report("a.json")["complete"], true);
  repeat("a.exr", "b.exr");
  EXPECT_TRUE(file_contents(folder_ / "a.exr") == file_contents(folder_ / "b.exr"));
  render({"-o", "c.exr", "--spp", "64", "--pass", "4", "--tile", "8", "--stop-after-units", "31", "--workers",
          "3"});
  EXPECT_TRUE(file_contents(folder_ / "a.exr") == file_contents(folder_ / "c.exr"));
  // Whole passes are the same as samples of each pixel, whatever the tiles.
  render({"-o", "d.exr", "--spp", "64", "--pass", "4", "--tile", "8", "--stop-after-units", "27"});
  render({"-o", "e.exr", "--spp", "64", "--pass", "4", "--stop-after", "12"});
  EXPECT_EQ(report("d.json")["film_hash"], report("e.json")["film_hash"]);
}

TEST_F(RenderCommand, EmbreeRecordsItsInstructionSet) {
  const std::string narrowest(isa_name(usable_isas().front()));
  render({"--intersector", "embree", "--isa", narrowest});
  const Image exr = image("s.exr");
  EXPECT_EQ(exr.attribute("penumbra:intersector"), MetadataValue("embree"));
  EXPECT_EQ(exr.attribute("penumbra:isa"), MetadataValue(narrowest));
}

TEST_F(RenderCommand, CornellBoxHasItsColoursInPlace) {
  const std::string scene = source_path("scenes/cornell-small/cornell-small.xml");
  const ProgramResult result =
      run_penumbra(folder_.path(), {"render", scene, "--workers", "2", "--threads", "1", "--spp", "4"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Image png = image("cornell-small.png");
  const auto mean = [&](int x0, int x1, std::size_t channel) {
    double sum = 0;
    for (int y = png.data.height / 4; y < png.data.height * 3 / 4; ++y) {
      for (int x = x0; x < x1; ++x) sum += png.at(x, y, channel);
    }
    return sum;
  };
  const int width = png.data.width, eighth = width / 8;
  EXPECT_GT(mean(0, eighth, 0), 2 * mean(0, eighth, 1)) << "the left wall is red";
  EXPECT_GT(mean(width - eighth, width, 1), 1.2 * mean(width - eighth, width, 0))
      << "the right wall is green";
  std::uint64_t samples = 0;
  for (const auto& worker : report("cornell-small.json")["workers"])
    samples += worker["samples"].get<std::uint64_t>();
  EXPECT_EQ(samples, std::uint64_t(png.pixels()) * 4);
}

}  // namespace
}  // namespace penumbra
