#include "gl/script_runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "gl/picture_files.h"
#include "kernels/host/console.h"
#include "kernels/host/process.h"
#include "kernels/host/text.h"

namespace penumbra {
namespace {

constexpr double kPatienceWithDesktop = 1;  // seconds, for a new size

const char* name_of(WaitFor what) {
  switch (what) {
    case WaitFor::kSamples:
      return "samples";
    case WaitFor::kAnalytic:
      return "the closed form";
    case WaitFor::kFinished:
      return "the end of what was asked for";
    case WaitFor::kConnected:
      return "the scheduler";
    case WaitFor::kDenoised:
      return "the denoised picture";
    case WaitFor::kLayer:
      return "the layer";
    case WaitFor::kMessage:
      return "the message";
    case WaitFor::kFrame:
      return "the frame";
  }
  return "";
}

}  // namespace

Expected<void> ScriptRunner::step(Viewer& viewer, Window& window) {
  viewer_ = &viewer;
  window_ = &window;
  while (!is_done() && !viewer.wants_to_quit()) {
    const ScriptCommand& command = commands_[next_];
    if (tries_++ == 0) since_ = Clock::now();
    const Expected<bool> done = std::visit([this](const auto& c) { return run(c); }, command);
    if (!done && line_of(command) == 0) return std::unexpected(done.error());
    if (!done)
      return fail(fmt::format("{}:{}: error: {}", file_name_, line_of(command), done.error().message));
    if (!*done) return {};
    ++next_;
    tries_ = 0;
  }
  return {};
}

Expected<bool> ScriptRunner::run(const KeyCommand& command) {
  for (int i = 0; i < command.times; ++i) viewer_->act(command.action);
  return true;
}

Expected<bool> ScriptRunner::run(const CameraCommand& command) {
  const glm::dvec3 center = viewer_->center();
  viewer_->set_pose({command.eye - center, command.at - center, command.up.value_or(viewer_->pose().up)});
  return true;
}

bool ScriptRunner::is_there(const WaitCommand& command) const {
  const ViewStatus& status = viewer_->status();
  switch (command.what) {
    case WaitFor::kSamples:
      return viewer_->least_samples() >= command.samples;
    case WaitFor::kAnalytic:
      return viewer_->analytic_frames() >= int(command.samples);
    case WaitFor::kFinished:
      // With a time budget, some tiles may have one pass more than others.
      return status.finished && viewer_->least_samples() >= status.spp_wanted &&
             viewer_->samples_there() >= status.samples_total;
    case WaitFor::kConnected:
      return status.connection == ConnectionState::kConnected ||
             status.connection == ConnectionState::kEnded || status.connection == ConnectionState::kFile;
    case WaitFor::kDenoised:
      return viewer_->is_denoised();
    case WaitFor::kLayer:
      return viewer_->has_shown_layer();
    case WaitFor::kMessage:
      return std::ranges::any_of(status.messages, [&](const std::string& message) {
        return message.find(command.text) != std::string::npos;
      });
    case WaitFor::kFrame:
      return status.shot && status.shot->shown == int(command.samples);
  }
  return false;
}

Expected<bool> ScriptRunner::run(const WaitCommand& command) {
  if (is_there(command)) return true;
  if (viewer_->status().connection == ConnectionState::kEnded && command.what != WaitFor::kAnalytic &&
      command.what != WaitFor::kDenoised && command.what != WaitFor::kMessage)
    return fail(fmt::format("the render is over, with {} of every pixel",
                            counted(viewer_->least_samples(), "sample")));
  const double waited = seconds_since(since_);
  const double patience = command.timeout_seconds.value_or(patience_);
  if (waited < patience) return false;
  return fail(fmt::format("waited {} s for {}; reached: {} of every pixel, {} of the closed form", patience,
                          name_of(command.what), counted(viewer_->least_samples(), "sample"),
                          counted(viewer_->analytic_frames(), "frame")));
}

Expected<bool> ScriptRunner::run(const TimeoutCommand& command) {
  patience_ = command.seconds;
  return true;
}

Expected<bool> ScriptRunner::run(const FrameCommand& command) {
  if (const Expected<void> gone = viewer_->go_to_frame(command.frame); !gone)
    return std::unexpected(gone.error());
  return true;
}

Expected<bool> ScriptRunner::run(const PlayCommand& command) {
  if (!viewer_->status().shot) return fail("what is shown is no shot");
  viewer_->play(command.plays);
  return true;
}

Expected<bool> ScriptRunner::run(const SetAlphaCommand& command) {
  viewer_->set_alpha(float(command.alpha));
  return true;
}

Expected<bool> ScriptRunner::run(const SetExposureCommand& command) {
  viewer_->set_exposure(float(command.exposure));
  return true;
}

Expected<bool> ScriptRunner::run(const LayerCommand& command) {
  if (Expected<void> shown = viewer_->show_layer(command.name); !shown) return std::unexpected(shown.error());
  return true;
}

Expected<bool> ScriptRunner::run(const ReferenceCommand& command) {
  if (Expected<void> opened = viewer_->open_reference(command.path); !opened)
    return std::unexpected(opened.error());
  return true;
}

Expected<bool> ScriptRunner::run(const CompareCommand& command) {
  viewer_->compare(command.comparison);
  return true;
}

Expected<bool> ScriptRunner::run(const ZoomCommand& command) {
  ImageView view{.zoom = command.factor};
  const ViewStatus& status = viewer_->status();
  if (command.middle && status.film_width > 0 && status.film_height > 0) {
    view.x = ((*command.middle)[0] + 0.5) / status.film_width;
    view.y = ((*command.middle)[1] + 0.5) / status.film_height;
  }
  viewer_->set_view(view);
  return true;
}

Expected<bool> ScriptRunner::run(const PointCommand& command) {
  window_->point_at(command.x, command.y);
  return true;
}

Expected<bool> ScriptRunner::run(const CopyCommand& command) {
  const Expected<std::string> text = viewer_->copy_view(command.format);
  if (!text) return std::unexpected(text.error());
  print_answer(text->ends_with('\n') ? *text : *text + "\n");
  return true;
}

Expected<bool> ScriptRunner::run(const ResizeCommand& command) {
  if (tries_ == 1) {
    if (Expected<void> resized = window_->resize(command.width, command.height); !resized)
      return std::unexpected(resized.error());
  }
  if (window_->width() == command.width && window_->height() == command.height) return true;
  // A desktop needs time to resize, and may choose another size.
  return seconds_since(since_) > kPatienceWithDesktop;
}

/// Shows frames that began after the previous command.
Expected<bool> ScriptRunner::run(const ScreenshotCommand& command) {
  // The panel says in one frame what the picture showed in the last, and ImGui lays some windows out over
  // two.
  constexpr int kFramesToSettle = 3;
  wants_frame_ = tries_ <= kFramesToSettle;
  if (wants_frame_) return false;
  if (Expected<void> written = write_screenshot(*window_, command.path); !written)
    return std::unexpected(written.error());
  return true;
}

Expected<bool> ScriptRunner::run(const SaveCommand& command) {
  if (Expected<void> saved = viewer_->save(command.path); !saved) return std::unexpected(saved.error());
  return true;
}

Expected<bool> ScriptRunner::run(const LogCommand& command) {
  print_answer(command.text + "\n");
  return true;
}

Expected<bool> ScriptRunner::run(const QuitCommand&) {
  viewer_->act(Action::kQuit);
  return true;
}

Expected<void> write_screenshot(const Window& window, const std::string& path) {
  FramePixels frame = window.read_pixels();
  Picture picture;
  picture.width = frame.width;
  picture.height = frame.height;
  picture.display = std::move(frame.rgb);
  return save_picture(path, picture);
}

}  // namespace penumbra
