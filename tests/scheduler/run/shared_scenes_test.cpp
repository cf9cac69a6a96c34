// Scenes that several renders of a set use: each is read once, and gives the same bytes as if every render
// read it anew.
#include "scheduler/run/shared_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

class SharedScenesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    write_small_scene(folder_ / "s.xml");
    write_small_scene(folder_ / "t.xml");
  }
  SceneOptions scene(const char* name = "s.xml") const {
    SceneOptions options;
    options.file = (folder_ / name).string();
    return options;
  }
  /// Of the scene with samples and seeds.
  std::vector<SceneOptions> matrix(const SceneOptions& of) const {
    std::vector<SceneOptions> renders;
    for (const std::uint32_t spp : {4, 16})
      for (const std::uint32_t seed : {0, 1, 2, 3}) {
        renders.push_back(of);
        renders.back().spp = spp;
        renders.back().seed = seed;
      }
    return renders;
  }
  static SharedScenes shared(const std::vector<SceneOptions>& renders,
                             std::uint64_t most_bytes = kMostSharedBytes) {
    std::vector<const SceneOptions*> each;
    for (const SceneOptions& options : renders) each.push_back(&options);
    return SharedScenes(each, most_bytes);
  }
  TemporaryFolder folder_;
};

void expect_same(const LoadedScene& a, LoadedScene b) {
  reduce(b);
  EXPECT_EQ(a.device.serialize(), b.device.serialize());
  EXPECT_EQ(a.description.sampler.spp, b.description.sampler.spp);
  EXPECT_EQ(a.description.sampler.seed, b.description.sampler.seed);
  EXPECT_EQ(a.description.contents_hash, b.description.contents_hash);
  EXPECT_EQ(a.description.files, b.description.files);
  EXPECT_EQ(a.description.warnings, b.description.warnings);
  EXPECT_EQ(a.description.shapes.size(), b.description.shapes.size());
  EXPECT_EQ(a.summary.needs, b.summary.needs);
  EXPECT_EQ(a.mattes, b.mattes);
  EXPECT_EQ(a.center, b.center);
}

void load_as_its_own(SharedScenes& scenes, const SceneOptions& render) {
  const auto loaded = scenes.load(render), own = load_scene(render);
  ASSERT_TRUE(loaded && own);
  expect_same(*loaded, *own);
}

TEST_F(SharedScenesTest, AMatrixOfSamplesAndSeedsReadsItsSceneOnce) {
  SceneOptions options = scene();
  options.cryptomatte = true;
  const std::vector<SceneOptions> renders = matrix(options);
  SharedScenes scenes = shared(renders);
  for (const SceneOptions& render : renders) {
    load_as_its_own(scenes, render);
    EXPECT_EQ(scenes.reads(), 1);
    EXPECT_EQ(scenes.kept_bytes() > 0, &render != &renders.back()) << "nobody else needs it";
  }
}

TEST_F(SharedScenesTest, WhateverElseDiffersIsBuiltForItself) {
  std::vector<SceneOptions> renders(10, scene());
  renders[1] = scene("t.xml");
  renders[2].defines = {"albedo=0.25"};
  renders[3].settings = {"film.width=12"};
  renders[4].integrator = "path_ems";
  renders[5].sampler = "halton";
  renders[6].intersector = "embree";
  renders[7].no_features = true;
  renders[8].cryptomatte = true;
  renders[9].spp = 3;  // the others have the scene's own number
  // Each twice, in another order.
  for (int i = 0; i < 10; ++i) renders.push_back(renders[std::size_t((7 * i + 3) % 10)]);
  SharedScenes scenes = shared(renders);
  for (const SceneOptions& render : renders) {
    load_as_its_own(scenes, render);
  }
  EXPECT_EQ(scenes.reads(), 5) << "another file, value of a variable, integrator, sampler";
  EXPECT_EQ(scenes.kept_bytes(), 0u);
}

