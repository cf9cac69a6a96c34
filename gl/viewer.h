// The viewer: processes news from the scheduler and the user's actions, and draws.
#pragma once

#include <chrono>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "gl/analytic_pass.h"
#include "gl/camera_control.h"
#include "gl/camera_text.h"
#include "gl/composite_pass.h"
#include "gl/denoised_picture.h"
#include "gl/film_textures.h"
#include "gl/local_scheduler.h"
#include "gl/overlay.h"
#include "gl/picture_layers.h"
#include "gl/shot_player.h"
#include "gl/view_model.h"
#include "gl/window.h"
#include "scheduler/watch/watch_client.h"
#include "worker/keys/client_access.h"

namespace penumbra {

/// Frames of the closed form that are averaged while the camera does not move.
constexpr int kAnalyticFrames = 64;

class Viewer {
 public:
  /// Watches the scheduler at `address`. `local` may be null; else it is that scheduler's process, which is
  /// restarted when it ends.
  static Expected<std::unique_ptr<Viewer>> create(Window& window, const std::string& address,
                                                  const ClientAccess& access, JobId job,
                                                  LocalScheduler* local);

  /// Shows an image file.
  static Expected<std::unique_ptr<Viewer>> show_file(Window& window, const std::filesystem::path& path);

  /// Shows the image files of a shot: a name for FrameFiles. Their frames need not be there yet. Errors: no
  /// such name, no folder.
  static Expected<std::unique_ptr<Viewer>> show_shot(Window& window, const std::string& name,
                                                     const ShotOptions& options);

  /// Reads an image to compare with. Errors: those of read_image.
  Expected<void> open_reference(const std::filesystem::path& path);

  /// Processes what has arrived since the last call. Errors: nothing more can arrive, and there is nothing to
  /// show.
  Expected<void> update();
  void handle(const WindowEvents& events);
  void act(Action action);
  /// To be called before any news: refines any scene automatically.
  void refine_from_the_start() { settings_.automatic = true; }
  /// `steering`: the camera goes on moving soon. Until it rests, what moves is shown as in the middle of the
  /// exposure, without blur.
  void set_pose(const CameraPose& pose, bool steering = false);
  void set_alpha(float alpha);
  void set_exposure(float stops) { settings_.exposure = stops; }
  void set_view(const ImageView& view) { settings_.view = view; }
  void set_panel(bool panel) { settings_.panel = panel; }
  void compare(ShownComparison comparison);
  /// "image", "closed_form", "difference", "standard_error", or a named layer. Errors: there is no such
  /// layer.
  Expected<void> show_layer(const std::string& name);
  /// The camera as text, which is also put into the clipboard. Errors: it is not known.
  Expected<std::string> copy_view(CameraFormat format);
  /// Plays the shot, or stops.
  void play(bool plays);
  /// Errors: what is shown is no shot.
  Expected<void> go_to_frame(int number);
  /// Until the next frame of a shot that plays.
  [[nodiscard]] std::optional<double> seconds_to_next() const;
  /// Draws one frame, with the panel.
  Expected<void> draw();
  /// Saves the current render; the extension decides the format.
  Expected<void> save(const std::filesystem::path& path);

  [[nodiscard]] bool wants_to_quit() const { return quit_; }
  /// Whether something has changed since the last frame, or there is more to draw.
  [[nodiscard]] bool is_stale() const {
    return stale_ || refines_closed_form() || (settings_.denoise && denoised_.has_news());
  }
  [[nodiscard]] const ViewStatus& status() const { return status_; }
  [[nodiscard]] const CameraPose& pose() const { return pose_; }
  /// The scene's centre in world space.
  [[nodiscard]] glm::dvec3 center() const { return center_; }
  /// Frames of the current view's closed form.
  [[nodiscard]] int analytic_frames() const {
    return analytic_ == nullptr || analytic_is_old_ ? 0 : analytic_->frames();
  }
  /// Samples that every pixel of the current view has.
  [[nodiscard]] std::uint32_t least_samples() const;
  /// Whether the picture is denoised with all samples that have arrived.
  [[nodiscard]] bool is_denoised() const {
    return settings_.denoise && film_ && denoised_.shows(denoised_view_, film_->version());
  }
  /// Whether the named layer that is shown has a value for every pixel with samples.
  [[nodiscard]] bool has_shown_layer();
  /// Samples of the current view that have arrived, over all pixels.
  [[nodiscard]] std::uint64_t samples_there() const;
  /// Exit code of the local scheduler, if it ended before anything could be shown.
  [[nodiscard]] std::optional<int> scheduler_exit_code() const { return scheduler_exit_code_; }

 private:
  using Clock = std::chrono::steady_clock;

