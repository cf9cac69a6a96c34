// What a script may tell the window to do, one command a line. Parsed as a whole before anything runs.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gl/actions.h"
#include "kernels/host/error.h"

namespace penumbra {

// Every command has the number of its line, counted from 1, for messages while it runs.

/// `key NAME [times]`
struct KeyCommand {
  int line = 0;
  Action action = Action::kQuit;
  int times = 1;  ///< at least 1
};

/// `camera eye X Y Z at X Y Z [up X Y Z]`, in the scene's units. Eye and target are different points, `up` is
/// neither 0 nor along the view.
struct CameraCommand {
  int line = 0;
  glm::dvec3 eye{0}, at{0};
  std::optional<glm::dvec3> up = {};  ///< nothing: the present one
};

enum class WaitFor {
  kSamples,    ///< every pixel of the present view has so many samples
  kAnalytic,   ///< so many frames of the closed form of the present view have been drawn
  kFinished,   ///< all samples that were asked for are there
  kConnected,  ///< the scheduler has answered
};

/// `wait samples N | analytic [FRAMES] | finished | connected [timeout SECONDS]`
struct WaitCommand {
  int line = 0;
  WaitFor what = WaitFor::kFinished;
  std::uint32_t samples = 0;                   ///< kSamples, kAnalytic: how many, at least 1
  std::optional<double> timeout_seconds = {};  ///< greater than 0; nothing: the script runner decides
};

/// `set alpha V`
struct SetAlphaCommand {
  int line = 0;
  double alpha = 1;
};

/// `set exposure V`, in stops
struct SetExposureCommand {
  int line = 0;
  double exposure = 0;
};

/// `resize W H`: the window's picture, in pixels
struct ResizeCommand {
  int line = 0;
  int width = 0, height = 0;
};

/// `screenshot FILE.png`: what the window shows, panel included
struct ScreenshotCommand {
  int line = 0;
  std::string path;  ///< as it was written
};

enum class SaveFormat { kExr, kPng };

/// `save FILE.exr|FILE.png`: the render
struct SaveCommand {
  int line = 0;
  SaveFormat format = SaveFormat::kExr;
  std::string path;
};

/// `log TEXT`
struct LogCommand {
  int line = 0;
  std::string text;
};

/// `quit`. A script without one ends where its text ends.
struct QuitCommand {
  int line = 0;
};

using ScriptCommand =
    std::variant<KeyCommand, CameraCommand, WaitCommand, SetAlphaCommand, SetExposureCommand, ResizeCommand,
                 ScreenshotCommand, SaveCommand, LogCommand, QuitCommand>;

int line_of(const ScriptCommand& command);

/// The commands of a script. Words are separated by blanks; one with blanks in it stands in double quotes,
/// which nothing escapes. A '#' at the start of a word begins a comment, an empty line does nothing.
/// `file_name` is for messages. Errors: all that is wrong, as `file:line:column: error: …`.
Expected<std::vector<ScriptCommand>> parse_script(std::string_view text, std::string_view file_name);

}  // namespace penumbra