/// Each setting of the small scene after all others have been applied to it.
TEST_F(SharedScenesTest, SettingsDoNotOutliveTheirRender) {
  std::vector<SceneOptions> renders;
  for (const char* setting :
       {"integrator.max_depth=2", "integrator.hide_emitters=true", "film.width=9", "film.crop_width=3",
        "film.rfilter=box", "film.pixel_format=rgb", "camera.fov=70", "camera.origin=1,2,3", "sampler.spp=9",
        "sampler.seed=4", "sampler.type=halton", "integrator.type=direct", "film.denoise=nfor",
        "film.height=5"})
    for (const bool is_alone : {true, false}) {
      SceneOptions& options = renders.emplace_back(scene());
      options.settings = {setting};
      if (!is_alone) options.settings.emplace_back("film.width=8");
    }
  renders.push_back(scene());
  renders.back().scale = 0.5;
  renders.push_back(scene());
  const auto long_ago = std::filesystem::file_time_type::clock::now() - std::chrono::hours(1);
  std::filesystem::last_write_time(folder_ / "s.xml", long_ago);
  SharedScenes scenes = shared(renders);
  KeptSceneFiles files(kMostSharedBytes);
  int valid = 0;
  for (int round = 0; round < 2; ++round)
    for (const SceneOptions& render : renders) {
      const auto own = load_scene(render);
      valid += own.has_value();
      const auto kept = files.load(render);
      ASSERT_EQ(kept.has_value(), own.has_value()) << render.settings.front();
      if (own) expect_same(*kept, *own);
      if (own)
        EXPECT_EQ(manifest_of(kept->device).hash,
                  manifest_of(kept->device, kept->kept->scene, kept->kept->manifest).hash);
      else
        EXPECT_EQ(kept.error().message, own.error().message);
      if (round == 0 && own) load_as_its_own(scenes, render);
    }
  EXPECT_GT(valid, 2 * 20);
  EXPECT_EQ(files.reads(), 3) << "with the file's integrator and sampler, with another of each";
}

TEST_F(SharedScenesTest, AFileThatChangesIsReadAgain) {
  KeptSceneFiles files(kMostSharedBytes), none(0);
  const auto long_ago = std::filesystem::file_time_type::clock::now() - std::chrono::hours(1);
  const auto file = folder_ / "s.xml";
  std::filesystem::last_write_time(file, long_ago);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(files.load(scene()));
    ASSERT_TRUE(none.load(scene()));
  }
  EXPECT_EQ(files.reads(), 1);
  EXPECT_EQ(none.reads(), 3);
  std::filesystem::last_write_time(file, long_ago + std::chrono::seconds(1));
  ASSERT_TRUE(files.load(scene()));
  EXPECT_EQ(files.reads(), 2);
  // Its time does not tell whether it was written after it was read.
  std::filesystem::last_write_time(file, std::filesystem::file_time_type::clock::now());
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(files.load(scene()));
  EXPECT_EQ(files.reads(), 4);
  std::filesystem::remove(file);
  EXPECT_FALSE(files.load(scene()));
}

TEST_F(SharedScenesTest, NoMoreIsKeptThanThereIsRoomFor) {
  const std::vector<SceneOptions> first = matrix(scene()), second = matrix(scene("t.xml"));
  std::vector<SceneOptions> renders;
  for (std::size_t i = 0; i < first.size(); ++i) renders.insert(renders.end(), {first[i], second[i]});
  const std::uint64_t bytes = load_scene(scene())->device.words.size() * sizeof(std::uint32_t);
  SharedScenes one = shared(renders, bytes), none = shared(renders, bytes - 1);
  for (const SceneOptions& render : renders) {
    ASSERT_TRUE(one.load(render));
    ASSERT_TRUE(none.load(render));
    EXPECT_LE(one.kept_bytes(), bytes);
    EXPECT_EQ(none.kept_bytes(), 0u);
  }
  EXPECT_EQ(one.reads(), 1 + int(second.size())) << "the first of them stays";
  EXPECT_EQ(none.reads(), int(renders.size()));
}

TEST_F(SharedScenesTest, AnErrorIsEachRendersOwn) {
  const std::vector<SceneOptions> renders = matrix(scene("u.xml"));
  SharedScenes scenes = shared(renders);
  EXPECT_FALSE(scenes.load(renders[0]));
  EXPECT_FALSE(scenes.load(renders[1]));
  write_small_scene(folder_ / "u.xml");
  EXPECT_TRUE(scenes.load(renders[2])) << "somebody put it there";
  EXPECT_TRUE(scenes.load(renders[3]));
  EXPECT_EQ(scenes.reads(), 3);
}

}  // namespace
}  // namespace penumbra
