// The texts that the commands print for users: help, settings, plugins and info. Lines fit the terminal, and
// words are plain.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "worker/cli/text_layout.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string output_of(const TemporaryFolder& folder, const std::vector<std::string>& arguments) {
  const ProgramResult result = run_penumbra(folder.path(), arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  return result.out;
}

/// The program, and its commands.
std::vector<std::vector<std::string>> all_commands(const TemporaryFolder& folder) {
  std::vector<std::vector<std::string>> commands{{}};
  for (const std::string& line : lines_of(output_of(folder, {"complete", ""})))
    commands.push_back({line.substr(0, line.find('\t'))});
  if (!has_window()) std::erase(commands, std::vector<std::string>{"view"});
  return commands;
}

void expect_known_words(const std::string& text, const std::string& where) {
  static const std::regex ours(
      "\\b(lamps?|owners?|strips?|shafts?|survey(s|ed)?|stand-ins?|stands? in)\\b|counts for nothing",
      std::regex::icase);
  std::smatch found;
  EXPECT_FALSE(std::regex_search(text, found, ours)) << where << " says '" << found.str() << "'";
}

void expect_it_fits(const std::string& text, const std::string& where) {
  for (const std::string& line : lines_of(text))
    EXPECT_LE(columns_of(line), kTextColumns) << where << ": " << line;
}

TEST(Help, OfEveryCommandFitsIsGroupedAndPlain) {
  const TemporaryFolder folder;
  const auto commands = all_commands(folder);
  ASSERT_GT(commands.size(), 15u);
  for (std::vector<std::string> command : commands) {
    const std::string name = command.empty() ? "penumbra" : command.front();
    command.emplace_back("--help");
    const std::string help = output_of(folder, command);
    expect_it_fits(help, name);
    expect_known_words(help, name);
    if (help.contains("--help-all")) {
      command.back() = "--help-all";
      const std::string all = output_of(folder, command);
      expect_it_fits(all, name);
      expect_known_words(all, name);
      EXPECT_THAT(all, Not(HasSubstr("with ,"))) << name << ": an option without a name";
    }
    std::string heading;
    for (const std::string& line : lines_of(help)) {
      if (line.ends_with(":") && !line.starts_with(" ")) heading = line;
      if (line.starts_with("  -") || line.starts_with("  SCENE"))
        EXPECT_THAT(heading, Not(::testing::AnyOf("", "Options:", "Examples:"))) << name << ": " << line;
    }
    EXPECT_THAT(help, HasSubstr("\nGeneral:\n")) << name;
    EXPECT_THAT(help, HasSubstr("-h, --help")) << name;
  }
}

TEST(Help, SaysWhatAnOptionTakes) {
  const TemporaryFolder folder;
  const std::string help = output_of(folder, {"render", "--help-all"});
  for (const char* text :
       {"\nInput:\n  SCENE... ", "\nIntegrator and samples:\n", "\nWorkers and devices:\n", "[default: 5]",
        "(default: 64; 256 with ppm)", "[1 to 2048]", "[auto, portable, embree]", "[not with --pixel]",
        "[or PENUMBRA_KEYS]", "\nExamples:\n  penumbra render scenes/cornell/cornell.xml"})
    EXPECT_THAT(help, HasSubstr(text));
}

TEST(Help, OfACommandHasItsOwnExamples) {
  const TemporaryFolder folder;
  for (const char* command : {"cancel", "prioritize", "retry", "fetch", "plugins", "settings", "convert"}) {
    const std::string help = output_of(folder, {command, "--help"});
    EXPECT_THAT(help,
                AllOf(HasSubstr(std::string("\n  penumbra ") + command), Not(HasSubstr("penumbra render"))));
  }
}

TEST(Plugins, AreListedInALineEach) {
  const TemporaryFolder folder;
  const std::string list = output_of(folder, {"plugins"});
  expect_it_fits(list, "plugins");
  expect_known_words(list, "plugins");
  EXPECT_LT(lines_of(list).size(), 160u);
  for (const char* line : {"\n  roughconductor      rough metal (microfacets)\n", "\nsensor\n  perspective  ",
                           "\n  rectangle           square from", "\nintegrator\n  direct  "})
    EXPECT_THAT(list, HasSubstr(line));
}

