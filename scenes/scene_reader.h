// The way in: a scene file of any format that is read, as a scene description.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"

namespace penumbra {

struct ReadOptions {
  /// -D name=value: fills `$name`, and beats the file's <default>. One that the scene has no use for is an
  /// error.
  std::vector<std::pair<std::string, std::string>> defines = {};
  /// --set key=value (see settings.h), applied over what the file says.
  std::vector<std::pair<std::string, std::string>> settings = {};
  /// What can be parsed is rendered: what is not known, not there or out of range becomes a warning, and
  /// something that can be seen in the picture, or is left out.
  bool lenient = false;
  /// Every warning is an error.
  bool strict = false;
  /// Of formats that have dialects: "nori" or "nori-eth". Empty: what the file tells.
  std::string dialect = {};
  /// For scenes from elsewhere: every file must lie inside this folder, symbolic links followed.
  std::optional<std::filesystem::path> confine_to = std::nullopt;
};

/// Those that are read, for people: "Mitsuba XML (.xml)".
std::vector<std::string> scene_formats();

/// Reads a scene; its format is told by the file's name, else by its first character. Errors: everything
/// wrong with it, each with file, line, column, the source line and a caret. A scene without shapes or
/// without light is one, with a warning.
Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options);

/// Whether the file is there and may be looked at, as read_scene would find out.
Expected<void> check_scene_file(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace penumbra
