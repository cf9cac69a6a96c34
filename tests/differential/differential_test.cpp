// Penumbra against Mitsuba 3 on random and hand-made scenes. PENUMBRA_DIFFERENTIAL_SCENE=NAME (a seed or a
// name) runs one scene only and prints where its files are.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/differential/agreement.h"
#include "tests/differential/camera_scenes.h"
#include "tests/differential/converted_scenes.h"
#include "tests/differential/emitter_scenes.h"
#include "tests/differential/material_scenes.h"
#include "tests/differential/media_scenes.h"
#include "tests/differential/named_scenes.h"
#include "tests/differential/random_scene.h"
#include "tests/differential/textured_scenes.h"

namespace penumbra::differential {
namespace {

constexpr int kParts = 4, kScenesOfPart = 55;

void compare(std::vector<SceneText> scenes) {
  const char* only = std::getenv("PENUMBRA_DIFFERENTIAL_SCENE");
  if (only != nullptr) {
    std::erase_if(scenes, [&](const SceneText& scene) { return scene.name != only; });
    if (scenes.empty()) GTEST_SKIP() << "PENUMBRA_DIFFERENTIAL_SCENE=" << only << " is none of these scenes";
  }
  MitsubaProcess mitsuba;
  if (!mitsuba.ready()) {
    if (mitsuba.named()) FAIL() << mitsuba.ready().error().message;
    GTEST_SKIP() << mitsuba.ready().error().message;
  }
  const std::size_t all = named_scenes().size() + material_scenes().size() + camera_scenes().size() +
                          textured_scenes().size() + media_scenes().size() + emitter_scenes().size() +
                          converted_scenes().size() + std::size_t(kParts * kScenesOfPart);
  expect_agreement(mitsuba, scenes, all, only != nullptr);
}

class Differential : public testing::TestWithParam<int> {};

TEST_P(Differential, RandomScenesAreAsMitsubaRendersThem) {
  std::vector<SceneText> scenes;
  for (int k = 0; k < kScenesOfPart; ++k)
    scenes.push_back(random_scene(std::uint32_t(GetParam() * kScenesOfPart + k)));
  compare(scenes);
}

INSTANTIATE_TEST_SUITE_P(Parts, Differential, testing::Range(0, kParts));

TEST(DifferentialTest, NamedScenesAreAsMitsubaRendersThem) { compare(named_scenes()); }

TEST(DifferentialTest, MaterialsAreAsMitsubaRendersThem) { compare(material_scenes()); }

TEST(DifferentialTest, ScenesOfEmittersAreAsMitsubaRendersThem) { compare(emitter_scenes()); }

TEST(DifferentialTest, MediaAreAsMitsubaRendersThem) { compare(media_scenes()); }

TEST(DifferentialTest, ConvertedScenesAreAsTheyWere) { compare(converted_scenes()); }

TEST(DifferentialTest, CamerasAreMitsubas) { compare(camera_scenes()); }

TEST(DifferentialTest, TexturedScenesAreAsMitsubaRendersThem) { compare(textured_scenes()); }

}  // namespace
}  // namespace penumbra::differential