TEST(Plugins, OfANameAreShownWithTheirParameters) {
  const TemporaryFolder folder;
  const std::string rectangle = output_of(folder, {"plugins", "rectangle"});
  EXPECT_THAT(rectangle, StartsWith("shape rectangle: square from"));
  EXPECT_THAT(rectangle, HasSubstr("flip_normals        whether its front is the other side\n" +
                                   std::string(22, ' ') + "true, false; default: false\n"));
  EXPECT_THAT(output_of(folder, {"plugins", "bump"}),
              AllOf(StartsWith("bsdf bumpmap: "), HasSubstr("other names: bump\n")));
  EXPECT_THAT(output_of(folder, {"plugins", "bdpt"}), StartsWith("integrator path: "));
  const std::string sensors = output_of(folder, {"plugins", "sensor"});
  for (const char* text : {"sensor perspective: ", "sensor thinlens: ", "sensor orthographic: ",
                           "sensor telecentric: ", "\n  fov  ", "\n  aperture_radius  "})
    EXPECT_THAT(sensors, HasSubstr(text));
  for (const char* kind : {"bsdf", "texture", "emitter", "shape", "medium", "volume", "phase", "sensor",
                           "film", "rfilter", "sampler", "integrator"}) {
    const std::string text = output_of(folder, {"plugins", kind});
    expect_it_fits(text, kind);
    expect_known_words(text, kind);
  }
}

TEST(Plugins, OfAnUnknownNameAreAnErrorWithASuggestion) {
  const TemporaryFolder folder;
  const ProgramResult result = run_penumbra(folder.path(), {"plugins", "rectangel"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("'rectangel'; did you mean 'rectangle'?"));
  EXPECT_THAT(result.out, IsEmpty());
}

/// What the readers name in their errors is what there is.
TEST(Plugins, AreThoseOfTheReaders) {
  const TemporaryFolder folder;
  for (const char* kind : {"bsdf", "texture", "emitter", "shape", "sensor", "film", "rfilter", "sampler",
                           "integrator", "phase", "medium"}) {
    const std::string tag(kind);
    const std::string object = "<" + tag + " type='nothing' id='x'/>";
    const std::string sensor =
        tag == "sensor"                     ? object
        : tag == "film" || tag == "sampler" ? "<sensor type='perspective'>" + object + "</sensor>"
        : tag == "rfilter" ? "<sensor type='perspective'><film type='hdrfilm'>" + object + "</film></sensor>"
                           : "<sensor type='perspective'/>";
    const std::string medium = tag == "medium" ? "<medium name='interior' type='nothing'/>"
                               : tag == "phase"
                                   ? "<medium name='interior' type='homogeneous'>" + object + "</medium>"
                                   : "";
    const std::string inside =
        tag == "texture"  ? "<bsdf type='diffuse'><texture name='reflectance' type='nothing'/></bsdf>"
        : !medium.empty() ? "<integrator type='volpath'/><shape type='sphere'>" + medium + "</shape>"
        : tag == "bsdf" || tag == "emitter" || tag == "shape" || tag == "integrator" ? object
                                                                                     : "";
    write_text(folder / "s.xml", "<scene version='3.0.0'>" + sensor + inside + "</scene>");
    const ProgramResult result = run_penumbra(folder.path(), {"info", "s.xml"});
    EXPECT_EQ(result.exit_code, 2) << kind;
    const std::size_t at = result.err.find("it reads: ");
    ASSERT_NE(at, std::string::npos) << kind << result.err;
    std::istringstream names(result.err.substr(at + 10, result.err.find('\n', at) - at - 10));
    std::size_t count = 0;
    for (std::string name; std::getline(names, name, ',');) {
      name.erase(0, name.find_first_not_of(' '));
      const ProgramResult text = run_penumbra(folder.path(), {"plugins", name});
      EXPECT_EQ(text.exit_code, 0) << kind << " '" << name << "'";
      EXPECT_THAT(text.out, HasSubstr(tag + " ")) << name;
      ++count;
    }
    EXPECT_GT(count, 0u) << kind;
  }
}

TEST(Settings, AreListedInALineEach) {
  const TemporaryFolder folder;
  const std::string list = output_of(folder, {"settings"});
  expect_it_fits(list, "settings");
  expect_known_words(list, "settings");
  EXPECT_THAT(list, HasSubstr("\n  integrator.max_depth            longest path in edges"));
}

TEST(Settings, OfANameOrGroupAreShownWhole) {
  const TemporaryFolder folder;
  const std::string depth = output_of(folder, {"settings", "maxDepth"});
  EXPECT_THAT(lines_of(depth), ElementsAre("integrator.max_depth", StartsWith("    longest path in edges"),
                                           "    values: -1 or more", "    default: -1",
                                           "    integrators: path, whitted, volpath, photonmapper, ppm"));
  EXPECT_EQ(output_of(folder, {"settings", "integrator.max_depth"}), depth);
  for (const char* group : {"integrator", "sampler", "film", "camera"}) {
    const std::string text = output_of(folder, {"settings", group});
    EXPECT_THAT(text, StartsWith(group));
    expect_it_fits(text, group);
    expect_known_words(text, group);
  }
  const ProgramResult unknown = run_penumbra(folder.path(), {"settings", "max_dept"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("'max_dept'; did you mean 'max_depth'?"));
}

TEST(Info, IsPlain) {
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  for (const char* option : {"--no-features", "--verbose"}) {
    const std::string text = output_of(folder, {"info", "s.xml", option});
    expect_it_fits(text, option);
    expect_known_words(text, option);
  }
}

}  // namespace
}  // namespace penumbra
