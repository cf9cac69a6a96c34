// Tests how job files are read, and which errors are reported.
#include "scheduler/sets/job_file.h"
#include "scheduler/sets/failure_reasons.h"
#include "scheduler/sets/set_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class JobFileTest : public ::testing::Test {
 protected:
  Expected<JobFile> read(const std::string& text) {
    write_text(folder_ / "jobs.toml", text);
    return read_job_file(folder_ / "jobs.toml");
  }
  std::string in_folder(const std::string& name) { return (folder_ / name).string(); }

  TemporaryFolder folder_;
};

const RenderAxis* find_axis(const RenderPattern& pattern, AxisKind kind, const std::string& name) {
  for (const RenderAxis& axis : pattern.axes)
    if (axis.kind == kind && axis.name == name) return &axis;
  return nullptr;
}

TEST_F(JobFileTest, RendersOverrideDefaults) {
  for (const char* name : {"x1.xml", "x2.xml"}) write_text(folder_ / name, "");
  const auto file = read(R"([defaults]
spp = 4
seed = "1..3"
set.film.width = 20
out = "images"

[[render]]
set = { "film.width" = 30, integrator.max_depth = [2, 8] }
scene = ["x*.xml", "other.xml"]
lenient = true
time_budget = 1.5

[[render]]
scene = "{frame:04}.xml"
frame = "8..12x2"
define = { albedo = 0.5, material = "glass" }
seed = 9
priority = -3
out = "{frame}.png"
)");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->patterns.size(), 2);
  const RenderPattern &a = file->patterns[0], &b = file->patterns[1];
  EXPECT_THAT(a.axes.front().values,
              ElementsAre(in_folder("x1.xml"), in_folder("x2.xml"), in_folder("other.xml")));
  EXPECT_THAT(find_axis(a, AxisKind::kOption, "seed")->values, ElementsAre("1", "2", "3"));
  EXPECT_THAT(find_axis(a, AxisKind::kSetting, "film.width")->values, ElementsAre("30"));
  EXPECT_THAT(find_axis(a, AxisKind::kSetting, "integrator.max_depth")->values, ElementsAre("2", "8"));
  EXPECT_THAT(find_axis(a, AxisKind::kFlag, "lenient")->values, ElementsAre("true"));
  EXPECT_THAT(find_axis(a, AxisKind::kOption, "time-budget")->values, ElementsAre("1.5"));
  EXPECT_EQ(a.out, in_folder("images"));
  EXPECT_EQ(a.priority, 0);

  EXPECT_THAT(b.axes.front().values, ElementsAre(in_folder("{frame:04}.xml")));
  EXPECT_THAT(find_axis(b, AxisKind::kFrame, "frame")->values, ElementsAre("8", "10", "12"));
  EXPECT_THAT(find_axis(b, AxisKind::kDefine, "material")->values, ElementsAre("glass"));
  EXPECT_THAT(find_axis(b, AxisKind::kOption, "seed")->values, ElementsAre("9"));
  EXPECT_THAT(find_axis(b, AxisKind::kSetting, "film.width")->values, ElementsAre("20"));
  EXPECT_EQ(b.priority, -3);
  EXPECT_EQ(b.out, in_folder("{frame}.png"));
}

TEST_F(JobFileTest, ErrorsHaveTheirPlace) {
  const struct {
    std::string text;
    const char *place, *what;
  } cases[] = {
      {"[[render]\n", ":1:", "not TOML"},
      {"", ":1:1", "no [[render]]"},
      {"[[render]]\nspp = 3", ":1:1", "has no scene"},
      {"[[render]]\nscene = []", ":2:9", "a list without values"},
      {"[[render]]\nscene = 3", ":2:9", "a file's name"},
      {"[[render]]\nscene = 'no-*.xml'", ":2:9", "no file matches"},
      {"[[render]]\nscene = '*{frame}.xml'", ":2:9", "both a field and"},
      {"[[render]]\nscene = 'a'\nspp = 0", ":3:7", "--spp"},
      {"[[render]]\nscene = 'a'\nspp = [1, 'x']", ":3:11", "--spp"},
      {"[[render]]\nscene = 'a'\nspp = [1, 1]", ":3:11", "'1' twice"},
      {"[[render]]\nscene = 'a'\nspp = [[1]]", ":3:8", "a text, a number"},
      {"[[render]]\nscene = 'a'\nspp = 1979-05-27", ":3:7", "a text, a number"},
      {"[[render]]\nscene = 'a'\nbackend = ''", ":3:11", "an empty text"},
      {"[[render]]\nscene = 'a'\nsead = 3", ":3:1", "did you mean 'seed'"},
      {"[[render]]\nscene = 'a'\nseed = '5..2'", ":3:8", "--seed"},
      {"[[render]]\nscene = 'a'\nframe = -1", ":3:9", "whole numbers from 0"},
      {"[[render]]\nscene = 'a'\nlenient = 1", ":3:11", "true or false"},
      {"[[render]]\nscene = 'a'\nworkers = 1", ":3:1", "on the command line, as --workers"},
      {"[[render]]\nscene = 'a'\nresume = true", ":3:1", "on the command line, as --resume"},
      {"[[render]]\nscene = 'a'\nset = 1", ":3:7", "set is a table"},
      {"[[render]]\nscene = 'a'\nset.film.widht = 1", ":3:18", "did you mean 'film.width'"},
      {"[[render]]\nscene = 'a'\ncrop = '1,2,3'", ":3:8", "--crop"},
      {"[[render]]\nscene = 'a'\npriority = 'high'", ":3:12", "the highest goes first"},
      {"[[render]]\nscene = 'a'\npriority = -9223372036854775807", ":3:12", "the highest goes first"},
      {"[[render]]\nscene = 'a'\nout = 3", ":3:7", "a folder, or a name"},
      {"[[render]]\nscene = 'a'\nname = ''", ":3:8", "by which other renders come after"},
      {"[[render]]\nscene = 'a'\nafter = 3", ":3:9", "the name of another render"},
      {"[[render]]\nscene = 'a'\nafter = 'x'", ":1:1", "no render has the name 'x'"},
      {"[[render]]\nscene = 'a'\nname = 'x'\nafter = 'x'", ":1:1", "'x' would come after itself"},
      {"[[render]]\nscene = 'a'\nname = 'x'\nafter = ['y']\n[[render]]\nscene = 'b'\nname = 'y'\nafter = 'x'",
       ":1:1", "'x' would come after itself"},
      {"[render]\nscene = 'a'", ":1:", "a render is a [[render]] table, with two brackets"},
      {"[[defaults]]\nspp = 1\n[[render]]\nscene = 'a'", ":1:", "[defaults] is one table"},
      {"[[render]]\nscene = 'a'\n[default]\nspp = 1", ":3:", "[defaults] and [[render]]"},
  };
  for (const auto& [text, place, what] : cases) {
    const auto file = read(text);
    ASSERT_FALSE(file) << text;
    EXPECT_THAT(file.error().message, AllOf(StartsWith(in_folder("jobs.toml") + place), HasSubstr(what)))
        << text;
  }
  EXPECT_FALSE(read_job_file(folder_ / "missing.toml"));
}

