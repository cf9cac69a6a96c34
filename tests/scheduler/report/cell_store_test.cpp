#include "scheduler/report/cell_store.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

const Json kSettings = {{"spp", 4}, {"seed", 7}};

Image small_image() {
  Image image{{1, 2, 2, 1}, {0, 0, 8, 8}, {"R", "G", "B", "variance.R"}, {1, 2, 3, 9, 4, 5, 6, 9}, {}};
  return image;
}

ImageResult some_result() {
  ImageResult result;
  result.seed = 7;
  result.seconds = {0.1, 0.2, 0.3, 0.7};
  result.render_seconds = {0.3, 0.4};
  result.load_before = 0.5;
  result.load_after = 1.5;
  result.film_hash = "0123456789abcdef";
  result.bad_samples = 3;
  return result;
}

TEST(CellStore, GivesBackWhatItWasGiven) {
  const TemporaryFolder folder;
  const auto store = CellStore::open(folder / "cells");
  ASSERT_TRUE(store) << store.error().message;
  const CellId id = make_cell_id("a scene, path/x", kSettings);
  EXPECT_EQ(id.name, "a_scene__path_x");
  EXPECT_FALSE(store->find(id));
  ASSERT_TRUE(store->save(id, small_image(), some_result(), kSettings));
  const auto found = store->find(id);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->seed, 7u);
  EXPECT_EQ(found->seconds.build, 0.1);
  EXPECT_EQ(found->seconds.transfer, 0.2);
  EXPECT_EQ(found->seconds.render, 0.3);
  EXPECT_EQ(found->seconds.total, 0.7);
  EXPECT_EQ(found->render_seconds, (std::vector<double>{0.3, 0.4}));
  EXPECT_EQ(found->load_before, 0.5);
  EXPECT_EQ(found->load_after, 1.5);
  EXPECT_EQ(found->film_hash, "0123456789abcdef");
  EXPECT_EQ(found->bad_samples, 3u);
  const auto image = read_image(found->file);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->data, (PixelWindow{1, 2, 2, 1}));
  EXPECT_EQ(image->values, (std::vector<float>{1, 2, 3, 4, 5, 6})) << "beauty alone";
}

TEST(CellStore, OtherSettingsAreAnotherCell) {
  Json other = kSettings;
  other["seed"] = 8;
  EXPECT_NE(make_cell_id("a", kSettings).key, make_cell_id("a", other).key);
  EXPECT_EQ(make_cell_id("a", kSettings).key, make_cell_id("b", kSettings).key);
}

TEST(CellStore, HalfACellIsNone) {
  const TemporaryFolder folder;
  const auto store = CellStore::open(folder.path());
  const CellId id = make_cell_id("a", kSettings);
  ASSERT_TRUE(store->save(id, small_image(), some_result(), kSettings));
  std::filesystem::path json = store->image_path(id);
  json.replace_extension(".json");
  const std::string text = file_contents(json);
  write_text(json, text.substr(0, text.size() / 2));
  EXPECT_FALSE(store->find(id)) << "JSON that is cut short";
  write_text(json, "{}");
  EXPECT_FALSE(store->find(id)) << "JSON of something else";
  write_text(json, text);
  ASSERT_TRUE(store->find(id));
  std::filesystem::remove(store->image_path(id));
  EXPECT_FALSE(store->find(id)) << "no image";
}

TEST(CellStore, WhatWasChangedIsNotTheCell) {
  const TemporaryFolder folder;
  const auto store = CellStore::open(folder.path());
  const CellId id = make_cell_id("a", kSettings);
  std::string damage;
  EXPECT_FALSE(store->find(id, &damage));
  EXPECT_EQ(damage, "") << "nothing is there";
  ASSERT_TRUE(store->save(id, small_image(), some_result(), kSettings));
  const std::string image = file_contents(store->image_path(id));
  std::string changed = image;
  changed.back() = char(changed.back() ^ 1);
  for (const std::string& bytes : {image.substr(0, image.size() - 1), std::string(), changed}) {
    write_text(store->image_path(id), bytes);
    EXPECT_FALSE(store->find(id, &damage));
    EXPECT_EQ(damage, store->image_path(id).string() + " is not the image that was rendered");
  }
  write_text(store->image_path(id), image);
  EXPECT_TRUE(store->find(id));
  std::filesystem::path json = store->image_path(id);
  json.replace_extension(".json");
  std::string text = file_contents(json);
  text.replace(text.find("\"spp\": 4"), 8, "\"spp\": 8");
  write_text(json, text);
  EXPECT_FALSE(store->find(id, &damage));
  EXPECT_EQ(damage, json.string() + " is of other settings");
}

TEST(CellStore, NeedsAFolderToWriteTo) {
  const TemporaryFolder folder;
  write_text(folder / "file", "");
  EXPECT_FALSE(CellStore::open(folder / "file"));
  EXPECT_FALSE(CellStore::open(folder / "file" / "cells"));
}

}  // namespace
}  // namespace penumbra
