// The user's requests to a Viewer: samples, cameras, files.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <numbers>

#include "gl/viewer.h"
#include "scheduler/files/quoting.h"

namespace penumbra {
namespace {

// How far automatic refinement requests samples ahead of those that have arrived: enough that workers never
// wait, and little enough that it stops quickly.
constexpr double kSecondsAhead = 0.3;
constexpr double kLeastSppAhead = 2, kMostSppAhead = 256;
constexpr double kSecondsToRest = 0.25;
constexpr double kOrbitStep = std::numbers::pi / 36, kDollyStep = 0.9;
constexpr const char* kNoFurtherSamples =
    "warning: this render takes the samples that it was asked for, and no others";
constexpr float kAlphaStep = 0.1f, kExposureStep = 0.25f;
constexpr double kRadiansPerHeight = std::numbers::pi;  // of a drag as long as the window is high

constexpr double kZoomStep = 1.41421356237309505;  // per key press and notch of the wheel

ToneOperator next(ToneOperator tone_map) {
  return ToneOperator((std::size_t(tone_map) + 1) % kToneOperatorNames.size());
}

/// Changes how the picture is shown, without new samples. Returns whether the action does that.
bool change_display(Action action, bool has_closed_form, DisplaySettings& settings) {
  switch (action) {
    case Action::kShowComposite:
      settings.layer = Layer::kComposite;
      return true;
    case Action::kShowAnalytic:
      if (has_closed_form) settings.layer = Layer::kAnalytic;
      return true;
    case Action::kShowDifference:
      if (has_closed_form) settings.layer = Layer::kDifference;
      return true;
    case Action::kShowError:
      settings.layer = Layer::kError;
      return true;
    case Action::kToggleDenoising:
      settings.denoise = !settings.denoise;
      return true;
    case Action::kToggleOutlines:
      settings.outlines = !settings.outlines;
      return true;
    case Action::kBrighter:
      settings.exposure += kExposureStep;
      return true;
    case Action::kDarker:
      settings.exposure -= kExposureStep;
      return true;
    case Action::kNextToneMap:
      settings.tone_map = next(settings.tone_map);
      return true;
    case Action::kToggleFalseColor:
      settings.false_color = !settings.false_color;
      return true;
    case Action::kFit:
      settings.view = {};
      return true;
    case Action::kTogglePanel:
      settings.panel = !settings.panel;
      return true;
    case Action::kToggleHelp:
      settings.help = !settings.help;
      return true;
    default:
      return false;
  }
}

/// The pose after an action that moves the camera by one step. `side` is 1, or -1 for mirrored films.
std::optional<CameraPose> step_camera(Action action, const CameraPose& pose, double step, double side) {
  switch (action) {
    case Action::kForward:
      return move(pose, 0, 0, step);
    case Action::kBack:
      return move(pose, 0, 0, -step);
    case Action::kLeft:
      return move(pose, -side * step, 0, 0);
    case Action::kRight:
      return move(pose, side * step, 0, 0);
    case Action::kUp:
      return move(pose, 0, step, 0);
    case Action::kDown:
      return move(pose, 0, -step, 0);
    case Action::kOrbitLeft:
      return orbit(pose, -side * kOrbitStep, 0);
    case Action::kOrbitRight:
      return orbit(pose, side * kOrbitStep, 0);
    case Action::kOrbitUp:
      return orbit(pose, 0, kOrbitStep);
    case Action::kOrbitDown:
      return orbit(pose, 0, -kOrbitStep);
    case Action::kCloser:
      return dolly(pose, kDollyStep);
    case Action::kFarther:
      return dolly(pose, 1 / kDollyStep);
    default:
      return std::nullopt;
  }
}

}  // namespace

void Viewer::want_samples(std::uint32_t spp) {
  spp = std::min(spp, job_->spp);
  if (spp <= status_.spp_wanted) return;
  status_.spp_wanted = requested_spp_ = spp;
  status_.finished = false;
  if (!asked_) {
    asked_ = Clock::now();
    asked_spp_ = spp;
  }
  client_->want_samples(spp);
}

void Viewer::refine() {
  if (!settings_.automatic || !can_steer() || status_.connection != ConnectionState::kConnected) return;
  const double pixels = double(job_->width) * double(job_->height);
  const double ahead = std::clamp(std::ceil(kSecondsAhead * status_.samples_per_second / pixels),
                                  kLeastSppAhead, kMostSppAhead);
  want_samples(status_.spp_done + std::uint32_t(ahead));
}

void Viewer::set_pose(const CameraPose& pose, bool steering) {
  if (!can_steer()) {
    say("warning: the camera of this render cannot be moved");
    return;
  }
  pose_ = pose;
  moved_ = true;
  const bool moves = (header_->features & FEATURE_MOTION) != 0u;
  steered_ = steering && moves ? std::optional(Clock::now()) : std::nullopt;
  show_pose();
}

void Viewer::blur_at_rest() {
  if (!steered_ || seconds_since(*steered_) < kSecondsToRest || !can_steer()) return;
  steered_.reset();
  show_pose();
}

void Viewer::set_alpha(float alpha) {
  if (job_ && !can_steer()) {
    settings_.alpha = view_.adjustable.alpha;  // the alpha of the tiles
    say("warning: alpha of this render cannot be changed");
    return;
  }
  settings_.alpha = alpha;
  if (can_steer() && status_.hybrid) show_pose();
}

/// Requests the view of the current pose and alpha, and discards the previous one.
void Viewer::show_pose() {
  SceneHeader header = *header_;
  if (moved_) set_camera(pose_, header);
  view_.camera = header.camera;
  view_.adjustable.alpha = settings_.alpha;
  view_.adjustable.frozen = steered_ ? 1.0f : 0.0f;
  client_->change_view(view_);
  forget_samples();
}

void Viewer::forget_samples() {
  film_->clear(0);
  layers_.layers.clear();
  ++denoised_view_;
  analytic_is_old_ = true;
  asked_.reset();
  status_.spp_done = status_.spp_wanted = requested_spp_ = 0;
  status_.samples_done = status_.samples_total = 0;
  status_.finished = false;
  status_.relative_error = std::numeric_limits<double>::quiet_NaN();
  stale_ = true;
}

void Viewer::handle(const WindowEvents& events) {
  stale_ |= events.pointer_moved;
  if (!events.any()) return;
  stale_ = true;
  for (const Action action : events.actions) act(action);
  if (events.close) quit_ = true;
  const std::array<double, 2> pointer = window_.pointer().value_or(std::array{0.0, 0.0});
  // What moves the camera moves the picture where there is none.
  const bool steers = can_steer();
  const double notches = events.zoom + (steers ? 0 : events.wheel);
  if (notches != 0) zoom(std::pow(kZoomStep, notches), pointer[0], pointer[1]);
  const double x = events.picture_x + (steers ? 0 : events.orbit_x + events.pan_x);
  const double y = events.picture_y + (steers ? 0 : events.orbit_y + events.pan_y);
  if ((x != 0 || y != 0) && film_)
    settings_.view = panned(settings_.view, picture_area_, film_->width(), film_->height(), x, y);
  if (!steers) return;
  const double side = film_is_mirrored(*header_) ? -1 : 1;
  const double per_pixel = 1.0 / std::max(window_.height(), 1);
  if (events.orbit_x != 0 || events.orbit_y != 0)
    set_pose(orbit(pose_, -side * events.orbit_x * per_pixel * kRadiansPerHeight,
                   events.orbit_y * per_pixel * kRadiansPerHeight),
             true);
  if (events.pan_x != 0 || events.pan_y != 0) {
    // The target follows the mouse.
    const double distance = glm::length(pose_.at - pose_.eye);
    const double height = 2 * double(length3(header_->camera.y)) * distance * per_pixel;
    set_pose(move(pose_, -side * events.pan_x * height, events.pan_y * height, 0), true);
  }
  if (events.wheel != 0) set_pose(dolly(pose_, std::pow(kDollyStep, events.wheel)), true);
}

void Viewer::act(Action action) {
  stale_ = true;
  if (change_display(action, status_.hybrid, settings_) || act_on_shot(action)) return;
  const double side = header_ && film_is_mirrored(*header_) ? -1 : 1;
  if (const auto pose = step_camera(action, pose_, step_length(pose_, extent_), side))
    return set_pose(*pose, true);
  const std::array<double, 2> middle{picture_area_.x + 0.5 * picture_area_.width,
                                     picture_area_.y + 0.5 * picture_area_.height};
  switch (action) {
    case Action::kOneMoreSample:
      return take_one_more_sample();
    case Action::kToggleAutomatic:
      return toggle_automatic();
    case Action::kAlphaUp:
      return set_alpha(settings_.alpha + kAlphaStep);
    case Action::kAlphaDown:
      return set_alpha(settings_.alpha - kAlphaStep);
    case Action::kResetCamera:
      return reset_camera();
    case Action::kReload:
      return reload();
    case Action::kSave:
      return save_view();
    case Action::kCopyView:
      if (const auto copied = copy_view(CameraFormat::kSettings); !copied)
        say("warning: " + copied.error().message);
      return;
    case Action::kNextLayer:
      return next_layer();
    case Action::kZoomIn:
    case Action::kZoomOut:
      return zoom(action == Action::kZoomIn ? kZoomStep : 1 / kZoomStep, middle[0], middle[1]);
    case Action::kActualSize:
      if (film_)
        zoom(1 / shown_zoom(settings_.view, picture_area_, film_->width(), film_->height()), middle[0],
             middle[1]);
      return;
    case Action::kKeepReference:
      return keep_reference();
    case Action::kToggleReference:
      return compare(settings_.comparison == ShownComparison::kReference ? ShownComparison::kNone
                                                                         : ShownComparison::kReference);
    case Action::kNextComparison:
      return next_comparison();
    case Action::kClose:
      return close_what_is_open();
    case Action::kQuit:
      quit_ = true;
      return;
    default:
      return;
  }
}

void Viewer::take_one_more_sample() {
  if (!job_)
    ++samples_before_connection_;
  else if (can_steer())
    want_samples(status_.spp_wanted + 1);
  else
    say(kNoFurtherSamples);
}

void Viewer::toggle_automatic() {
  settings_.automatic = !settings_.automatic && can_steer();
  if (job_ && !can_steer()) say(kNoFurtherSamples);
}

void Viewer::reset_camera() {
  if (!can_steer()) return;
  pose_ = scene_pose_;
  moved_ = false;
  steered_.reset();
  show_pose();
}

void Viewer::reload() {
  if (client_ == nullptr) {
    const Expected<void> read = read_file();
    return say(read ? "read the file again" : "error: " + read.error().message);
  }
  if (local_ == nullptr) {
    say("warning: the scene belongs to the scheduler, which was not started from here: it cannot be "
        "reloaded");
    return;
  }
  say("reading the scene again");
  status_.connection = ConnectionState::kStarting;
  starts_without_success_ = 0;
  // A new client, which cannot have talked to the scheduler that has ended.
  client_.reset();
  if (const Expected<void> started = local_->restart(); !started) say("error: " + started.error().message);
  connect(0);
}

// --- What is kept of a view

std::string Viewer::repeat_command() const {
  if (!job_ || job_->command.empty()) return "";
  std::string command = job_->command;
  const auto set = [&command](const std::string& value) { command += " --set " + shell_quoted(value); };
  if (moved_) set(camera_text(view_.camera, center_, distance_to_target(), CameraFormat::kSettings));
  if (status_.hybrid) set(fmt::format("integrator.alpha={}", settings_.alpha));
  if (const std::uint32_t spp = least_samples(); status_.interactive && spp > 0 && spp < job_->spp)
    command += fmt::format(" --stop-after {}", spp);
  return command;
}

double Viewer::distance_to_target() const { return glm::length(pose_.at - pose_.eye); }

void Viewer::add_camera(std::vector<std::pair<std::string, MetadataValue>>& metadata) const {
  if (header_) {
    const std::string text =
        camera_text(view_.camera, center_, distance_to_target(), CameraFormat::kSettings);
    const std::size_t equals = text.find('=');
    metadata.emplace_back("penumbra:" + text.substr(0, equals), text.substr(equals + 1));
  }
  const std::string command = repeat_command();
  if (command.empty()) return;
  // A moved camera goes through text, and the closed form was drawn in single precision.
  const PixelRectangle area = rendered_area();
  const std::uint64_t pixels = std::uint64_t(area.width) * std::uint64_t(area.height);
  const bool repeats = !moved_ && !status_.hybrid && samples_there() == least_samples() * pixels;
  metadata.emplace_back(repeats ? "penumbra:command" : "penumbra:nearest_command", command);
}

Expected<std::string> Viewer::copy_view(CameraFormat format) {
  if (!header_) return fail("the window does not know the camera of this picture");
  std::string text = camera_text(view_.camera, center_, distance_to_target(), format);
  if (format == CameraFormat::kSettings) {
    text = "--set " + shell_quoted(text);
    if (status_.hybrid) text += " --set " + shell_quoted(fmt::format("integrator.alpha={}", settings_.alpha));
  }
  window_.set_clipboard(text);
  note(fmt::format("copied: {}", text));
  return text;
}

/// Numbered, so that no file is overwritten.
void Viewer::save_view() {
  if (!film_) return;
  const std::string stem = std::filesystem::path(status_.scene).stem().string();
  const auto name = [&](int number, const char* extension) {
    return fmt::format("{}-view-{:03}.{}", stem.empty() ? "render" : stem, number, extension);
  };
  int number = 1;
  while (std::filesystem::exists(name(number, "exr")) || std::filesystem::exists(name(number, "png")))
    ++number;
  for (const char* extension : {"exr", "png"}) {
    const Expected<void> saved = save(name(number, extension));
    say(saved ? "wrote " + name(number, extension) : "error: " + saved.error().message);
  }
}

// --- The picture's place

void Viewer::zoom(double factor, double x, double y) {
  if (film_)
    settings_.view = zoomed(settings_.view, picture_area_, film_->width(), film_->height(), factor, x, y);
  stale_ = true;
}

void Viewer::close_what_is_open() {
  if (settings_.help)
    settings_.help = false;
  else if (settings_.comparison != ShownComparison::kNone)
    settings_.comparison = ShownComparison::kNone;
  else
    settings_.view = {};
}

}  // namespace penumbra
