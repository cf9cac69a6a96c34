// Every scene in tests/scenes/bad gives the error that its first line announces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "scenes/scene_reader.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path kFolder = std::filesystem::path(PENUMBRA_SOURCE_DIR) / "tests/scenes/bad";

/// What announces the error, before and after it.
std::pair<std::string, std::string> announcement(const std::filesystem::path& scene) {
  if (scene.extension() == ".toml") return {"# error: ", "\n"};
  return {"<!-- error: ", " -->\n"};
}

std::vector<std::string> bad_scenes() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    const std::filesystem::path extension = entry.path().extension();
    if (extension == ".xml" || extension == ".toml") names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class BadScene : public ::testing::TestWithParam<std::string> {};

TEST_P(BadScene, IsAClearError) {
  const std::filesystem::path file = kFolder / GetParam();
  const std::string text = file_contents(file);
  const auto [opening, closing] = announcement(file);
  ASSERT_TRUE(text.starts_with(opening));
  const std::string expected = text.substr(opening.size(), text.find(closing) - opening.size());
  const auto scene = read_scene(file, {.confine_to = kFolder});
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().message, HasSubstr(expected));
  EXPECT_THAT(scene.error().message, HasSubstr(kFolder.string())) << "the message does not say where";
  EXPECT_LT(scene.error().message.size(), 20000u);
  // What can be rendered all the same has a warning.
  const auto lenient = read_scene(file, {.lenient = true, .confine_to = kFolder});
  if (lenient)
    EXPECT_FALSE(lenient->warnings.empty());
  else
    EXPECT_THAT(lenient.error().message, HasSubstr(expected));
}

INSTANTIATE_TEST_SUITE_P(All, BadScene, ::testing::ValuesIn(bad_scenes()), [](const auto& scene) {
  std::string name = scene.param;
  for (const char separator : {'-', '.'}) std::replace(name.begin(), name.end(), separator, '_');
  return name;
});

}  // namespace
}  // namespace penumbra
