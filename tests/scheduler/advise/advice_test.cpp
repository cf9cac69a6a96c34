// What is chosen for scenes of which the best technique is known.
#include "scheduler/advise/advice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "scenes/scene_reader.h"
#include "scenes/settings.h"
#include "scheduler/advise/advice_text.h"
#include "tests/scheduler/advise/caustic_scene.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Pair;

class AdviceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    write_caustic_scene(folder_ / "caustic.xml");
    write_small_scene(folder_ / "plain.xml");
  }
  SceneDescription read(const std::string& file,
                        std::vector<std::pair<std::string, std::string>> settings = {}) const {
    ReadOptions options;
    options.settings = std::move(settings);
    auto scene = read_scene(file, options);
    EXPECT_TRUE(scene) << scene.error().message;
    scene->sampler.kind = SamplerKind::kSobol;
    return std::move(*scene);
  }
  std::string file(const char* name) const { return (folder_ / name).string(); }
  TemporaryFolder folder_;
};

const AdviceRow* row_of(const Advice& advice, std::string_view name) {
  for (const AdviceRow& row : advice.rows)
    if (row.candidate.name == name) return &row;
  return nullptr;
}

TEST_F(AdviceTest, TakesPhotonsWhereCausticsDecide) {
  SceneDescription scene = read(file("caustic.xml"));
  const auto advice = advise(scene, {.threads = 2});
  ASSERT_TRUE(advice) << advice.error().message;
  EXPECT_THAT(advice->choice().name, HasSubstr("ppm"));
  EXPECT_GT(advice->rows.front().factor, 5) << "path needs many times the work";
  EXPECT_THAT(advice->choice().settings, Contains(Pair("integrator.caustics_only", "true")));
  EXPECT_THAT(choice_line(*advice), HasSubstr("auto: ppm"));
}

TEST_F(AdviceTest, TakesPathsWhereNothingElseIsBetter) {
  SceneDescription scene = read(source_path("scenes/cornell-small/cornell-small.xml"));
  const auto advice = advise(scene, {.threads = 2});
  ASSERT_TRUE(advice) << advice.error().message;
  EXPECT_THAT(advice->choice().name, ::testing::StartsWith("path"));
  ASSERT_NE(row_of(*advice, "ppm, caustics only"), nullptr);
  EXPECT_GT(row_of(*advice, "ppm, caustics only")->factor, 1);
}

TEST_F(AdviceTest, IsTheSameWithAnyNumberOfThreadsAndLeavesTheScene) {
  SceneDescription scene = read(file("caustic.xml"));
  const std::string before = print_setting(scene, "integrator.type");
  const auto one = advise(scene, {.threads = 1}), three = advise(scene, {.threads = 3});
  ASSERT_TRUE(one && three);
  auto a = advice_json(*one), b = advice_json(*three);
  a.erase("seconds");
  b.erase("seconds");
  EXPECT_EQ(a, b);
  EXPECT_EQ(print_setting(scene, "integrator.type"), before);
}

TEST_F(AdviceTest, DoesNotDependOnSeedOrSamples) {
  SceneDescription scene = read(file("plain.xml"));
  const auto before = advise(scene, {.threads = 2});
  scene.sampler.seed = 77;
  scene.sampler.spp = 1000;
  const auto after = advise(scene, {.threads = 2});
  ASSERT_TRUE(before && after);
  auto a = advice_json(*before), b = advice_json(*after);
  a.erase("seconds");
  b.erase("seconds");
  EXPECT_EQ(a, b);
}

TEST_F(AdviceTest, CostsLittle) {
  // 3 % of 64 samples per pixel are 1.92 samples; a small film has the same least budget.
  SceneDescription scene = read(file("caustic.xml"));
  const auto small = advise(scene, {.threads = 2});
  ASSERT_TRUE(small);
  EXPECT_EQ(small->most_work, 8e6);
  EXPECT_LE(small->work, small->most_work);
  EXPECT_GT(small->work, 0);
  scene.film.width = scene.film.crop_width = 8000;
  scene.film.height = scene.film.crop_height = 6000;
  const auto large = advise(scene, {.threads = 2});
  ASSERT_TRUE(large);
  const double of_render = 1.92 * 8000 * 6000 * large->rows.front().work;
  EXPECT_NEAR(large->most_work / of_render, 1, 0.2) << "known from a few tiles";
  EXPECT_LE(large->work, large->most_work);
}

TEST_F(AdviceTest, KeepsWhatIsFixed) {
  SceneDescription scene = read(file("caustic.xml"));
  const auto advice =
      advise(scene, {.fixed = {"integrator.caustics_only"}, .takes_photons = true, .threads = 2});
  ASSERT_TRUE(advice) << advice.error().message;
  EXPECT_EQ(advice->chosen, 0u);
  ASSERT_NE(row_of(*advice, "ppm, caustics only"), nullptr);
  EXPECT_EQ(row_of(*advice, "ppm, caustics only")->candidate.not_because, "other options fix it");
  for (const AdviceRow& row : advice->rows)
    for (const auto& [key, value] : row.candidate.settings)
      if (row.candidate.not_because.empty()) EXPECT_NE(key, "integrator.caustics_only");
}

TEST_F(AdviceTest, ComparesOnlyTheSameLight) {
  SceneDescription part = read(file("plain.xml"), {{"integrator.only_bounces", "1"}});
  SceneDescription direct = read(file("plain.xml"), {{"integrator.type", "direct"}});
  for (SceneDescription* scene : {&part, &direct}) {
    const auto advice = advise(*scene, {.threads = 2});
    ASSERT_TRUE(advice) << advice.error().message;
    const AdviceRow* photons = row_of(*advice, "ppm, caustics only");
    ASSERT_NE(photons, nullptr);
    EXPECT_THAT(photons->candidate.not_because, HasSubstr("other light"));
    EXPECT_NE(advice->choice().name.substr(0, 3), "ppm");
  }
}

TEST_F(AdviceTest, AdaptiveRendersTakeNoPhotons) {
  SceneDescription scene = read(file("caustic.xml"));
  const auto advice = advise(scene, {.takes_photons = false, .threads = 2});
  ASSERT_TRUE(advice) << advice.error().message;
  EXPECT_THAT(advice->choice().name, ::testing::StartsWith("path"));
}

TEST_F(AdviceTest, SaysWhereNothingCanBeCompared) {
  SceneDescription dark = read(file("plain.xml"));
  for (Shape& shape : dark.shapes) shape.radiance.reset();
  const auto without_light = advise(dark, {.takes_photons = false, .threads = 2});
  ASSERT_FALSE(without_light);
  EXPECT_THAT(without_light.error().message, HasSubstr("no light"));
  SceneDescription scene = read(file("plain.xml"), {{"integrator.type", "ao"}});
  const auto fixed = advise(scene, {.fixed = {"sampler.type"}, .threads = 2});
  ASSERT_FALSE(fixed);
  EXPECT_THAT(fixed.error().message, HasSubstr("nothing is left to choose"));
}

}  // namespace
}  // namespace penumbra
