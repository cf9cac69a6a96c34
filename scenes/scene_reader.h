// The entry point of the readers: reads a scene file of any supported format.
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
  /// -D name=value: the value of `$name`. It overrides the file's <default>. A variable that the scene does
  /// not use is an error.
  std::vector<std::pair<std::string, std::string>> defines = {};
  /// Variables such as $frame and $time: like `defines`, which come before them, but they need not be used.
  std::vector<std::pair<std::string, std::string>> variables = {};
  /// --set key=value (see settings.h), applied after the scene file.
  std::vector<std::pair<std::string, std::string>> settings = {};
  /// Render whatever can be parsed. Whatever is unknown, missing or out of range becomes a warning; it is
  /// left out or replaced by a visible placeholder.
  bool lenient = false;
  /// Treat every warning as an error.
  bool strict = false;
  /// For formats with dialects: "nori" or "nori-eth". Empty: determined from the file.
  std::string dialect = {};
  /// Seconds, for a scene that moves. Nothing: the time that the scene's format has for a still, with a
  /// warning unless the file's shutter is open for a time.
  std::optional<double> time = {};
  double frame_duration = 1.0 / kFramesPerSecond;  ///< from one frame to the next, in seconds
  /// For formats with several animations in a file: the name of the one that is shown. Empty: the first.
  std::string clip = {};
  /// For untrusted scenes: every file must lie inside this folder after following symbolic links.
  std::optional<std::filesystem::path> confine_to = std::nullopt;
};

/// The supported formats as text for users: "Mitsuba XML (.xml)".
std::vector<std::string> scene_formats();

/// Reads a scene. The format is determined by the file's name, else by its first character. A scene without
/// shapes or without emitters is valid but gets a warning. Errors: everything that is wrong, each with file,
/// line, column, the source line and a caret.
Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options);

/// Takes a scene that was read with these options to another time; see set_time.
Expected<void> set_time(SceneDescription& scene, double time, const ReadOptions& options);

/// Checks that the file exists and may be read, as read_scene would.
Expected<void> check_scene_file(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace penumbra
