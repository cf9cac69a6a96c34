#include "gl/viewer.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>
#include <variant>

#include "gl/histogram.h"
#include "gl/overlay_text.h"
#include "gl/picture_files.h"
#include "kernels/host/console.h"
#include "kernels/host/process.h"
#include "worker/cli/exit_code.h"

namespace penumbra {
namespace {

constexpr std::size_t kMessagesKept = 100;
constexpr int kStartsInARow = 3;  // of a scheduler that ends before it has a worker
constexpr std::chrono::seconds kPatienceWithTiles{1};

/// A rectangle of an image of that width.
std::vector<float> cut(std::span<const float> image, int width, std::size_t per_pixel,
                       const PixelRectangle& area) {
  std::vector<float> part;
  for (int y = area.y; y < area.y + area.height; ++y) {
    const std::size_t first = per_pixel * (std::size_t(y) * std::size_t(width) + std::size_t(area.x));
    const std::span<const float> row = image.subspan(first, per_pixel * std::size_t(area.width));
    part.insert(part.end(), row.begin(), row.end());
  }
  return part;
}

bool tells_the_same(const WatchProgress& a, const WatchProgress& b) {
  return a.view == b.view && a.samples_done == b.samples_done && a.samples_wanted == b.samples_wanted &&
         a.spp_done == b.spp_done && a.finished == b.finished && a.ended == b.ended && a.workers == b.workers;
}

}  // namespace

Expected<std::unique_ptr<Viewer>> Viewer::create(Window& window, const std::string& address,
                                                 const ClientAccess& access, JobId job,
                                                 LocalScheduler* local) {
  Expected<CompositePass> composite = CompositePass::create();
  if (!composite) return std::unexpected(composite.error());
  std::unique_ptr<Viewer> viewer(new Viewer(window, std::move(*composite)));
  viewer->local_ = local;
  viewer->access_ = access;
  viewer->status_.address = address;
  viewer->connect(job);
  return viewer;
}

void Viewer::connect(JobId job) {
  client_ = std::make_unique<WatchClient>(status_.address, access_.token, access_.keys, job, &Window::wake,
                                          local_ != nullptr);
}

Viewer::Viewer(Window& window, CompositePass composite) : window_(window), composite_(std::move(composite)) {
  view_.adjustable.alpha = settings_.alpha;
  status_.latency_seconds = status_.seconds_left = status_.relative_error =
      std::numeric_limits<double>::quiet_NaN();
}

// --- News

Expected<void> Viewer::update() {
  if (shot_ != nullptr) return update_shot();
  if (client_ == nullptr) return {};
  for (WatchNews& news : client_->take()) {
    // Progress comes all the time, even where there is none.
    const auto* progress = std::get_if<WatchProgress>(&news);
    stale_ |= progress == nullptr || !tells_the_same(*progress, last_progress_);
    if (progress != nullptr) last_progress_ = *progress;
    if (Expected<void> done = std::visit([this](auto& content) { return on(content); }, news); !done)
      return done;
  }
  if (Expected<void> done = look_after_scheduler(); !done) return done;
  blur_at_rest();
  refine();
  return {};
}

Expected<void> Viewer::on(watch_news::Connected& news) {
  const bool first = !job_, was_hybrid = status_.hybrid;
  const bool has_scenes_alpha =
      !header_ || settings_.alpha == header_->adjustable.alpha;  // alpha is unchanged
  const WatchedJob& job = news.job;
  if (!film_ || film_->width() != job.film_width || film_->height() != job.film_height) {
    Expected<FilmTextures> film = FilmTextures::create(job.film_width, job.film_height);
    if (!film) return std::unexpected(film.error());
    film_.emplace(std::move(*film));
  }
  scene_ = std::move(news.scene);
  header_ = scene_ ? std::optional(scene_->header) : std::nullopt;
  layers_ = {.name = job.title,
             .width = job.film_width,
             .height = job.film_height,
             .area = {0, 0, job.film_width, job.film_height},
             .layers = {}};
  wanted_layers_.clear();
  status_.named_layers = job.layers;
  status_.named_layers.insert(status_.named_layers.end(), {"samples", "variance"});
  analytic_.reset();
  const bool moves = header_ && (header_->features & FEATURE_MOTION) != 0u;
  if (job.hybrid && moves)
    say("the closed form that a window draws is of one instant: what moves is shown by samples alone");
  status_.hybrid = job.hybrid && scene_ != nullptr && !moves;
  if (status_.hybrid) {
    if (auto made = AnalyticPass::create(*scene_)) {
      analytic_ = std::move(*made);
    } else {
      status_.hybrid = false;
      say("warning: the closed form cannot be drawn here: " + made.error().message);
    }
  }
  status_.connection = ConnectionState::kConnected;
  status_.scene = job.title;
  status_.integrator = job.integrator;
  status_.interactive = job.interactive;
  status_.scene_spp = job.scene_spp;
  status_.has_camera = header_.has_value();
  status_.film_width = job.film_width;
  status_.film_height = job.film_height;
  const glm::dvec3 center{job.center[0], job.center[1], job.center[2]};
  // A moved camera keeps its position in the scene, whose centre may have changed.
  pose_.eye += center_ - center;
  pose_.at += center_ - center;
  center_ = center;
  forget_samples();
  if (header_) {
    extent_ = scene_extent(*scene_);
    scene_pose_ = pose_of(*header_, default_distance(*scene_));
    if (!moved_) {
      pose_ = scene_pose_;
      view_ = view_of(*header_);
    }
    if (has_scenes_alpha) settings_.alpha = header_->adjustable.alpha;
  }
  // A scene that was read again may no longer have a closed form.
  if (first || was_hybrid) settings_.automatic |= job.interactive && !status_.hybrid;
  const bool needs_closed_form = settings_.layer == Layer::kAnalytic || settings_.layer == Layer::kDifference;
  if (needs_closed_form && !status_.hybrid) settings_.layer = Layer::kComposite;
  job_ = job;
  if (samples_before_connection_ > 0 && can_steer())
    want_samples(std::exchange(samples_before_connection_, 0));
  // A restarted scheduler shows the scene's own view.
  if (can_steer() && (moved_ || settings_.alpha != header_->adjustable.alpha)) show_pose();
  return {};
}

Expected<void> Viewer::on(const watch_news::Said& news) {
  say(news.text);
  return {};
}

Expected<void> Viewer::on(const watch_news::Lost& news) {
  status_.workers.clear();
  asked_.reset();
  status_.connection = ConnectionState::kLost;
  say(fmt::format("warning: the connection was lost: {}; trying again", news.why));
  return {};
}

Expected<void> Viewer::on(const watch_news::Refused& news) {
  status_.connection = ConnectionState::kRefused;
  say("error: " + news.why);
  if (film_) return {};
  return fail(fmt::format("{}: {}", status_.address, news.why));
}

Expected<void> Viewer::on(const watch_news::Ended&) {
  status_.connection = ConnectionState::kEnded;
  status_.workers.clear();
  return {};
}

Expected<void> Viewer::on(const WatchView& news) {
  // The first view of a connection is that of the scene. For it, and for views that this window requested,
  // samples may already have been requested.
  const bool is_scenes = news.number == 0 && is_same(news.view, view_);
  if (!header_ || is_scenes || client_->is_own(news)) return {};
  view_ = news.view;
  settings_.alpha = view_.adjustable.alpha;
  SceneHeader header = *header_;
  apply_view(view_, header);
  pose_ = pose_of(header, glm::length(pose_.at - pose_.eye));
  moved_ = news.number > 0;
  forget_samples();
  return {};
}

Expected<void> Viewer::on(const WatchProgress& progress) {
  status_.samples_done = progress.samples_done;
  status_.samples_total = progress.samples_wanted;
  status_.spp_done = progress.spp_done;
  // The scheduler may not know this window's last request yet.
  status_.spp_wanted = std::max(progress.spp_wanted, requested_spp_);
  status_.finished = progress.finished && progress.spp_done >= status_.spp_wanted && status_.spp_wanted > 0;
  status_.relative_error = progress.relative_error;
  const double seconds = progress.elapsed_seconds;
  if (seconds > 0) status_.samples_per_second = double(progress.samples_done) / seconds;
  const double rate = status_.samples_per_second;
  status_.seconds_left = rate > 0 && progress.samples_wanted >= progress.samples_done
                             ? double(progress.samples_wanted - progress.samples_done) / rate
                             : std::numeric_limits<double>::quiet_NaN();
  status_.workers.clear();
  if (!progress.workers.empty()) {
    starts_without_success_ = 0;
    has_had_workers_ = true;
  }
  for (const WatchedWorker& worker : progress.workers)
    status_.workers.push_back({.number = worker.number,
                               .name = worker.name,
                               .device = worker.device,
                               .x = worker.x,
                               .y = worker.y,
                               .width = worker.width,
                               .height = worker.height,
                               .units = worker.units});
  return {};
}

Expected<void> Viewer::on(const TileSnapshot& tile) {
  if (!film_ || !film_->apply(tile)) return {};
  take_layers(tile);
  if (asked_ && tile.samples >= asked_spp_) {
    status_.latency_seconds = seconds_since(*asked_);
    asked_.reset();
  }
  return {};
}

Expected<void> Viewer::look_after_scheduler() {
  if (local_ == nullptr) return {};
  // Once it is connected its messages come over the connection.
  for (const std::string& line : local_->take_lines())
    if (status_.connection != ConnectionState::kConnected && message_kind(line) != MessageKind::kPlain)
      note(line);
  const std::optional<ChildExit> end = local_->ended();
  if (!end) return {};
  stale_ = true;
  status_.connection = ConnectionState::kLost;
  const bool bad_input = end->code == kBadInput;
  const bool is_hopeless = bad_input || ++starts_without_success_ >= kStartsInARow;
  if (is_hopeless && !has_had_workers_) {
    scheduler_exit_code_ = end->code;
    return fail(fmt::format("the scheduler ended: {}", end->how));
  }
  if (is_hopeless) {
    say(fmt::format("error: the scheduler ended ({}). Reload (F5) tries again", end->how));
    return {};
  }
  say(fmt::format("warning: the scheduler ended ({}); starting it again", end->how));
  return local_->restart();
}

std::uint32_t Viewer::least_samples() const {
  if (!film_ || !job_) return 0;
  float least = std::numeric_limits<float>::infinity();
  for (int y = job_->y; y < job_->y + job_->height; ++y)
    for (int x = job_->x; x < job_->x + job_->width; ++x)
      least = std::min(
          least, film_->radiance()[4 * (std::size_t(y) * std::size_t(film_->width()) + std::size_t(x)) + 3]);
  return std::uint32_t(least);
}

std::uint64_t Viewer::samples_there() const {
  if (!film_ || !job_) return 0;
  double all = 0;
  for (int y = job_->y; y < job_->y + job_->height; ++y)
    for (int x = job_->x; x < job_->x + job_->width; ++x)
      all += film_->radiance()[4 * (std::size_t(y) * std::size_t(film_->width()) + std::size_t(x)) + 3];
  return std::uint64_t(all);
}

// --- Display

void Viewer::say(std::string text) {
  print_message("penumbra-view: " + text);
  note(std::move(text));
}

void Viewer::note(std::string text) {
  status_.messages.push_back(std::move(text));
  if (status_.messages.size() > kMessagesKept) status_.messages.erase(status_.messages.begin());
  stale_ = true;
}

bool Viewer::refines_closed_form() const {
  if (analytic_ == nullptr || (!analytic_is_old_ && analytic_->frames() >= kAnalyticFrames)) return false;
  // While the user waits for the first tile, the processors are left to the workers, but for a limited time.
  return analytic_is_old_ || !asked_ || Clock::now() - *asked_ > kPatienceWithTiles;
}

AnalyticTextures Viewer::analytic_textures() const {
  if (analytic_ == nullptr) return {};
  return {analytic_->closed_form(), analytic_->emission()};
}

Expected<void> Viewer::draw_closed_form() {
  if (analytic_ == nullptr) return {};
  if (analytic_is_old_) {
    SceneHeader header = *header_;
    apply_view(view_, header);
    if (Expected<void> begun = analytic_->begin(header, film_->width(), film_->height()); !begun)
      return begun;
    analytic_is_old_ = false;
    analytic_->add_frame();
  } else if (refines_closed_form()) {
    analytic_->add_frame();
  }
  return {};
}

Expected<void> Viewer::draw() {
  window_.begin_frame();
  status_.analytic_frames = analytic_frames();
  const OverlayResult overlay = draw_overlay(settings_, status_, composite_.shown());
  stale_ = overlay.again;
  picture_area_ = overlay.picture_area;
  for (const Action action : overlay.actions) act(action);
  if (overlay.frame && shot_ != nullptr) shot_->go_to(*overlay.frame);
  if (overlay.alpha_changed) set_alpha(settings_.alpha);
  if (overlay.copy)
    if (const auto copied = copy_view(*overlay.copy); !copied) say("warning: " + copied.error().message);
  if (film_) {
    if (Expected<void> drawn = draw_closed_form(); !drawn) return drawn;
    if (Expected<void> composed = compose_shown(); !composed) return composed;
    const PixelRectangle place = composite_.show(*film_, settings_, status_.workers,
                                                 {.framebuffer = window_.framebuffer(),
                                                  .width = window_.width(),
                                                  .height = window_.height(),
                                                  .area = overlay.picture_area,
                                                  .scale = window_.content_scale()});
    note_what_is_shown(place, overlay.shows_histogram);
  }
  window_.end_frame();
  ++frames_this_second_;
  const Clock::time_point now = Clock::now();
  if (const double seconds = std::chrono::duration<double>(now - second_began_).count(); seconds > 1) {
    status_.frames_per_second = frames_this_second_ / seconds;
    frames_this_second_ = 0;
    second_began_ = now;
  }
  return {};
}

Expected<void> Viewer::compose_shown() {
  if (auto composed = composite_.compose(*film_, analytic_textures(), settings_, shown_layers()); !composed)
    return composed;
  denoise_composed();
  compare_composed();
  return {};
}

/// The panel is laid out before the picture is drawn: what it says of the picture is that of the last frame,
/// unless it has changed.
void Viewer::note_what_is_shown(const PixelRectangle& place, bool shows_histogram) {
  const std::optional<PixelValue> pixel = status_.pixel;
  look_at_pixel(place);
  if (pixel != status_.pixel || shown_difference_ != status_.difference) stale_ = true;
  shown_difference_ = status_.difference;
  if (!shows_histogram) return;
  const Histogram histogram = histogram_of(composite_.read_linear(), std::exp2(settings_.exposure));
  if (histogram != status_.histogram) stale_ = true;
  status_.histogram = histogram;
}

PixelRectangle Viewer::rendered_area() const {
  return job_ ? PixelRectangle{job_->x, job_->y, job_->width, job_->height} : PixelRectangle{};
}

std::span<const float> Viewer::denoised_values() {
  if (!settings_.denoise || settings_.layer != Layer::kComposite) return {};
  return denoised_.values(denoised_view_);
}

void Viewer::denoise_composed() {
  if (!settings_.denoise || settings_.layer != Layer::kComposite) return;
  if (const std::string error = denoised_.take_error(); !error.empty())
    say("warning: the picture cannot be denoised: " + error);
  const PixelRectangle area = rendered_area();
  if (denoised_.wants(denoised_view_, film_->version()) && least_samples() > 0)
    denoised_.submit({.view = denoised_view_,
                      .version = film_->version(),
                      .width = area.width,
                      .height = area.height,
                      .values = cut(composite_.read_linear(), film_->width(), 3, area),
                      .standard_error = cut(film_->standard_error(), film_->width(), 1, area)});
  if (const std::span<const float> values = denoised_values(); !values.empty())
    composite_.replace_values(area, values);
}

Expected<void> Viewer::save(const std::filesystem::path& path) {
  if (!film_) return fail("there is nothing to save yet");
  if (Expected<void> drawn = draw_closed_form(); !drawn) return drawn;
  Expected<Picture> picture = capture_picture(
      composite_, *film_, analytic_textures(), [this] { return compose_shown(); }, settings_, status_);
  if (!picture) return std::unexpected(picture.error());
  add_camera(picture->metadata);
  return save_picture(path, *picture);
}

}  // namespace penumbra