  Viewer(Window& window, const std::string& address, const ClientAccess& access, JobId job,
         LocalScheduler* local, CompositePass composite);
  Viewer(Window& window, CompositePass composite);
  void connect(JobId job);
  Expected<void> read_file();
  /// Shows the picture of a file, which has more layers where `names` has more.
  Expected<void> show_picture(const LayeredPicture& picture, const std::filesystem::path& file,
                              const std::string& integrator, const std::vector<std::string>& names);
  Expected<void> update_shot();
  Expected<void> show_frame(const std::shared_ptr<const FramePicture>& frame);
  [[nodiscard]] std::vector<std::string> layers_of_shown() const;
  /// Returns whether the action is one of a shot.
  bool act_on_shot(Action action);

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
  void take_one_more_sample();
  void toggle_automatic();
  void reset_camera();
  void show_pose();
  void blur_at_rest();
  void forget_samples();
  void reload();
  void save_view();
  void keep_reference();
  void next_layer();
  void next_comparison();
  void zoom(double factor, double x, double y);
  void close_what_is_open();
  [[nodiscard]] std::string repeat_command() const;
  [[nodiscard]] double distance_to_target() const;
  /// The named layer that is shown, brought up to date; null if another layer is shown.
  const LayeredPicture* shown_layers();
  void take_layers(const TileSnapshot& tile);
  void compare_composed();
  void note_what_is_shown(const PixelRectangle& place, bool shows_histogram);
  void note(std::string text);
  void add_camera(std::vector<std::pair<std::string, MetadataValue>>& metadata) const;
  /// Composes what is shown: layer, denoised picture, comparison.
  Expected<void> compose_shown();
  [[nodiscard]] std::string shown_layer_name() const;
  void look_at_pixel(const PixelRectangle& place);
  /// What the numbers of the picture are, if they are not the layer as it was rendered: "reference",
  /// "difference", "relative error", "denoised"; else empty.
  [[nodiscard]] std::string name_of_shown_values();
  void say(std::string text);
  Expected<void> draw_closed_form();
  /// Replaces the composed picture by the newest denoised one, and has the present one denoised.
  void denoise_composed();
  [[nodiscard]] PixelRectangle rendered_area() const;
  /// The newest denoised values of the rendered area, if the picture is to be denoised.
  [[nodiscard]] std::span<const float> denoised_values();
  [[nodiscard]] bool refines_closed_form() const;
  [[nodiscard]] bool can_steer() const { return status_.interactive && header_.has_value(); }
  [[nodiscard]] AnalyticTextures analytic_textures() const;

  Window& window_;
  std::filesystem::path file_;  // the file that is shown; empty: a render
  LocalScheduler* local_ = nullptr;
  ClientAccess access_;
  std::unique_ptr<WatchClient> client_;        // null: a file is shown
  std::unique_ptr<ShotPlayer> shot_;           // null: no shot is shown
  std::shared_ptr<const FramePicture> frame_;  // of the shot, that which is shown
  CompositePass composite_;
  std::unique_ptr<AnalyticPass> analytic_;
  std::optional<FilmTextures> film_;
  LayeredPicture layers_;                // of the file; of the render, those that have arrived
  std::set<std::string> wanted_layers_;  // requested from the scheduler
  std::optional<LayeredPicture> reference_;
  PixelRectangle picture_area_;                 // of the last frame
  std::optional<Difference> shown_difference_;  // on the panel
  DenoisedPicture denoised_;
  std::uint64_t denoised_view_ = 1;  // incremented whenever the samples are forgotten

  DisplaySettings settings_;
  ViewStatus status_;
  std::optional<WatchedJob> job_;
  WatchProgress last_progress_;
  std::optional<SceneHeader> header_;  // with the scene's own camera
  std::shared_ptr<const DeviceScene> scene_;
  glm::dvec3 center_{0};
  double extent_ = 1;
  View view_{};
  CameraPose pose_, scene_pose_;
  bool moved_ = false;  // the pose differs from the scene's
  bool analytic_is_old_ = true;

  std::optional<Clock::time_point> asked_;  // when samples were requested of which no tile has arrived
  std::uint32_t asked_spp_ = 0;
  std::optional<Clock::time_point> steered_;     // when the camera moved last, until it rests
  std::uint32_t samples_before_connection_ = 0;  // requested when there was none yet
  std::uint32_t requested_spp_ = 0;  // samples per pixel of the current view that this window requested
  int starts_without_success_ = 0;
  bool has_had_workers_ = false;
  std::optional<int> scheduler_exit_code_;
  Clock::time_point second_began_ = Clock::now();
  int frames_this_second_ = 0;
  bool stale_ = true, quit_ = false;
};

}  // namespace penumbra
