// What a Viewer does with the files of a shot.
#include <fmt/format.h>

#include <algorithm>

#include "gl/viewer.h"
#include "kernels/host/text.h"

namespace penumbra {

Expected<std::unique_ptr<Viewer>> Viewer::show_shot(Window& window, const std::string& name,
                                                    const ShotOptions& options) {
  const auto files = FrameFiles::of(name);
  if (!files) return fail(fmt::format("{}: there is no field for the frame, such as ####", name));
  std::error_code error;
  if (const auto folder = files->folder(); !std::filesystem::is_directory(folder, error))
    return fail(fmt::format("{}: there is no folder {}", name, folder.string()));
  Expected<CompositePass> composite = CompositePass::create();
  if (!composite) return std::unexpected(composite.error());
  std::unique_ptr<Viewer> viewer(new Viewer(window, std::move(*composite)));
  viewer->shot_ = std::make_unique<ShotPlayer>(*files, options, &Window::wake);
  viewer->status_.connection = ConnectionState::kFile;
  viewer->status_.scene = name;
  viewer->status_.shot = viewer->shot_->status();
  const auto has_file = [](const ShotFrame& frame) { return frame.has_file; };
  if (std::ranges::none_of(viewer->status_.shot->frames, has_file))
    viewer->say(fmt::format("no frame of {} is there yet; waiting for the first", name));
  return viewer;
}

Expected<void> Viewer::update_shot() {
  shot_->set_layers(layers_of_shown());
  if (const auto picture = shot_->update(ShotPlayer::Clock::now())) {
    if (Expected<void> shown = show_frame(picture); !shown) return shown;
  }
  if (!shot_->take_change()) return {};
  const bool skipped_before = status_.shot && status_.shot->skipped > 0;
  status_.shot = shot_->status();
  if (status_.shot->skipped > 0 && !skipped_before)
    note("warning: frames are read and shown more slowly than they play: some are left out");
  stale_ = true;
  return {};
}

/// The layers without which what is shown would change.
std::vector<std::string> Viewer::layers_of_shown() const {
  std::vector<std::string> layers{std::string(kImageLayer)};
  if (settings_.layer == Layer::kNamed) layers.push_back(settings_.named);
  if (settings_.layer == Layer::kError || settings_.denoise)
    layers.insert(layers.end(), {"samples", "variance"});
  return layers;
}

Expected<void> Viewer::show_frame(const std::shared_ptr<const FramePicture>& frame) {
  const std::filesystem::path file = shot_->file(*shot_->status().shown);
  if (!frame->error.empty()) {
    say(fmt::format("warning: {}", frame->error));
    return {};
  }
  if (Expected<void> shown = show_picture(frame->picture, file, frame->integrator, frame->layer_names);
      !shown) {
    say("warning: " + shown.error().message);
    return {};
  }
  frame_ = frame;
  return {};
}

bool Viewer::act_on_shot(Action action) {
  if (shot_ == nullptr) return false;
  switch (action) {
    case Action::kOneMoreSample:
      play(!shot_->status().plays);
      return true;
    case Action::kOrbitLeft:
      shot_->step(-1);
      return true;
    case Action::kOrbitRight:
      shot_->step(1);
      return true;
    case Action::kResetCamera:
      shot_->go_to_first();
      return true;
    case Action::kLastFrame:
      shot_->go_to_last();
      return true;
    case Action::kReload:
      shot_->reload();
      return true;
    default:
      return false;
  }
}

void Viewer::play(bool plays) {
  if (shot_ != nullptr) shot_->play(plays, ShotPlayer::Clock::now());
}

Expected<void> Viewer::go_to_frame(int number) {
  if (shot_ == nullptr) return fail("what is shown is no shot: name its files as in 'shot.####.exr'");
  shot_->go_to(number);
  stale_ = true;
  return {};
}

std::optional<double> Viewer::seconds_to_next() const {
  return shot_ == nullptr ? std::nullopt : shot_->seconds_to_next(ShotPlayer::Clock::now());
}

}  // namespace penumbra
