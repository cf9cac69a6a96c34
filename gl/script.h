// The commands of a script for the window, one per line. A script is parsed completely before it runs.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gl/actions.h"
#include "gl/camera_text.h"
#include "gl/view_model.h"
#include "kernels/host/error.h"

namespace penumbra {

// Every command stores its line, counted from 1, for messages while it runs.

/// `key NAME [times]`
struct KeyCommand {
  int line = 0;
  Action action = Action::kQuit;
  int times = 1;  ///< at least 1
};

/// `camera eye X Y Z at X Y Z [up X Y Z]`, in scene units. Eye and target differ; `up` is neither 0 nor along
/// the view.
struct CameraCommand {
  int line = 0;
  glm::dvec3 eye{0}, at{0};
  std::optional<glm::dvec3> up = {};  ///< default: the current one
};

enum class WaitFor {
  kSamples,    ///< every pixel of the current view has at least so many samples
  kAnalytic,   ///< so many frames of the current view's closed form have been drawn
  kFinished,   ///< all requested samples have arrived
  kConnected,  ///< the scheduler has answered
  kDenoised,   ///< the picture is denoised with all samples that have arrived
  kLayer,      ///< the named layer that is shown has arrived, for every pixel with samples
  kMessage,    ///< a message of the panel contains a text
  kFrame,      ///< the picture of that frame of the shot is shown
};

/// `wait samples N | analytic [FRAMES] | finished | connected | denoised | layer | message TEXT | frame N
/// [timeout SECONDS]`
struct WaitCommand {
  int line = 0;
  WaitFor what = WaitFor::kFinished;
  std::uint32_t samples = 0;                   ///< kSamples, kAnalytic: the number, at least 1; kFrame
  std::string text = {};                       ///< kMessage
  std::optional<double> timeout_seconds = {};  ///< above 0; default: that of the last TimeoutCommand
};

/// `frame N`: the shot stops at that frame
struct FrameCommand {
  int line = 0;
  int frame = 0;
};

/// `play`, `play off`
struct PlayCommand {
  int line = 0;
  bool plays = true;
};

/// `timeout SECONDS`: how long the waits that follow wait, unless they say it themselves
struct TimeoutCommand {
  int line = 0;
  double seconds = 0;  ///< above 0
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

/// `layer NAME`: image, closed_form, difference, standard_error, or a layer of the render or the file
struct LayerCommand {
  int line = 0;
  std::string name;
};

/// `reference FILE`: reads the image to compare with
struct ReferenceCommand {
  int line = 0;
  std::string path;
};

/// `compare none | reference | difference | relative`
struct CompareCommand {
  int line = 0;
  ShownComparison comparison = ShownComparison::kNone;
};

/// `zoom fit`, or `zoom FACTOR [X Y]`: screen pixels per film pixel, with that film pixel in the middle
struct ZoomCommand {
  int line = 0;
  double factor = 0;  ///< 0: fit
  std::optional<std::array<double, 2>> middle = {};
};

/// `point X Y`: the mouse is at that pixel of the window
struct PointCommand {
  int line = 0;
  double x = 0, y = 0;
};

/// `copy settings | mitsuba | tinyrender`: the camera to the clipboard and to standard output
struct CopyCommand {
  int line = 0;
  CameraFormat format = CameraFormat::kSettings;
};

/// `resize W H`: size of the window's picture, in pixels
struct ResizeCommand {
  int line = 0;
  int width = 0, height = 0;
};

/// `screenshot FILE.png`: the window, including the panel
struct ScreenshotCommand {
  int line = 0;
  std::string path;  ///< as written in the script
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

/// `quit`. A script without it ends after its last line.
struct QuitCommand {
  int line = 0;
};

using ScriptCommand =
    std::variant<KeyCommand, CameraCommand, WaitCommand, SetAlphaCommand, SetExposureCommand, LayerCommand,
                 ReferenceCommand, CompareCommand, ZoomCommand, PointCommand, CopyCommand, ResizeCommand,
                 ScreenshotCommand, SaveCommand, LogCommand, QuitCommand, TimeoutCommand, FrameCommand,
                 PlayCommand>;

int line_of(const ScriptCommand& command);

/// The commands of a script. Words are separated by blanks. A word that contains blanks is in double quotes;
/// there are no escapes. A '#' at the start of a word begins a comment; empty lines are ignored. `file_name`
/// is for messages. Errors: all mistakes, as `file:line:column: error: …`.
Expected<std::vector<ScriptCommand>> parse_script(std::string_view text, std::string_view file_name);

}  // namespace penumbra
