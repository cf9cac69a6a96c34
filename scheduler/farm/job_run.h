// One open job of a farm: its merged results, what its viewers see, and the data of its outcome.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/farm/arrivals.h"
#include "scheduler/farm/checkpoint_sink.h"
#include "scheduler/farm/problem_text.h"
#include "scheduler/farm/render_job.h"
#include "scheduler/farm/server.h"
#include "scheduler/plan/merge.h"
#include "scheduler/plan/plan.h"
#include "scheduler/plan/tile_grid.h"
#include "scheduler/watch/render_feed.h"
#include "scheduler/watch/tev.h"

namespace penumbra {

/// An empty merge for the job.
Merge merge_of_job(const RenderJob& job);

/// At the end, viewers still receive what is queued for them, as long as they keep reading. This is how long
/// one may pause.
constexpr std::chrono::milliseconds kPatienceWithWatchers{300};

/// All times are seconds since the farm was started.
class JobRun {
 public:
  /// The job's time begins now if it is the only job, else with its first unit.
  JobRun(JobId id, std::shared_ptr<const RenderJob> job, Seconds now, bool is_only);

  /// Offers the scene to workers and viewers.
  void open(Server& server);
  /// Ends the job for its viewers. Waits a moment for a tev viewer.
  void close(Server& server, const Plan& plan, const std::vector<WatchedWorker>& workers);

  [[nodiscard]] const RenderJob& job() const { return *job_; }
  [[nodiscard]] const std::shared_ptr<WatchBoard>& board() const { return board_; }
  [[nodiscard]] const std::string& scene_hash() const { return scene_hash_; }
  [[nodiscard]] const WatchView& view() const { return view_; }
  [[nodiscard]] std::uint64_t samples_done() const { return samples_done_; }
  [[nodiscard]] const FilmLayers& layers() const { return layers_; }
  [[nodiscard]] std::vector<PhaseUnits> phases() const;
  /// Empty for a unit that the job does not have; a faulty worker may name any.
  [[nodiscard]] RenderUnit unit(const UnitId& id) const;
  /// The number of passes that give `spp` samples per pixel, at most that of the job.
  [[nodiscard]] std::uint32_t passes_of(std::uint32_t spp) const;
  /// Whether each tile has its own number of passes, of which the plan must be told.
  [[nodiscard]] bool is_adaptive() const {
    return job_->request.plan.target_error || job_->request.plan.adaptive;
  }
  /// The current numbers of passes of all tiles.
  [[nodiscard]] std::vector<PassesOfTile> passes_of_tiles() const;
  /// The numbers of passes that a result of this tile may have changed.
  [[nodiscard]] std::vector<PassesOfTile> passes_after(std::uint32_t tile);
  /// Whether the time budget is used up. Returns true once.
  bool budget_is_spent();

  // --- Events of the job

  void worker_is_ready(const arrivals::Ready& arrival, Seconds now);
  /// Adds elapsed time. `is_busy`: there was something to render.
  void advance(Seconds seconds, bool is_busy) { active_ += is_busy && begun_ ? seconds : 0; }
  /// Adds time during which workers were rendering units of the job.
  void was_rendered_for(Seconds seconds) { rendered_ += first_given_ ? seconds : 0; }
  void unit_was_given(Seconds now);
  void merge(const MergeResult& order, arrivals::Result& result, Seconds now);
  void skip(const UnitId& unit) { merge_.skip(unit.tile, unit.pass); }
  void redo(std::uint32_t tile);
  /// Starts again from the first sample with this view.
  void begin_view(const WatchView& view);

  /// Stores a checkpoint if one is due; and one if the job ends unfinished.
  void keep_checkpoint();
  void keep_last_checkpoint();
  void discard_checkpoint();

  // --- Reports about the job

  /// The statistics of this worker for the job.
  WorkerShare& share(WorkerId worker) { return shares_[worker]; }
  [[nodiscard]] bool has_share(WorkerId worker) const { return shares_.contains(worker); }
  void problem(std::string text);
  void notice(std::string text);
  /// The last message about a failed unit; empty if there was none.
  std::string& detail(const UnitId& id) { return details_[id]; }

  /// Shows viewers what has changed, and records problems of showing it.
  void publish();
  /// Progress is due a few times a second. It is due less often if the error estimate, which reads the whole
  /// film, takes long.
  [[nodiscard]] bool is_progress_due(Seconds now) const { return now >= next_progress_; }
  [[nodiscard]] RenderProgress progress(const Plan& plan, int workers, Seconds now);
  void show_progress(const Plan& plan, const std::vector<WatchedWorker>& workers, Seconds now);
  [[nodiscard]] RenderOutcome outcome(const Plan& plan, Seconds now) &&;

 private:
  [[nodiscard]] Seconds since_begun(Seconds now) const { return now - begun_.value_or(now); }
  /// The expected number of samples at the end.
  [[nodiscard]] std::uint64_t samples_wanted(const Plan& plan) const;
  /// The number of passes that every tile will have at least.
  [[nodiscard]] std::uint32_t least_passes(const Plan& plan) const;
  /// Whether tiles may end with different numbers of passes although neither a target error nor adaptive
  /// sampling was asked for.
  [[nodiscard]] bool ends_amid_a_pass() const { return budget_spent_ || job_->request.plan.stop_after_units; }
  [[nodiscard]] std::uint32_t spp_of(std::uint32_t passes) const {
    return std::uint32_t(grid_.samples_of_pixel(passes));
  }
  /// Seconds of rendering, including earlier processes.
  [[nodiscard]] Seconds rendered() const { return rendered_before_ + rendered_; }
  void tell_checkpoint_problem();
  void tell_tev_problem();
  void show(const Plan& plan, const std::vector<WatchedWorker>& workers, bool ended);

  const JobId id_;
  const std::shared_ptr<const RenderJob> job_;
  const FilmLayers layers_;
  const TileGrid grid_;

  WatchView view_;
  Merge merge_;
  std::shared_ptr<WatchBoard> board_;
  RenderFeed feed_;
  std::optional<TevStream> tev_;
  std::string scene_hash_;
  std::map<WorkerId, WorkerShare> shares_;
  std::map<UnitId, std::string> details_;
  std::vector<std::string> problems_, notices_;
  std::optional<Seconds> begun_, first_given_;
  bool budget_spent_ = false;
  // samples_kept_: those in the last checkpoint.
  std::uint64_t samples_done_ = 0, samples_kept_ = 0, samples_before_ = 0;
  Seconds rendered_before_ = 0, rendered_ = 0;
  Seconds ready_ = 0, first_tile_ = 0, last_tile_ = 0;  // since the job began
  Seconds active_ = 0;  // since the view began; only while there was something to render
  Seconds next_progress_ = 0, next_shown_ = 0;
  double relative_error_ = 0;  // as last reported
};

}  // namespace penumbra
