// Scenes written in tests, and read from their own folder.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "scenes/scene_reader.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {

/// The only emitter of its kind.
template <typename Kind>
Kind only(const SceneDescription& scene) {
  std::vector<Kind> found;
  for (const Emitter& emitter : scene.emitters)
    if (const auto* kind = std::get_if<Kind>(&emitter)) found.push_back(*kind);
  EXPECT_EQ(found.size(), 1u);
  return found.empty() ? Kind{} : found.front();
}

class SceneText : public ::testing::Test {
 protected:
  /// A scene around `content`, with a sensor, unless `content` has one.
  static std::string scene(std::string_view content) {
    std::string text = "<scene version=\"3.0.0\">\n";
    text += content;
    if (content.find("<sensor") == content.npos) text += "\n<sensor type=\"perspective\"/>";
    return text + "\n</scene>\n";
  }

  void write(const std::string& name, std::string_view text) { write_text(folder_ / name, text); }

  Expected<SceneDescription> read(std::string_view text, const ReadOptions& options = {}) {
    write("scene.xml", text);
    return read_scene(folder_ / "scene.xml", options);
  }

  /// Of a scene that must be good. That it has no light is no warning: most scenes here need none.
  SceneDescription good(std::string_view content, const ReadOptions& options = {}) {
    return lit(good_of(read(scene(content), options)));
  }
  static SceneDescription good_of(Expected<SceneDescription> result) {
    EXPECT_TRUE(result) << result.error().message;
    return result ? std::move(*result) : SceneDescription{};
  }

  static SceneDescription lit(SceneDescription scene) {
    std::erase_if(scene.warnings, [](const std::string& warning) {
      return warning.ends_with("; the image is black") || warning.ends_with("; only its sky is seen");
    });
    return scene;
  }

  /// The error of a scene that must be bad, the folder's name left out.
  std::string error(std::string_view text, const ReadOptions& options = {}) {
    return error_of(read(text, options), text);
  }
  std::string error_of(const Expected<SceneDescription>& result, std::string_view text) const {
    EXPECT_FALSE(result) << "this scene should be an error:\n" << text;
    return result ? "" : without_folder(result.error().message);
  }

  /// One a line, the folder's name left out.
  std::string warnings(const SceneDescription& scene) const {
    std::string all;
    for (const std::string& warning : scene.warnings) all += warning + "\n";
    return without_folder(all);
  }

  std::string without_folder(std::string message) const {
    const std::string prefix = folder_.path().string() + "/";
    for (std::size_t at = message.find(prefix); at != message.npos; at = message.find(prefix)) {
      message.erase(at, prefix.size());
    }
    return message;
  }

  TemporaryFolder folder_;
};

}  // namespace penumbra