TEST(SetTable, HasAColumnForEachParameterAndUniqueNames) {
  SetEntry first;
  first.name = "a, b";
  first.scene = "a.xml";
  first.choices = {{"seed", "3"}, {"state", "x"}};
  first.state = SetState::kDone;
  first.samples = 16;
  first.seconds = 0.5;
  first.relative_error = 0.25;
  first.files = {"/out/a.exr", "/out/a.png"};
  SetEntry second;
  second.name = "c";
  second.scene = "c.xml";
  second.choices = {{"integrator", "path"}};
  second.state = SetState::kFailed;
  second.error = "no such file\nmore";
  EXPECT_EQ(set_table({first, second}),
            "name,scene,seed,parameter.state,integrator,state,samples_per_pixel,seconds,relative_error,file,"
            "error\r\n"
            "\"a, b\",a.xml,3,x,,done,16,0.5,0.25,/out/a.exr,\r\n"
            "c,c.xml,,,path,failed,,,,,no such file\r\n");
}

TEST(FailureReasons, AreToldOnceWhateverTheSceneIs) {
  FailureReasons failures;
  EXPECT_TRUE(failures.add("one", "a.1.xml", "there is no file 'a.1.xml'"));
  EXPECT_FALSE(failures.add("two", "a.2.xml", "there is no file 'a.2.xml'"));
  EXPECT_TRUE(failures.add("three", "a.3.xml", "a.3.xml:1:2: not XML\nmore"));
  EXPECT_FALSE(failures.add("four", "a.4.xml", "there is no file 'a.4.xml'"));
  EXPECT_THAT(
      failures.repeated(),
      ::testing::ElementsAre("2 more renders failed like one, from two to four: there is no file 'a.1.xml'"));
}

TEST_F(JobFileTest, AreToldFromScenes) {
  const auto is_one = [&](const std::string& name, const std::string& text) {
    write_text(folder_ / name, text);
    return is_job_file(folder_ / name);
  };
  EXPECT_TRUE(is_one("a.toml", "# jobs\n[defaults]\nspp = 1\n [[ render ]] # all\nscene = 'x'"));
  EXPECT_TRUE(is_one("a.TOML", "[[render]]"));
  EXPECT_TRUE(is_one("a.toml", "[render]\nscene = 'x'")) << "its error says how it is written";
  EXPECT_FALSE(is_one("a.toml", "[renderer]\nspp = 1\n[camera]\n"));
  EXPECT_FALSE(is_one("a.xml", "[[render]]"));
  EXPECT_FALSE(is_job_file(folder_ / "missing.toml"));
  EXPECT_FALSE(is_job_file(folder_.path()));
}

TEST_F(JobFileTest, DamagedFilesAreErrorsOrJobs) {
  const std::string whole =
      "[defaults]\nspp = [4, 8]\n[[render]]\nscene = \"a.xml\"\nset = { film.width = 3 }\nseed = \"1..3x2\"\n"
      "define.albedo = [0.5, 1e3]\nframe = \"2..4\"\nout = \"{scene}-{seed:03}.exr\"\npriority = 2\n";
  std::mt19937 random(5);
  int jobs = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string text = whole;
    for (int change = 0; change < 1 + round % 3; ++change) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = char(random());
          break;
        case 1:
          text.erase(at, 1 + random() % 8);
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), random() % 8));
      }
      if (text.empty()) text = "x";
    }
    const auto file = read(text);
    if (file)
      ++jobs;
    else
      EXPECT_FALSE(file.error().message.empty());
  }
  EXPECT_GT(jobs, 0);
}

}  // namespace
}  // namespace penumbra
