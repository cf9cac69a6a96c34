// The entry point of the readers: reads a scene file of any supported format.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// A scene that another program has exported to a format that is read here.
struct ExportedScene {
  std::filesystem::path file;         ///< in a folder of its own
  std::vector<std::string> left_out;  ///< what it lacks
  std::optional<double> fps = {};     ///< frames per second
};

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
  std::optional<double> fps = {};  ///< frames per second; nothing: the file's, else kFramesPerSecond
  /// For formats with several animations in a file: the name of the one that is shown. Empty: the first.
  std::string clip = {};
  /// Exports a file of Blender's, at the frame that is asked for. Empty: such files are errors.
  std::function<Expected<ExportedScene>(const std::filesystem::path&)> export_scene = {};
  /// The options of such files alone that are given, as words of the command line. Empty: none.
  std::string export_options = {};
  /// For untrusted scenes: every file must lie inside this folder after following symbolic links.
  std::optional<std::filesystem::path> confine_to = std::nullopt;
};

/// The supported formats as text for users: "Mitsuba XML (.xml)".
std::vector<std::string> scene_formats();

/// Reads a scene. The format is determined by the file's name, else by its first character. A scene without
/// shapes or without emitters is valid but gets a warning. Errors: everything that is wrong, each with file,
/// line, column, the source line and a caret.
Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options);

/// The first part of read_scene: what the file says. Of the settings, readers look only at which of them are
/// given, and at the value of integrator.type. Errors: also of files that another program exports.
Expected<SceneDescription> read_scene_file(const std::filesystem::path& file, const ReadOptions& options);

/// The second part: the time, the settings, warnings.
Expected<void> complete_scene(SceneDescription& scene, const ReadOptions& options);

/// Takes a scene that was read with these options to another time; see set_time.
Expected<void> set_time(SceneDescription& scene, double time, const ReadOptions& options);

/// Whether another program has to export the file, see ReadOptions::export_scene.
bool is_exported_scene(const std::filesystem::path& file);

/// Checks that the file exists and may be read, as read_scene would.
Expected<void> check_scene_file(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace penumbra
