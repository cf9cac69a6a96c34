#include "scheduler/run/render_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "scheduler/render/render_option.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;

/// The options that a command line gives, or the parser's message.
std::string parse(std::vector<std::string> words, RenderOptions& options) {
  CommandLine app("");
  add_render_options(app, options);
  const auto parsed = app.parse(std::move(words));
  return parsed ? "" : parsed.error().message;
}

std::string parse(const std::vector<std::string>& words) {
  RenderOptions options;
  return parse(words, options);
}

TEST(RenderOptions, Defaults) {
  RenderOptions options;
  ASSERT_EQ(parse({"a.xml"}, options), "");
  EXPECT_THAT(options.scenes, ElementsAre("a.xml"));
  EXPECT_EQ(options.workers, 1);
  EXPECT_EQ(options.threads, 0);
  const PlanOptions plan = plan_of(options, {});
  EXPECT_EQ(plan.tile, 64);
  EXPECT_EQ(plan.samples_per_pass, 16u);
  EXPECT_EQ(options.backend, Backend::kNative);
  EXPECT_FALSE(options.scene.spp);
  EXPECT_FALSE(options.scene.seed);
  EXPECT_FALSE(options.crop);
}

TEST(RenderOptions, ProgressivePhotonMappingHasAMapForEachSampleAndLargeTilesUnlessTheyAreGiven) {
  const IntegratorSettings ppm{.method = ProgressivePhotonIntegrator{}},
      fixed{.method = PhotonMapIntegrator{}};
  RenderOptions options;
  ASSERT_EQ(parse({"a.xml"}, options), "");
  EXPECT_EQ(plan_of(options, ppm).samples_per_pass, 1u);
  EXPECT_EQ(plan_of(options, ppm).tile, 256);
  EXPECT_EQ(plan_of(options, fixed).samples_per_pass, 16u);
  EXPECT_EQ(plan_of(options, fixed).tile, 64);
  ASSERT_EQ(parse({"a.xml", "--pass", "16", "--tile", "64"}, options), "");
  for (const IntegratorSettings& integrator : {ppm, fixed, IntegratorSettings()}) {
    EXPECT_EQ(plan_of(options, integrator).samples_per_pass, 16u);
    EXPECT_EQ(plan_of(options, integrator).tile, 64);
  }
}

TEST(RenderOptions, AssignmentsTakeOneWordEach) {
  RenderOptions options;
  ASSERT_EQ(parse({"-D", "a=1", "-Db=2", "a.xml", "--set", "film.width=3", "--set", "x=a=b"}, options), "");
  EXPECT_THAT(options.scenes, ElementsAre("a.xml"));
  EXPECT_THAT(options.scene.defines, ElementsAre("a=1", "b=2"));
  EXPECT_THAT(options.scene.settings, ElementsAre("film.width=3", "x=a=b"));
}

TEST(RenderOptions, CropAndPixel) {
  RenderOptions options;
  ASSERT_EQ(parse({"a.xml", "--crop", "1,2,30,40"}, options), "");
  ASSERT_TRUE(options.crop);
  EXPECT_EQ(options.crop->x0, 1);
  EXPECT_EQ(options.crop->y0, 2);
  EXPECT_EQ(options.crop->x1, 30);
  EXPECT_EQ(options.crop->y1, 40);
  ASSERT_EQ(parse({"a.xml", "--pixel", "7,0"}, options), "");
  EXPECT_EQ(options.pixel->x, 7);
  EXPECT_NE(parse({"a.xml", "--pixel", "7,0", "--crop", "0,0,1,1"}), "");
}

TEST(RenderOptions, FlagsTakeTheUsualWords) {
  RenderOptions options;
  ASSERT_EQ(
      parse({"a.xml", "--lenient=1", "--adaptive=yes", "--cryptomatte=off", "--strict-numerics"}, options),
      "");
  EXPECT_TRUE(options.scene.lenient && options.plan.adaptive && options.strict_numerics);
  EXPECT_FALSE(options.scene.cryptomatte);
  EXPECT_NE(parse({"a.xml", "--lenient=perhaps"}), "");
}

TEST(RenderOptions, RejectsWhatIsNoRectangle) {
  for (const char* bad : {"", "1,2,3", "1,2,3,4,5", "3,0,3,1", "0,5,1,4", "a,b,c,d", "0,0,1,1 ",
                          "0,0,1,9999999999", "-1,0,1,1", "0;0;1;1", "0,0,1.5,1"}) {
    EXPECT_FALSE(parse_crop(bad)) << bad;
  }
  for (const char* bad : {"", "1", "1,", "1,2,3", "-1,0", "x,y"}) EXPECT_FALSE(parse_pixel(bad)) << bad;
}

