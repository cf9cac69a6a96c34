// What the window does: takes what comes from the scheduler, does what people ask for, draws.
#pragma once

#include <chrono>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "gl/analytic_pass.h"
#include "gl/camera_control.h"
#include "gl/composite_pass.h"
#include "gl/film_textures.h"
#include "gl/local_scheduler.h"
#include "gl/overlay.h"
#include "gl/view_model.h"
#include "gl/window.h"
#include "scheduler/keys/client_access.h"
#include "scheduler/watch/watch_client.h"

namespace penumbra {

/// Frames of the closed form that are averaged while the camera stands still.
constexpr int kAnalyticFrames = 64;

class Viewer {
 public:
  /// Watches the scheduler at `address`; `local`, which may be null, is the process behind it, that is
  /// started again when it ends.
  static Expected<std::unique_ptr<Viewer>> create(Window& window, const std::string& address,
                                                  const ClientAccess& access, JobId job,
                                                  LocalScheduler* local);

  /// Takes what has come since the last call. Fails when there is nothing more to wait for and nothing to
  /// show.
  Expected<void> update();
  void handle(const WindowEvents& events);
  void act(Action action);
  /// Before anything is there: refines whatever the scene is, until told otherwise.
  void refine_from_the_start() { settings_.automatic = true; }
  void set_pose(const CameraPose& pose);
  void set_alpha(float alpha);
  void set_exposure(float stops) { settings_.exposure = stops; }
  /// One frame, with the panel.
  Expected<void> draw();
  /// The render as it is now, by the file's extension.
  Expected<void> save(const std::filesystem::path& path);

  [[nodiscard]] bool wants_to_quit() const { return quit_; }
  /// Something has changed since the last frame, or there is more to draw.
  [[nodiscard]] bool is_stale() const { return stale_ || refines_closed_form(); }
  [[nodiscard]] const ViewStatus& status() const { return status_; }
  [[nodiscard]] const CameraPose& pose() const { return pose_; }
  /// Of the scene in world space.
  [[nodiscard]] glm::dvec3 center() const { return center_; }
  /// Frames of the closed form of the present view.
  [[nodiscard]] int analytic_frames() const {
    return analytic_ == nullptr || analytic_is_old_ ? 0 : analytic_->frames();
  }
  /// Samples that every pixel of the present view has.
  [[nodiscard]] std::uint32_t least_samples() const;
  /// Samples of the present view that have come, over all pixels.
  [[nodiscard]] std::uint64_t samples_there() const;
  /// Exit code of the local scheduler that ended before anything could be shown.
  [[nodiscard]] std::optional<int> scheduler_exit_code() const { return scheduler_exit_code_; }

 private:
  using Clock = std::chrono::steady_clock;

  Viewer(Window& window, const std::string& address, const ClientAccess& access, JobId job,
         LocalScheduler* local, CompositePass composite);

  Expected<void> on(watch_news::Connected& news);
  Expected<void> on(const watch_news::Said& news);
  Expected<void> on(const watch_news::Lost& news);
  Expected<void> on(const watch_news::Refused& news);
  Expected<void> on(const watch_news::Ended&);
  Expected<void> on(const WatchView& view);
  Expected<void> on(const WatchProgress& progress);
  Expected<void> on(const TileSnapshot& tile);

  Expected<void> look_after_scheduler();
  void want_samples(std::uint32_t spp);
  void refine();
  void show_pose();
  void forget_samples();
  void reload();
  void save_beside_scene();
  void say(std::string text);
  void move_by(double right, double up, double forward);
  Expected<void> draw_closed_form();
  [[nodiscard]] bool refines_closed_form() const;
  [[nodiscard]] bool can_steer() const { return status_.interactive && header_.has_value(); }
  [[nodiscard]] AnalyticTextures analytic_textures() const;

  Window& window_;
  LocalScheduler* local_;
  ClientAccess access_;
  std::unique_ptr<WatchClient> client_;
  CompositePass composite_;
  std::unique_ptr<AnalyticPass> analytic_;
  std::optional<FilmTextures> film_;

  DisplaySettings settings_;
  ViewStatus status_;
  std::optional<WatchedJob> job_;
  std::optional<SceneHeader> header_;  // with the scene's own camera
  std::shared_ptr<const DeviceScene> scene_;
  glm::dvec3 center_{0};
  double extent_ = 1;
  View view_{};
  CameraPose pose_, scene_pose_;
  bool moved_ = false;  // the pose is not the scene's
  bool analytic_is_old_ = true;

  std::optional<Clock::time_point> asked_;  // for samples of which no tile has come
  std::uint32_t asked_spp_ = 0;
  std::uint32_t requested_spp_ = 0;  // samples per pixel of the present view that this window requested
  int starts_without_success_ = 0;
  bool has_had_workers_ = false;
  std::optional<int> scheduler_exit_code_;
  Clock::time_point second_began_ = Clock::now();
  int frames_this_second_ = 0;
  bool stale_ = true, quit_ = false;
};

}  // namespace penumbra
