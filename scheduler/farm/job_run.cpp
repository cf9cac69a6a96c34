#include "scheduler/farm/job_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "kernels/host/process.h"
#include "scheduler/farm/render_job_check.h"

namespace penumbra {
namespace {

constexpr Seconds kProgressInterval = 0.2, kShowInterval = 0.1;
constexpr double kProgressShare = 0.02;

}  // namespace

JobRun::JobRun(JobId id, std::shared_ptr<const RenderJob> job, Seconds now, bool is_only)
    : id_(id),
      job_(std::move(job)),
      layers_(job_->scene.header.features, job_->scene.header.matte_count),
      grid_(tile_grid(*job_)),
      view_{0, view_of(job_->scene.header)},
      merge_(job_->before ? std::move(job_->before->merge) : merge_of_job(*job_)),
      board_(std::make_shared<WatchBoard>(grid_.tiles())),
      feed_(*board_, grid_, is_hybrid(job_->scene)) {
  if (is_only) begun_ = now;
  if (!job_->before) return;
  samples_done_ = samples_kept_ = samples_before_ = merge_.samples();
  rendered_before_ = job_->before->rendered;
}

Merge merge_of_job(const RenderJob& job) {
  const SceneHeader& h = job.scene.header;
  return Merge(FilmAccumulator(job.x, job.y, job.width, job.height, FilmLayers(h.features, h.matte_count)),
               tile_grid(job), job.request.plan);
}

void JobRun::open(Server& server) {
  AssetManifest manifest = job_->manifest ? *job_->manifest : manifest_of(job_->scene);
  scene_hash_ = manifest.hash;
  server.add_asset({std::move(manifest), job_->scene.head(), job_->scene.body(), job_});
  WatchedJob watched{.id = id_,
                     .title = job_->title,
                     .integrator = job_->integrator,
                     .film_width = job_->scene.header.film.width,
                     .film_height = job_->scene.header.film.height,
                     .x = job_->x,
                     .y = job_->y,
                     .width = job_->width,
                     .height = job_->height,
                     .spp = job_->spp,
                     .scene_hash = scene_hash_,
                     .interactive = job_->interactive,
                     .hybrid = is_hybrid(job_->scene),
                     .command = job_->reproduce_command,
                     .scene_spp = job_->scene_spp,
                     .layers = watchable_layers(merge_.film().layers())};
  std::ranges::copy(job_->center, watched.center);
  board_->show_view(view_);
  feed_.begin_view(view_);
  for (std::uint32_t tile = 0; samples_before_ > 0 && tile < grid_.tiles(); ++tile)
    feed_.tile_changed(tile, 0);
  board_->describe(std::move(watched));
  server.show_job(id_, board_, job_->interactive);
  if (!job_->tev.empty()) tev_.emplace(*board_, job_->tev);
}

void JobRun::close(Server& server, const Plan& plan, const std::vector<WatchedWorker>& workers) {
  feed_.publish(merge_.film(), true);
  // An interactive render is never complete; its viewers wait for another scheduler.
  show(plan, workers, !job_->interactive);
  server.hide_job(id_);
  server.remove_asset(scene_hash_);
  board_->close();
  if (!tev_) return;
  board_->wait_for_watchers(kPatienceWithWatchers);
  tev_->stop();
  tell_tev_problem();
}

std::vector<PhaseUnits> JobRun::phases() const {
  return {{.tiles = grid_.tiles(),
           .passes = job_->interactive ? 0 : merge_.most_passes(),
           .passes_at_first = is_adaptive() ? merge_.passes_at_first() : kAllPasses,
           .units_at_most = job_->request.plan.stop_after_units,
           .merged = merge_.merged_passes(),
           .passes_at_once = passes_at_once(*job_)}};
}

RenderUnit JobRun::unit(const UnitId& id) const {
  return id.job == id_ && id.phase == 0 ? merge_.unit(id.tile, id.pass) : RenderUnit{};
}

std::vector<PassesOfTile> JobRun::passes_of_tiles() const {
  std::vector<PassesOfTile> all;
  for (std::uint32_t tile = 0; is_adaptive() && tile < grid_.tiles(); ++tile)
    all.push_back({id_, tile, merge_.passes_wanted(tile)});
  return all;
}

std::vector<PassesOfTile> JobRun::passes_after(std::uint32_t tile) {
  if (merge_.take_allocation()) return passes_of_tiles();
  if (!job_->request.plan.target_error) return {};
  return {{id_, tile, merge_.passes_wanted(tile)}};
}

std::uint32_t JobRun::passes_of(std::uint32_t spp) const {
  const std::uint64_t possible = std::min(spp, job_->spp);
  return std::uint32_t((possible + job_->request.plan.samples_per_pass - 1) /
                       job_->request.plan.samples_per_pass);
}

std::uint64_t JobRun::samples_wanted(const Plan& plan) const {
  if (is_adaptive()) return merge_.samples_expected();
  if (!ends_amid_a_pass()) return grid_.samples(plan.passes(id_));
  std::uint64_t all = 0;
  for (std::uint32_t tile = 0; tile < grid_.tiles(); ++tile)
    all += grid_.samples_of_tile(tile, plan.passes(id_, tile));
  return all;
}

std::uint32_t JobRun::least_passes(const Plan& plan) const {
  std::uint32_t least = plan.passes(id_);
  if (is_adaptive() || !ends_amid_a_pass()) return least;
  for (std::uint32_t tile = 0; tile < grid_.tiles(); ++tile) least = std::min(least, plan.passes(id_, tile));
  return least;
}

bool JobRun::budget_is_spent() {
  const bool is_over = job_->request.time_budget && first_given_ && rendered() > *job_->request.time_budget;
  return is_over && !std::exchange(budget_spent_, true);
}

// --- Events of the job

void JobRun::worker_is_ready(const arrivals::Ready& arrival, Seconds now) {
  WorkerShare& share = shares_[arrival.worker];
  share.device = arrival.device;
  share.kernels = arrival.preparation.kernels;
  share.scene.fetched += arrival.scene.fetched;
  share.scene.found += arrival.scene.found;
  if (ready_ == 0) ready_ = since_begun(now);
}

void JobRun::unit_was_given(Seconds now) {
  if (!first_given_) first_given_ = now;
  if (!begun_) begun_ = now;
}

void JobRun::merge(const MergeResult& order, arrivals::Result& result, Seconds now) {
  last_tile_ = since_begun(now);
  if (first_tile_ == 0) first_tile_ = last_tile_;
  const std::uint64_t samples = result.buffer.pixels() * result.buffer.sample_count;
  WorkerShare& worker = shares_.at(order.worker);
  ++worker.units;
  worker.samples += samples;
  samples_done_ += samples;
  merge_.add(order.unit.tile, order.unit.pass, std::move(result.buffer));
  feed_.tile_changed(order.unit.tile, order.worker);
}

void JobRun::begin_view(const WatchView& view) {
  view_ = view;
  active_ = 0;
  merge_.start_again();
  details_.clear();
  samples_done_ = 0;
  relative_error_ = std::numeric_limits<double>::quiet_NaN();
  board_->show_view(view_);
  feed_.begin_view(view_);
}

void JobRun::keep_checkpoint() {
  if (!job_->checkpoints) return;
  tell_checkpoint_problem();
  if (samples_done_ == samples_kept_ || !job_->checkpoints->is_due(merge_)) return;
  samples_kept_ = samples_done_;
  job_->checkpoints->keep(merge_, rendered());
}

void JobRun::keep_last_checkpoint() {
  if (!job_->checkpoints || samples_done_ == 0) return;
  job_->checkpoints->keep_last(merge_, rendered());
  tell_checkpoint_problem();
}

void JobRun::discard_checkpoint() {
  if (job_->checkpoints) job_->checkpoints->remove();
}

void JobRun::redo(std::uint32_t tile) {
  samples_done_ -= merge_.redo(tile);
  samples_before_ = std::min(samples_before_, samples_done_);
  discard_checkpoint();  // it contains the tile's untrusted samples
}

void JobRun::tell_checkpoint_problem() {
  if (std::optional<std::string> text = job_->checkpoints->take_problem()) problem(std::move(*text));
}

// --- Reports about the job

void JobRun::problem(std::string text) {
  board_->say("warning: " + text);
  problems_.push_back(std::move(text));
}

void JobRun::notice(std::string text) {
  board_->say(text);
  notices_.push_back(std::move(text));
}

void JobRun::tell_tev_problem() {
  if (std::optional<std::string> text = tev_->take_problem()) problem(std::move(*text));
}

void JobRun::publish() {
  if (tev_) tell_tev_problem();
  feed_.publish(merge_.film(), job_->interactive);
}

RenderProgress JobRun::progress(const Plan& plan, int workers, Seconds now) {
  const auto begin = std::chrono::steady_clock::now();
  relative_error_ = merge_.film().relative_error();
  next_progress_ = now + std::max(kProgressInterval, seconds_since(begin) / kProgressShare);
  return {.samples_done = samples_done_,
          .samples_total = samples_wanted(plan),
          .samples_before = samples_before_,
          .elapsed_seconds = since_begun(now),
          .relative_error = relative_error_,
          .workers = workers,
          .notices = std::exchange(notices_, {})};
}

void JobRun::show_progress(const Plan& plan, const std::vector<WatchedWorker>& workers, Seconds now) {
  if (!board_->is_watched() || now < next_shown_) return;
  next_shown_ = now + kShowInterval;
  show(plan, workers, false);
}

void JobRun::show(const Plan& plan, const std::vector<WatchedWorker>& workers, bool ended) {
  WatchProgress progress{.view = view_.number,
                         .samples_done = samples_done_,
                         .samples_wanted = samples_wanted(plan),
                         .spp_done = std::uint32_t(merge_.spp_finished()),
                         .spp_wanted = job_->request.plan.adaptive ? std::uint32_t(merge_.spp_wanted())
                                                                   : spp_of(least_passes(plan)),
                         .elapsed_seconds = active_,
                         .relative_error = relative_error_,
                         .finished = plan.finished(id_),
                         .ended = ended,
                         .workers = workers};
  for (WatchedWorker& worker : progress.workers) {
    if (worker.job != id_) worker.x = worker.y = worker.width = worker.height = 0;
    if (const auto found = shares_.find(worker.number); found != shares_.end()) {
      worker.device = found->second.device;
      worker.units = found->second.units;
    }
  }
  board_->show_progress(std::move(progress));
}

RenderOutcome JobRun::outcome(const Plan& plan, Seconds now) && {
  RenderOutcome outcome;
  outcome.complete = plan.finished(id_) && plan.set_aside(id_).empty();
  if (const std::uint64_t missed = plan.counts(id_).not_verified; missed > 0)
    problem(fmt::format("{} {} to be compared with another worker's result and could not be", missed,
                        missed == 1 ? "unit was" : "units were"));
  outcome.problems = std::move(problems_);
  for (const auto& [worker, share] : shares_) outcome.workers.push_back(share);
  const Plan::Counts counts = plan.counts(id_);
  outcome.units_done = counts.done;
  outcome.units_duplicated = counts.duplicated;
  outcome.units_requeued = counts.requeued;
  outcome.units_verified = counts.verified;
  outcome.units_not_verified = counts.not_verified;
  outcome.units_set_aside = plan.set_aside(id_).size();
  outcome.passes_finished = merge_.finished_passes();
  outcome.passes_total = job_->request.plan.adaptive ? merge_.least_passes_wanted() : grid_.passes();
  outcome.units_in_order = merge_.units_in_order();
  outcome.ended_by_tile = is_adaptive() && merge_.is_done();
  outcome.shares_missing = job_->request.plan.adaptive && !(merge_.is_done() && merge_.is_undisturbed());
  outcome.film = std::move(merge_).take_film();
  outcome.seconds_to_ready = ready_;
  outcome.seconds_to_first_tile = first_tile_;
  outcome.seconds_to_last_tile = last_tile_;
  outcome.seconds = since_begun(now);
  outcome.samples_before = samples_before_;
  outcome.seconds_before = rendered_before_;
  return outcome;
}

}  // namespace penumbra
