// Runs a script: each command starts when the previous one is done.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "gl/script.h"
#include "gl/viewer.h"

namespace penumbra {

class ScriptRunner {
 public:
  static constexpr double kUsualPatience = 120;  ///< seconds

  /// `file_name` is for messages.
  ScriptRunner(std::vector<ScriptCommand> commands, std::string file_name)
      : commands_(std::move(commands)), file_name_(std::move(file_name)) {}

  /// To be called between frames. Runs what can run now. Errors start with `file:line: error: …`: a wait that
  /// timed out, or a file that cannot be written.
  Expected<void> step(Viewer& viewer, Window& window);
  [[nodiscard]] bool is_done() const { return next_ == commands_.size(); }
  /// Whether it waits for another frame to be drawn.
  [[nodiscard]] bool wants_frame() const { return wants_frame_; }

 private:
  using Clock = std::chrono::steady_clock;

  // Each returns whether it is done, or must be called again after another frame.
  Expected<bool> run(const KeyCommand& command);
  Expected<bool> run(const CameraCommand& command);
  Expected<bool> run(const WaitCommand& command);
  Expected<bool> run(const SetAlphaCommand& command);
  Expected<bool> run(const SetExposureCommand& command);
  Expected<bool> run(const LayerCommand& command);
  Expected<bool> run(const ReferenceCommand& command);
  Expected<bool> run(const CompareCommand& command);
  Expected<bool> run(const ZoomCommand& command);
  Expected<bool> run(const PointCommand& command);
  Expected<bool> run(const CopyCommand& command);
  Expected<bool> run(const ResizeCommand& command);
  Expected<bool> run(const ScreenshotCommand& command);
  Expected<bool> run(const SaveCommand& command);
  Expected<bool> run(const LogCommand& command);
  Expected<bool> run(const QuitCommand& command);
  Expected<bool> run(const TimeoutCommand& command);
  Expected<bool> run(const FrameCommand& command);
  Expected<bool> run(const PlayCommand& command);
  [[nodiscard]] bool is_there(const WaitCommand& command) const;

  std::vector<ScriptCommand> commands_;
  std::string file_name_;
  std::size_t next_ = 0;
  Clock::time_point since_ = Clock::now();  // when the current command was first tried
  double patience_ = kUsualPatience;        // seconds, for a wait without a timeout
  int tries_ = 0;                           // of the current command
  bool wants_frame_ = false;
  Viewer* viewer_ = nullptr;
  Window* window_ = nullptr;
};

/// Writes what the window shows as a PNG file.
Expected<void> write_screenshot(const Window& window, const std::string& path);

}  // namespace penumbra