/// A text that the option takes, but which is not its default.
std::string some_text_for(const RenderOption& option) {
  if (option.kind == OptionKind::kFlag) return "true";
  if (option.limits.starts_with("{"))
    return option.limits.substr(option.limits.rfind(',') + 1,
                                option.limits.rfind('}') - option.limits.rfind(',') - 1);
  if (option.kind == OptionKind::kInteger || option.kind == OptionKind::kCount) return "7";
  if (option.value == "X0,Y0,X1,Y1") return "1,2,3,4";
  if (option.value == "X,Y") return "5,6";
  if (option.value == "MODE") return "frame";
  if (option.value == "NAMES") return "position";
  return option.kind == OptionKind::kList                   ? "a=b"
         : option.value == "NAME" || option.value == "FILE" ? "ä b"
                                                            : "0.25";
}

TEST(RenderOptionRows, PrintWhatTheyTakeAndHaveOneNameEach) {
  std::set<std::string> names;
  for (const RenderOption& option : all_render_options()) {
    EXPECT_TRUE(names.insert(option.name()).second) << option.name();
    EXPECT_EQ(find_render_option(option.name()), &option);
    for (const std::string& other : option.excludes) EXPECT_NE(find_render_option(other), nullptr) << other;
    EXPECT_THAT(given_values(option, {}), ElementsAre());
    RenderRequest request, again;
    std::string text = some_text_for(option);
    const auto applied = option.apply(request, text);
    ASSERT_TRUE(applied) << option.name() << ": " << applied.error().message;
    std::vector<std::string> printed = given_values(option, request);
    EXPECT_THAT(printed, ElementsAre(text)) << option.name();
    for (std::string& each : printed) EXPECT_TRUE(option.apply(again, each));
    EXPECT_EQ(option.print(again), option.print(request)) << option.name();
    for (const RenderOption& other : all_render_options())
      if (&other != &option)
        EXPECT_THAT(given_values(other, request), ElementsAre()) << option.name() << " and " << other.name();
  }
}

TEST(RenderOptionRows, AreOptionsOfTheCommand) {
  for (const RenderOption& option : all_render_options()) {
    std::vector<std::string> words{"a.xml"};
    const std::string text = some_text_for(option);
    if (option.is_flag() || option.word().starts_with("--"))
      words.push_back(option.kind == OptionKind::kFlag ? option.word() : option.word() + "=" + text);
    else
      words.insert(words.end(), {option.word(), text});
    RenderOptions options;
    ASSERT_EQ(parse(words, options), "") << option.name();
    EXPECT_THAT(given_values(option, options), ElementsAre(text)) << option.name();
  }
}

TEST(RenderOptions, TimesAndSharesAreNumbers) {
  RenderOptions options;
  ASSERT_EQ(
      parse({"a.xml", "--time-budget", "15m", "--scale", "25%", "--lenient=false", "--denoise"}, options),
      "");
  EXPECT_EQ(options.time_budget, 900);
  EXPECT_EQ(options.scene.scale, 0.25);
  EXPECT_FALSE(options.scene.lenient);
  EXPECT_EQ(options.scene.denoise, "nfor");
}

TEST(RenderOptions, SeedCoversItsWholeRange) {
  RenderOptions options;
  ASSERT_EQ(parse({"a.xml", "--seed", "4294967295"}, options), "");
  EXPECT_EQ(options.scene.seed, 4294967295u);
  ASSERT_EQ(parse({"a.xml", "--seed", "0"}, options), "");
  EXPECT_EQ(options.scene.seed, 0u);
  EXPECT_NE(parse({"a.xml", "--seed", "4294967296"}), "");
  EXPECT_NE(parse({"a.xml", "--seed", "-1"}), "");
}

TEST(RenderOptions, RejectsValuesOutOfRange) {
  const std::vector<std::vector<std::string>> bad = {
      {},
      {"a.xml", "--spp", "0"},
      {"a.xml", "--spp", "many"},
      {"a.xml", "--spp", "1.5"},
      {"a.xml", "--tile", "0"},
      {"a.xml", "--pass", "0"},
      {"a.xml", "--pass", "4097"},
      {"a.xml", "--workers", "0"},
      {"a.xml", "--workers", "-2"},
      {"a.xml", "--threads", "0"},
      {"a.xml", "--time-budget", "0"},
      {"a.xml", "--time-budget", "-1"},
      {"a.xml", "--backend", "cuda"},
      {"a.xml", "--isa", "neon"},
      {"a.xml", "--intersector", "optix"},
      {"a.xml", "--integrator", "bdpt"},
      {"a.xml", "--sampler", "pmj"},
      {"a.xml", "-D", "novalue"},
      {"a.xml", "-D", "=1"},
      {"a.xml", "--set", "key"},
      {"a.xml", "--report", "r.json", "--no-report"},
      {"a.xml", "--undo"},
      {"a.xml", "--resume", "--pixel", "1,1"},
      {"a.xml", "--checkpoint-interval", "-1"},
  };
  for (const auto& words : bad) EXPECT_NE(parse(words), "") << (words.empty() ? "nothing" : words.back());
}

}  // namespace
}  // namespace penumbra
